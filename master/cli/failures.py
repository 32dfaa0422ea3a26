"""Every error becomes plain text on stderr and an exit code; a traceback is shown with --debug alone."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import typer

from ...cosim.visible import raw_stream, visible, visible_stream
from ..engine.progress import reporting
from . import interrupts, outputs
from .typed_paths import check_given
from .wrapping import message_lines

_SCREEN = 20  # lines of a message at most
_NO_MEMORY = "failed to map segment from shared object"  # the loader's message for a library
_NO_THREAD = "can't start new thread"  # Python's message, whose error has no class of its own

FAILED, WRONG_USE, BROKEN_PIPE = 1, 2, 141


def guarded(command: Any, arguments: Sequence[str]) -> int:
    """Run a click command and return the exit code. Nothing but SystemExit is raised."""
    debug = "--debug" in arguments or os.environ.get("EVCOSIM_DEBUG", "0") not in ("", "0")
    arguments = [argument for argument in arguments if argument != "--debug"]
    _print_what_the_terminal_can()
    with visible_streams():
        return _guarded(command, arguments, debug)


@contextlib.contextmanager
def visible_streams() -> Iterator[None]:
    """Print what stands in files and FMUs so that it neither steers the terminal nor hides anything."""
    kept = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = map(visible_stream, kept)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = map(raw_stream, (sys.stdout, sys.stderr))


def _guarded(command: Any, arguments: Sequence[str], debug: bool) -> int:
    try:
        check_given(arguments)
        with reporting(_report_to(arguments)), command.make_context("evcosim", arguments) as context:
            code = command.invoke(context)
        sys.stdout.flush()
        return int(code or 0)
    except typer.Exit as ending:
        return ending.exit_code
    except BrokenPipeError:
        _forget_stdout()
        return BROKEN_PIPE
    except (KeyboardInterrupt, typer.Abort) as error:
        interrupts.wait_if_ending()
        complain(interrupts.words(interrupts.exit_code(error) - 128))
        return interrupts.exit_code(error)
    except Exception as error:  # the last line of defense: a plain message, --debug for the traceback
        interrupts.wait_if_ending()  # it took away what the command needs
        if debug:
            import traceback

            traceback.print_exc()
        code, message = _judged(error)
        complain(message, whole=debug)
        return code
    finally:
        outputs.release()


def _report_to(arguments: Sequence[str]) -> Callable[[str], None] | None:
    """Return what prints a word on what takes long: to a terminal, unless nothing but a result is wanted."""
    quiet = any(argument in ("--quiet", "-q", "--json") for argument in arguments)
    return None if quiet or not sys.stderr.isatty() else complain


def open_closed_streams() -> None:
    """Let the standard streams that the caller closed, as by `>&-`, lead nowhere: what is printed is lost.

    Each gets its own descriptor, for units in other processes too. Else the next file that is opened would
    have it, and what native code prints would stand in the results.
    """
    for descriptor, (name, mode) in enumerate((("stdin", "r"), ("stdout", "w"), ("stderr", "w"))):
        if getattr(sys, name) is None:  # Python's own name for a descriptor that is closed at its start
            stream = open(os.devnull, mode)  # noqa: SIM115 - it stays open to the end of the process
            setattr(sys, name, stream)
            if stream.fileno() == descriptor:
                os.set_inheritable(descriptor, True)


def complain(message: str, whole: bool = False) -> None:
    """Print a message on stderr: at most a screen, wrapped in a terminal, unless `whole`."""
    message = _by_names(message.strip())
    lines = visible(message).split("\n") if message else ["no reason given"]
    if len(lines) > _SCREEN and not whole:
        lines[_SCREEN - 1 :] = [f"... and {len(lines) - _SCREEN + 1} more lines; --debug shows them"]
    # a name with a line feed must not make another message of what follows
    lines[1:] = [f"  {line}" if line.lstrip().startswith("evcosim:") else line for line in lines[1:]]
    lines[0] = f"evcosim: {lines[0]}"
    width = 0 if whole else _terminal_width()
    shown = [part for line in lines for part in message_lines(line, width)] if width else lines
    print("\n".join(shown), file=sys.stderr)


def _by_names(message: str) -> str:
    """Return a message with the names of built-in FMUs in place of their files in the cache."""
    if ".fmu" not in message:
        return message
    from ..builtin import by_names

    return by_names(message)


def _terminal_width() -> int:
    """Return the columns of the terminal that shows messages; 0 for a file or a pipe."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns if sys.stderr.isatty() else 0
    except (OSError, ValueError):  # a stream without a descriptor
        return 0


def _judged(error: Exception) -> tuple[int, str]:
    """Return exit code and message of an error."""
    from ...cosim import shortage
    from ...cosim.errors import ConfigError, RunError

    if hasattr(error, "format_message"):  # a usage error: of click, or of typer's own copy of click
        return WRONG_USE, _usage(error)
    if isinstance(error, ConfigError):
        return WRONG_USE, str(error)
    if isinstance(error, RunError):
        return FAILED, str(error)
    if isinstance(error, OSError) and error.strerror:
        place = f"{error.filename}: " if error.filename else ""
        return FAILED, f"{place}{shortage.reason(error)}"
    if isinstance(error, MemoryError) or _NO_MEMORY in str(error):
        return FAILED, shortage.no_memory()
    if isinstance(error, RuntimeError) and str(error) == _NO_THREAD:
        return FAILED, shortage.no_thread()
    if isinstance(error, ImportError) and (said := shortage.reason_of_import(error)):
        return FAILED, said
    said = f": {error}" if str(error) else ""
    return FAILED, f"unexpected error: {type(error).__name__}{said}\n--debug shows where it happened"


_NUMBERS = {
    "Input should be a valid number, unable to parse string as a number": (
        "a number is needed, as 10 or 0.5, without a unit of measure"
    ),
    "Input should be a valid integer, unable to parse string as an integer": "a whole number is needed",
}
"""Sentences of pydantic on a text that is no number, each with the one that is said."""


def _usage(error: Any) -> str:
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else "evcosim"
    message = error.format_message().replace("Value error, ", "")  # typer shows what pydantic says
    for said, rule in _NUMBERS.items():
        message = message.replace(said, rule)
    return f"{message}\n'{path} --help' shows how it is used"


def _print_what_the_terminal_can() -> None:
    """Print characters that the terminal's encoding lacks as '?'."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")


def _forget_stdout() -> None:
    """Discard what Python flushes at exit: the reader has gone (`evcosim list | head -1`)."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 - it stays open to the end of the process
