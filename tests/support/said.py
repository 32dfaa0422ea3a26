"""What is said of something hostile: done, refused with a message, or a trace."""

from __future__ import annotations

import traceback
from collections.abc import Callable

from evcosim.cosim.errors import ConfigError, RunError


def said_of(call: Callable[[], object]) -> str:
    """Do something, and return "done", how it was refused or ended, or the trace of any other exception."""
    try:
        call()
    except ConfigError as error:
        return f"refused: {error}"
    except RunError as error:
        return f"ended: {error}"
    except Exception:  # to name the value beside it
        return traceback.format_exc()
    return "done"
