"""The choice of the engine: compiled if numba is installed, else the one in Python."""

from __future__ import annotations

from typing import get_args

from ...cosim.errors import ConfigError, nearest
from ...cosim.shortage import too_little_memory
from ...cosim.system.system import EngineName
from .engine import Engine
from .python_engine import PythonEngine

_NUMBA = 450e6  # bytes of address space for numba and its libraries, which do not fail without them but hang


def engine_class(wanted: EngineName | None = None) -> tuple[type[Engine], str]:
    """Return the class of an engine (None: the fastest), and a notice if it is another than wanted, else "".

    Raises ConfigError for an unknown name.
    """
    if wanted not in (None, *get_args(EngineName)):
        known = get_args(EngineName)
        raise ConfigError(f"there is no engine '{wanted}'{nearest(str(wanted), known)}: {', '.join(known)}")
    if wanted == "python":
        return PythonEngine, ""
    if said := too_little_memory(_NUMBA, "the compiled engine", "numba"):
        return PythonEngine, f"{said}: engine python"
    try:
        from .compiled.engine import CompiledEngine
    except (ImportError, OSError) as error:  # OSError: no memory is left for its libraries
        return PythonEngine, _without_numba(error)
    return CompiledEngine, ""


def compile_engine() -> str:
    """Compile the engine into its cache, with the one that measures a profile and the frames of buses.

    What is there is not compiled anew.
    Return a notice if that is impossible, else "".
    """
    try:
        from .compiled.cache import compiled, wire
    except (ImportError, OSError) as error:  # OSError: no memory is left for its libraries
        return _without_numba(error)
    return compiled()[1] or compiled(timed=True)[1] or wire()[1]


def _without_numba(error: ImportError | OSError) -> str:
    return f"the compiled engine needs numba, which cannot be imported ({error}): engine python"
