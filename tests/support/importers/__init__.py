"""Our FMUs in the importers of others: trials, what came out, and the tables of docs/fmus-elsewhere.md."""
