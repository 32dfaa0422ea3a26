"""Running what `evcosim.cosim` describes: FMUs as units, the engines, studies, the command line."""
