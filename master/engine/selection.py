"""Which engine runs a system: compiled where numba is installed, else the one in Python."""

from __future__ import annotations

from typing import get_args

from ...cosim.errors import ConfigError, nearest
from ...cosim.system.system import EngineName
from .engine import Engine
from .python_engine import PythonEngine


def engine_class(wanted: EngineName | None = None) -> tuple[type[Engine], str]:
    """The class of an engine (None: the fastest there is), and a notice where it is not the wanted one ("").

    Raises ConfigError for a name that is none.
    """
    if wanted not in (None, *get_args(EngineName)):
        known = get_args(EngineName)
        raise ConfigError(f"there is no engine '{wanted}'{nearest(str(wanted), known)}: {', '.join(known)}")
    if wanted == "python":
        return PythonEngine, ""
    try:
        from .compiled.engine import CompiledEngine
    except ImportError as error:
        return PythonEngine, _without_numba(error)
    return CompiledEngine, ""


def prepared() -> str:
    """Compile the engine into its cache, also that of a profile, if it is not there; a notice where that
    cannot be ("")."""
    try:
        from .compiled.cache import compiled
    except ImportError as error:
        return _without_numba(error)
    return compiled()[1] or compiled(timed=True)[1]


def _without_numba(error: ImportError) -> str:
    return f"the compiled engine needs numba, which cannot be imported ({error}): engine python"
