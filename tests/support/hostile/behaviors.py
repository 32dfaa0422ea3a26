"""FMUs whose library does wrong: how it ends, what its functions return, what it does to its process."""

from __future__ import annotations

from support.hostile.case import WHOLE, Case

_DIED = "at t = 0.05 s (step 5): unit 'bad': its process "


def in_step(act: str, what: str, expected: str, **more: object) -> Case:
    """A case whose library does wrong in step 5."""
    return Case(act, what, expected, 5, act=act, **more)  # type: ignore[arg-type] # the fields of Case


def harmless(act: str, what: str, expected: str = "", **more: object) -> Case:
    """A case that is borne: the run ends well."""
    return Case(act, what, expected, WHOLE, act=act, **more)  # type: ignore[arg-type] # as above


ENDS = [
    in_step("segfault", "writes to address 0", _DIED + "was killed by SIGSEGV", versions=(1, 2, 3)),
    in_step("abort", "calls abort()", _DIED + "was killed by SIGABRT"),
    in_step("double_free", "frees twice", _DIED + "was killed by SIGABRT"),
    in_step("divide", "divides an integer by 0", _DIED + "was killed by SIGFPE", versions=(2,)),
    in_step("illegal", "executes an illegal instruction", _DIED + "was killed by SIGILL", versions=(3,)),
    in_step("recursion", "recurses without end", _DIED + "was killed by SIGSEGV", versions=(2,)),
    in_step(
        "exit0",
        "calls exit(0)",
        _DIED + "ended by itself with exit code 0: the FMU called exit()",
        versions=(1, 2, 3),
    ),
    in_step("_exit3", "calls _exit(3)", _DIED + "ended by itself with exit code 3", versions=(3,)),
    in_step("pthread_exit", "ends the thread that steps it", _DIED + "ended by itself", versions=(2,)),
    in_step("exec", "becomes another program", _DIED + "ended by itself with exit code 0", versions=(3,)),
    in_step("kill_itself", "sends itself SIGKILL", _DIED + "was killed by SIGKILL", versions=(2,)),
    in_step(
        "alarm", "sets a timer whose signal nobody handles", _DIED + "was killed by SIGALRM", versions=(3,)
    ),
    in_step(
        "fork_and_exit",
        "leaves a copy of its process behind and exits",
        _DIED + "ended by itself with exit code 3",
        versions=(2,),
    ),
    in_step(
        "hang",
        "never returns from doStep",
        _DIED + "did not answer for 0.5 s (step_timeout)",
        versions=(1, 2, 3),
        timeout=0.5,
    ),
    in_step(
        "hang_ignoring_signals",
        "ignores all signals and never returns",
        _DIED + "did not answer for 0.5 s",
        versions=(3,),
        timeout=0.5,
    ),
    in_step("sleep", "sleeps in doStep", _DIED + "did not answer for 0.5 s", versions=(2,), timeout=0.5),
    in_step(
        "stop_itself",
        "stops its process (SIGSTOP)",
        _DIED + "did not answer for 0.5 s",
        timeout=0.5,
        versions=(2,),
    ),
    in_step(
        "memory",
        "takes memory up to its limit",
        _DIED + "was killed by SIGABRT",
        versions=(2,),
    ),
    in_step(
        "file",
        "fills a file without end",
        _DIED + "did not answer for 0.5 s",
        timeout=0.5,
        entry="file_limit = 1e6",
        versions=(3,),
    ),
    in_step(
        "close_all",
        "closes the files 0 to 63, our socket among them",
        _DIED + "lost its connection to the master",
        versions=(3,),
    ),
    in_step(
        "truncate_all",
        "empties all files that it finds open, our shared memory among them",
        "unit 'bad': ",
        versions=(3,),
        timeout=0.5,
    ),
    in_step("answer_nonsense", "writes into our socket", "unit 'bad': ", versions=(2,), timeout=0.5),
    in_step(
        "answer_nesting",
        "writes JSON of half a million brackets into our socket",
        "unit 'bad': ",
        versions=(3,),
        timeout=0.5,
    ),
    in_step(
        "answer_endless", "writes into our socket without end", "unit 'bad': ", versions=(2,), timeout=0.5
    ),
    in_step(
        "null_callback", "calls a callback that is not there", _DIED + "was killed by SIGSEGV", versions=(3,)
    ),
    in_step(
        "trapped_nan",
        "lets floating-point exceptions kill, then divides 0 by 0",
        _DIED + "was killed by SIGFPE",
        versions=(2,),
    ),
]

