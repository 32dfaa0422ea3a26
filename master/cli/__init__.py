"""The command line `evcosim`: a module per verb, and what the verbs share.

    app         the verbs and global options
    options     the options that verbs share, and those of a run as one record
    arguments   the parsers of `--set`, `--fmu` and times
    completion  the names that the Tab key offers
    failures    every error as plain text on stderr, and the exit code
    console     tables, JSON and the progress bar
    once        an option that takes one value is given once
    early_exit  an FMU in this process that calls exit()
    interrupts  Ctrl-C, SIGTERM and other signals that end a command, whatever it is doing
    outputs     the folder of a run
    summary     the summary of a run at its end
    typed_paths the paths that are typed, checked before a verb does anything

Exit codes: 0 done; 1 the run or the check failed; 2 wrong use or bad input; 130 ended by Ctrl-C, 143 by
SIGTERM, 128 + signal by another one; 141 the reader of the output has gone. Verb modules import heavy
packages inside their functions, so that `evcosim --help` answers at once.
"""

from __future__ import annotations

from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line (default: that of the process) and return the exit code."""
    if arguments is not None:
        return _main(arguments)
    try:  # the process is ours
        return _of_process()
    except (OSError, ImportError) as error:  # even the modules that report errors cannot be read
        from ...cosim import shortage  # loaded by now, or this is a traceback of Python's own

        if not (said := shortage.reason_of_import(error)):
            raise
        import sys

        print(f"evcosim: {said}", file=sys.stderr)
        return 1


def _of_process() -> int:
    from . import interrupts

    interrupts.install()  # before anything that takes time
    _calculate_in_one_thread()
    _search_garbage_seldom()
    from . import early_exit

    early_exit.install()
    try:
        return _main(None)
    finally:
        early_exit.leave()
        interrupts.leave()


def _calculate_in_one_thread() -> None:
    """Let libraries of linear algebra start no threads, unless the user says otherwise.

    Here they have nothing to share out, each thread takes 40 MB of addresses, and one that cannot be started
    (`ulimit -u`) ends the process as Ctrl-C does. The processes of isolated units do without, too.
    """
    import os

    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def _search_garbage_seldom() -> None:
    """Let Python look for garbage after more new objects than it does by itself, 700.

    What is imported stays: to look through it again and again takes a twentieth of a short command.
    """
    import gc

    gc.set_threshold(20_000)


def _main(arguments: Sequence[str] | None) -> int:
    import os
    import sys

    from ..fmi import crash
    from . import completion
    from .app import command
    from .failures import guarded, open_closed_streams

    open_closed_streams()
    if arguments is None:
        if instruction := os.environ.get(completion.VARIABLE):
            return completion.completed(command(), instruction)
        crash.enable()
    return guarded(command(), completion.with_shell(sys.argv[1:] if arguments is None else arguments))
