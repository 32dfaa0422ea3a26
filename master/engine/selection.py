"""The choice of the engine: compiled if numba is installed, else the one in Python."""

from __future__ import annotations

from typing import get_args

from ...cosim.errors import ConfigError, nearest
from ...cosim.shortage import too_little_memory
from ...cosim.system.system import EngineName
from .engine import Engine
from .python_engine import PythonEngine

_NUMBA = 450e6  # bytes of address space for numba and its libraries, which do not fail without them but hang


def engine_class(
    wanted: EngineName | None = None, timed: bool = False, frames: bool = False
) -> tuple[type[Engine], str]:
    """Return the class of an engine (None: the fastest), and a notice if it is another than wanted, else "".

    `timed`: it measures a profile; `frames`: there are some on buses. Raises ConfigError for an unknown name.
    """
    if wanted not in (None, *get_args(EngineName)):
        known = get_args(EngineName)
        raise ConfigError(f"there is no engine '{wanted}'{nearest(str(wanted), known)}: {', '.join(known)}")
    if wanted == "python":
        return PythonEngine, ""
    from .compiled.cache import at_hand

    if not at_hand(timed, frames):
        if said := too_little_memory(_NUMBA, "the compiled engine", "numba"):
            return PythonEngine, f"{said}: engine python"
        try:
            from .compiled import compiling as compiling  # which a run without its machine code needs
        except (ImportError, OSError) as error:  # OSError: no memory is left for its libraries
            return PythonEngine, _without_numba(error)
    from .compiled.engine import CompiledEngine

    return CompiledEngine, ""


def compile_engine() -> str:
    """Compile the engine into its cache, with the one that measures a profile and the frames of buses.

    What is there is not compiled anew.
    Return a notice if that is impossible, else "".
    """
    from .compiled.cache import compiled, one_operation, served, wire

    try:
        notices = compiled()[1], compiled(timed=True)[1], one_operation()[1], wire()[1]
    except (ImportError, OSError) as error:  # OSError: no memory is left for its libraries
        return _without_numba(error)
    served()
    return next(filter(None, notices), "")


def _without_numba(error: ImportError | OSError) -> str:
    return f"the compiled engine needs numba, which cannot be imported ({error}): engine python"