CALLS = [
    Case(
        "wrong_guid",
        "GUID that is not the library's",
        "it does not accept the…{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}",
        None,
        (1, 2, 3),
        changes=(("hostile:", "{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}"),),
    ),
    Case(
        "instantiate_refuse",
        "is not instantiated and says why",
        "cannot be instantiated:…no license: call 555-0100",
        None,
        act="instantiate_refuse",
    ),
    Case(
        "instantiate_silent",
        "is not instantiated and does not say why",
        "cannot be instantiated: its instantiate function returned nothing and no message",
        None,
        (1, 2, 3),
        act="instantiate_silent",
    ),
    Case("instantiate_crash", "crashes in instantiate", "SIGSEGV", 0, act="instantiate_crash"),
    Case("instantiate_exit", "exits in instantiate", "exit code 0", 0, act="instantiate_exit"),
    Case(
        "instantiate_hang",
        "never returns from instantiate",
        "did not answer for 1 s (load_timeout)",
        0,
        (2,),
        loading_timeout=1.0,
        act="instantiate_hang",
    ),
    Case(
        "instantiate_nonsense",
        "gives a pointer to nowhere as its component",
        "SIGSEGV",
        0,
        act="instantiate_nonsense",
    ),
    Case("loading_crash", "crashes in the library's constructor", "SIGSEGV", 0, loading=1),
    Case("loading_exit", "exits in the library's constructor", "exit code 0", 0, loading=2),
    Case(
        "loading_hang",
        "hangs in the library's constructor",
        "did not answer for 1 s (load_timeout)",
        0,
        (3,),
        loading=3,
        loading_timeout=1.0,
    ),
    Case(
        "initialize_error",
        "cannot be initialized",
        "returned Error…no steady state",
        0,
        (1, 2, 3),
        act="initialize_error",
    ),
    Case("initialize_crash", "crashes in its initialization", "SIGSEGV", 0, act="initialize_crash"),
    Case(
        "initialize_hang",
        "never ends its initialization",
        "did not answer for 1 s (load_timeout)",
        0,
        versions=(2,),
        act="initialize_hang",
        loading_timeout=1.0,
    ),
    Case("initialize_nan", "has NaN as output before the first step", "bad.y = nan", 0, act="initialize_nan"),
    Case("terminate_crash", "crashes in terminate", "SIGSEGV", WHOLE, act="terminate_crash", ending=True),
    Case(
        "terminate_hang",
        "never returns from terminate",
        "did not answer for 0.5 s",
        WHOLE,
        versions=(3,),
        act="terminate_hang",
        timeout=0.5,
        ending=True,
    ),
    Case(
        "terminate_error",
        "terminate returns Error",
        "Terminate… returned Error",
        WHOLE,
        (1, 2, 3),
        act="terminate_error",
        ending=True,
    ),
    harmless("free_crash", "crashes in freeInstance"),
    harmless("free_exit", "exits in freeInstance", versions=(3,)),
    harmless("free_hang", "never returns from freeInstance", versions=(2,)),
]

STATUSES = [
    harmless("warning", "returns Warning in every step", "unit 'bad' gave 10 warnings", versions=(1, 2, 3)),
    in_step(
        "discard",
        "returns Discard for ever",
        "DoStep returned Discard (2)",
        versions=(1, 2, 3),
    ),
    in_step("error", "returns Error", "DoStep returned Error (3)"),
    in_step("fatal", "returns Fatal", "DoStep returned Fatal (4)"),
    in_step("fatal_crash_in_free", "returns Fatal and crashes when it is freed", "DoStep returned Fatal (4)"),
    in_step("pending", "returns Pending", "DoStep returned Pending (5)", versions=(2,)),
    in_step("status42", "returns status 42", "DoStep returned no FMI status (42)", versions=(1, 2, 3)),
    in_step("status_negative", "returns status -1", "DoStep returned no FMI status (-1)", versions=(3,)),
    in_step(
        "early_return",
        "returns early, which it was not allowed to",
        "returned early, at t = 0.055 s",
        versions=(3,),
    ),
    in_step(
        "backwards",
        "returns early at a time before the step",
        "returned early, at t = -0.95 s",
        versions=(3,),
    ),
    harmless("event", "needs an event that nobody handles", versions=(3,)),
    Case(
        "get_error",
        "no value can be got",
        "Get… of y returned Error",
        0,
        act="get_error",
    ),
    Case("set_error", "no value can be set", "Set… of … returned Error", 0, act="set_error"),
]

_LIMITS = ((' unit="m/s"/>', ' unit="m/s" min="-100" max="100"/>'),)
VALUES = [
    in_step("nan", "status ok, output NaN", "bad.y = nan m/s: an output must be finite"),
    in_step("infinity", "status ok, output infinite", "bad.y = inf m/s: an output must be finite"),
    harmless("huge", "status ok, output 1e69", "bad.y reached 1e+69 m/s", exact=False),
    harmless(
        "out_of_range",
        "status ok, output far outside the range that it declares",
        "bad.y reached -460000 m/s, below its minimum of -100 m/s",
        changes=_LIMITS,
    ),
    harmless("integer_minimum", "an Integer of -2^31", versions=(3,), exact=False),
    harmless("odd_boolean", "a Boolean of 77", versions=(2,)),
    harmless("null_string", "a String that is NULL"),
    in_step(
        "write_beyond",
        "writes a gigabyte where its values belong",
        _DIED + "was killed by SIG",
        versions=(3,),
    ),
    harmless("write_before", "writes before the place of its values", versions=(2,)),
    harmless("change_inputs", "changes the inputs that it is given", versions=(3,)),
    Case(
        "diverges",
        "needs steps of 1 ms, diverges at 10 ms with status ok",
        "bad.y reached…below its minimum of -100 m/s",
        WHOLE,
        act="stiff",
        changes=_LIMITS,
        exact=False,
    ),
    Case(
        "diverges_not",
        "the same with substeps = 10",
        "",
        WHOLE,
        act="stiff",
        entry="substeps = 10",
        exact=False,
    ),
]

PROCESS = [
    harmless("banner", "prints banners on stdout and stderr"),
    harmless("flood", "prints megabytes in every step", versions=(2,)),
    harmless("log_flood", "logs 5000 messages in every step", versions=(2,)),
    harmless("log_null", "warns with a message that is NULL", "unit 'bad' gave 5 warnings"),
    harmless("log_percent", "warns with a message that holds % and no format", "unit 'bad' gave 5 warnings"),
    in_step(
        "log_format",
        "logs a format with arguments that are no strings",
        _DIED + "was killed by SIGSEGV",
        versions=(1, 2),
    ),
    harmless("log_format", "logs %s and %n", "unit 'bad' gave 5 warnings", versions=(3,)),
    in_step("log_not_utf8", "logs bytes that are no UTF-8, and fails", "DoStep returned Error"),
    in_step("log_escapes", "logs what clears a terminal, and fails", "DoStep returned Error"),
    harmless("log_status", "logs a status that there is not", versions=(3,)),
    harmless("log_long", "warns with a message of 4 MB", "unit 'bad' gave 5 warnings"),
    harmless("log_foreign", "logs with another component environment", versions=(2,)),
    harmless("log_thread", "warns from another thread", "unit 'bad' gave 500 warnings"),
    harmless("fork", "leaves processes behind, 25 of them", versions=(3,)),
    harmless("daemon", "leaves a process behind in a session of its own"),
    harmless("signals", "ignores all signals", versions=(2,)),
    harmless("chdir", "changes the working folder", versions=(3,)),
    harmless("environment", "clears the environment", versions=(2,)),
    harmless("locale", "changes the locale", versions=(3,)),
    harmless("no_files", "forbids its process to open files", versions=(2,)),
    harmless("rounding", "rounds upwards", versions=(3,)),
    harmless("flush_to_zero", "flushes small numbers to zero", versions=(2,)),
    harmless("traps", "lets floating-point exceptions kill", versions=(3,)),
    harmless("reads_input", "waits for a license key from stdin", versions=(2,)),
    harmless("own_files", "overwrites its own library and resources", versions=(3,)),
    harmless("close_output", "closes stdout and stderr", versions=(2,)),
]
