"""Every error: one screen of text with place, rule and values, the right exit code, no traceback."""

from __future__ import annotations

import errno
import resource
import shlex
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

from evcosim.cosim.results.results import Results
from evcosim.cosim.system.toml import DATA
from evcosim.master.builtin import fmu_file
from evcosim.master.cli import failures
from evcosim.master.engine import progress
from support.answers import refused

SCOOTER = (DATA / "systems" / "scooter.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "texts"),
    [
        (["run", "scoter"], ["unknown system 'scoter' (did you mean 'scooter'?)"]),
        (["run", "no/such.toml"], ["no/such.toml: there is no such system file"]),
        (
            ["run", "scooter", "-s", "fig88"],
            ["system 'scooter' has no scenario 'fig88' (did you mean 'fig8'?); known: "],
        ),
        (["run", "scooter", "-s", "no.toml"], ["no.toml: there is no such scenario file"]),
        (["run", "scooter", "--set", "ecu.gian=1"], ["--set ecu.gian=1:", "(did you mean 'gain'?)"]),
        (["run", "scooter", "--set", "ecm.gain=1"], ["--set ecm.gain=1:", "(did you mean 'ecu'?)"]),
        (
            ["run", "scooter", "--set", "vehicle.mass=0.5"],
            ["--set vehicle.mass=0.5: 0.5 kg", "minimum 1.0 kg"],
        ),
        (["run", "scooter", "--set", "vehicle.mass=heavy"], ["--set vehicle.mass=heavy:", "Real", "'heavy'"]),
        (["run", "scooter", "--set", "vehicle.mass"], ["--set vehicle.mass:", "unit.parameter=value"]),
        (["run", "scooter", "--set", "ecu.throttle=1"], ["--set ecu.throttle=1:", "output", "parameter"]),
        (["run", "scooter", "--fmu", "vehicle"], ["--fmu vehicle:", "unit=PATH"]),
        (
            ["run", "scooter", "--fmu", "vehicel=x.fmu"],
            ["--fmu vehicel=x.fmu: there is no unit 'vehicel' (did you mean 'vehicle'?)"],
        ),
        (
            ["run", "scooter", "--fmu", "vehicle=Battery"],
            ["'evcosim check Battery --as scooter.vehicle' shows"],
        ),
        (["run", "scooter", "--fmu", "vehicle=x.fmu"], ["--fmu vehicle: x.fmu: there is no such FMU file"]),
        (["run", "scooter", "--stop-time", "inf"], ["--stop-time inf s is not finite"]),
        (["run", "scooter", "--stop-time", "nan"], ["--stop-time nan s is not finite"]),
        (["run", "scooter", "--stop-time", "-1"], ["--stop-time -1.0 s is not after start_time 0.0 s"]),
        (["run", "scooter", "--stop-time", "0.015"], ["0.015 s is not a multiple", "0.01 s"]),
        (["run", "scooter", "--algorithm", "gauss"], ["'gauss'", "gauss_seidel"]),
        (["run", "scooter", "--ideal", "--can-log", "a.log"], ["--can-log and --ideal"]),
        (["run"], ["SYSTEM", "'evcosim run --help'"]),
        (["run", "scooter", "--scenari", "fig8"], ["--scenari", "'evcosim run --help'"]),
        (["rnu"], ["'rnu'", "'evcosim --help'"]),
        (["build", "Scoter"], ["'Scoter' (did you mean 'Scooter'?)"]),
        (["info", "Scoter"], ["'Scoter' (did you mean 'Scooter'?)"]),
        (["info", "no.fmu"], ["no.fmu: there is no such FMU file"]),
        (["info", "Scooter", "--causality", "inptu"], ["--causality inptu", "(did you mean 'input'?)"]),
        (["info", "scooter", "--search", "x"], ["--search", "scooter is a system"]),
        (["plot", "nowhere"], ["nowhere", "No such file"]),
        (["compare", "a", "b"], ["a", "No such file"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) and "evcosim" not in value else "",
)
def test_wrong_arguments(evcosim, arguments, texts):
    refused(evcosim(*arguments), *texts)


@pytest.mark.parametrize(
    ("old", "new", "texts"),
    [
        ("step_size =", "step_sise =", ["scooter.toml: experiment.step_sise", "(did you mean 'step_size'?)"]),
        ("step_size = 0.01", "step_size = 0", ["experiment.step_size", "greater than or equal to 0.00"]),
        ('name = "scooter"', 'name = "scooter', ["scooter.toml: is not valid TOML", "line"]),
        (
            'fmu = "Scooter"',
            'fmu = "Scoter"',
            ["scooter.toml: units.vehicle.fmu: there is no", "(did you mean 'Scooter'?)"],
        ),
        ('from = "vehicle.power"', 'from = "vehicel.power"', ["'vehicel' (did you mean 'vehicle'?)"]),
        ('to = ["ecu.speed_measured"]', 'to = ["ecm.speed_measured"]', ["'ecm' (did you mean 'ecu'?)"]),
        (
            'to = ["ecu.speed_measured"]',
            'to = ["ecu.speed_mesured"]',
            ["connect vehicle.speed -> ecu.speed_mesured", "(did you mean 'speed_measured'?)"],
        ),
        (
            'to = ["battery.power"]',
            'to = ["ecu.speed_measured"]',
            ["vehicle.power [W]", "ecu.speed_measured [km/h]", "different quantities"],
        ),
        ("can0.EMD_Status.", "can0.EMD_Statu.", ["'EMD_Statu' (did you mean 'EMD_Status'?)"]),
        ("EMD_VehicleSpeed", "EMD_VehicleSped", ["'EMD_VehicleSped' (did you mean 'EMD_VehicleSpeed'?)"]),
        ("via = \"can0.EMD", "via = \"can1.EMD", ["'can1' (did you mean 'can0'?)"]),
        ("can/ev.dbc", "can/no.dbc", ["buses.can0.dbc: there is no file 'can/no.dbc'"]),
        (
            'fmu = "Scooter"',
            'fmu = "Scooter"\nparameters = { mass = 0.5 }',
            ["units.vehicle.parameters.mass: 0.5 kg is below the minimum 1.0 kg of mass"],
        ),
    ],
)  # fmt: skip # one case in a few lines
def test_wrong_system_files(evcosim, tmp_path, old, new, texts):
    assert old in SCOOTER
    path = tmp_path / "scooter.toml"
    path.write_text(SCOOTER.replace(old, new), encoding="utf-8")
    refused(evcosim("run", path), *texts)


@pytest.mark.parametrize(
    ("csv", "texts"),
    [
        ("time,throttle\n0,0\n1,\n2,5\n", ["throttle.csv: line 3, column 'throttle'", "missing"]),
        ("time,throttle\n0,0\n1,full\n", ["throttle.csv: line 3, column 'throttle': 'full' is not a number"]),
        ("time,throttle\n0,0\n1\n", ["throttle.csv: line 3 has 1 value, the header has 2"]),
        ("time,throttle\n1,0\n0,5\n", ["throttle.csv", "time goes back from 1.0 s to 0.0 s"]),
    ],
)
def test_wrong_stimulus_files(evcosim, tmp_path, csv, texts):
    (tmp_path / "throttle.csv").write_text(csv)
    scenario = tmp_path / "own.toml"
    scenario.write_text(
        'leave_out = ["rider"]\n[[stimulus]]\nto = "ecu.throttle_request"\ncsv = "throttle.csv"\n'
    )
    refused(evcosim("run", "scooter", "--scenario", scenario), *texts)


def test_files_that_are_no_fmus(evcosim, tmp_path):
    text = tmp_path / "text.fmu"
    text.write_text("not an FMU")
    archive = tmp_path / "archive.fmu"
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("readme.txt", "no FMU")
    for path in (text, archive):
        refused(evcosim("run", "scooter", "--fmu", f"vehicle={path}"), f"{path}: is not an FMU")
        refused(evcosim("info", path), f"{path}: is not an FMU")


def test_fmu_without_a_binary_for_this_platform(evcosim, tmp_path):
    path = tmp_path / "other.fmu"
    with zipfile.ZipFile(fmu_file("Scooter")) as source, zipfile.ZipFile(path, "w") as target:
        for name in source.namelist():
            if f"binaries/{fmpy.platform}/" not in name:
                target.writestr(name, source.read(name))
    refused(evcosim("run", "scooter", "--fmu", f"vehicle={path}"), str(path), "no binary", fmpy.platform)


def test_figure_or_metric_of_what_is_not_recorded_is_found_before_the_run(evcosim, tmp_path):
    scenario = tmp_path / "own.toml"
    metric = '[[metrics]]\nname = "top speed"\nsignal = "vehicle.sped"\nreduce = "max"\nunit = "m/s"\n'
    scenario.write_text('leave_out = ["rider"]\n' + metric)
    refused(evcosim("run", "scooter", "-s", scenario), "own.toml: metric 'top speed'", "(did you mean")
    scenario.write_text(
        'leave_out = ["rider"]\n[[figure.panels]]\nunit = "m/s"\nsignals = ["vehicle.sped"]\n'
    )
    refused(evcosim("run", "scooter", "-s", scenario), "own.toml: figure", "(did you mean 'vehicle.speed'?)")
    assert not Path("results").exists()


def test_algebraic_loop_is_named(evcosim, system):
    loop = '[[connect]]\nfrom = "a.y"\nto = ["b.u"]\n[[connect]]\nfrom = "b.y"\nto = ["a.u"]\n'
    answer = refused(evcosim("run", system({"a": "Through", "b": "Through"}, loop)), "algebraic loop")
    for node in ("a.u", "a.y", "b.u", "b.y"):
        assert node in answer.err


# ---- runs that fail


def test_model_that_raises_in_step_500(evcosim, system, tmp_path):
    answer = evcosim("run", system({"cart": "Fragile"}))
    assert answer.code == 1
    for text in ("t = 5 s", "step 500", "'cart'", "ValueError", "the chain came off after 500 steps"):
        assert text in answer.err, answer.err
    assert "results up to t = 4.99 s; in results/bench: results.csv, run.json" in answer.err
    results = Results.read(tmp_path / "results" / "bench")
    assert np.array_equal(results["cart.way"], np.arange(500.0))
    assert results.manifest["status"] == "failed"
    assert "the chain came off" in results.manifest["error"]
    page = (tmp_path / "results" / "bench" / "report.html").read_text(encoding="utf-8")
    assert page.index("The run failed") < page.index("the chain came off") < page.index('class="charts"')


def test_failed_run_as_json(evcosim, system):
    answer = evcosim("run", system({"cart": "Fragile"}), "--set", "cart.last=7", "--json")
    assert answer.code == 1
    assert answer.json["status"] == "failed"
    assert "the chain came off after 7 steps" in answer.json["error"]
    assert answer.json["steps"] == 7


def test_model_that_raises_in_its_first_step(evcosim, system, tmp_path):
    answer = evcosim("run", system({"cart": "Fragile"}), "--set", "cart.last=0")
    assert answer.code == 1
    assert "t = 0 s" in answer.err
    assert "no step was recorded" in answer.err
    page = (tmp_path / "results" / "bench" / "report.html").read_text(encoding="utf-8")
    assert page.index("The run failed") < page.index("No row was recorded")


def test_nan_on_a_connection(evcosim, system, tmp_path):
    link = '[[connect]]\nfrom = "source.y"\nto = ["sink.u"]\n'
    answer = evcosim("run", system({"source": "Poison", "sink": "Through"}, link))
    assert answer.code == 1
    for text in ("t = 0.09 s", "step 9", "source", "y", "nan"):
        assert text in answer.err, answer.err
    results = Results.read(tmp_path / "results" / "bench")
    assert len(results) == 9
    assert np.isfinite(results.data).all()


# ---- what nobody foresaw


def test_unexpected_exception_is_one_line_and_a_hint(evcosim, monkeypatch):
    def broken():
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr("evcosim.cosim.system.system.system_names", broken)
    answer = evcosim("list")
    assert answer.code == 1
    assert answer.err.splitlines()[0] == "evcosim: unexpected error: ZeroDivisionError: by zero"
    assert "--debug" in answer.err


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (MemoryError(), "no memory is left"),
        (ImportError("a.so: failed to map segment from shared object"), "no memory is left"),
        (RuntimeError("can't start new thread"), "no further thread can be started"),
        (OSError(errno.ENOSPC, "No space left on device"), "No space left on device: make room on the disk"),
        (
            OSError(errno.EMFILE, "Too many open files", "/a"),
            "/a: Too many open files: the limit of open files",
        ),
    ],
)
def test_what_the_machine_lacks_is_said_and_no_unexpected_error(evcosim, monkeypatch, error, words):
    def lacking():
        raise error

    monkeypatch.setattr("evcosim.cosim.system.system.system_names", lacking)
    answer = evcosim("list")
    assert answer.code == 1
    assert answer.err.startswith(f"evcosim: {words}")


@pytest.mark.parametrize("where", ["before", "after", "environment"])
def test_debug_shows_the_traceback(capsys, monkeypatch, where):
    from evcosim.master.cli import main

    arguments = ["run", "scoter"]
    if where == "environment":
        monkeypatch.setenv("EVCOSIM_DEBUG", "1")
    else:
        arguments.insert(0 if where == "before" else 2, "--debug")
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert "Traceback" in said
    assert "unknown system 'scoter'" in said.splitlines()[-1]


def test_long_message_is_cut_to_a_screen(capsys):
    from evcosim.master.cli.failures import complain

    complain("\n".join(f"line {i}" for i in range(100)))
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 20
    assert lines[-1] == "... and 81 more lines; --debug shows them"


def test_copy_of_a_system_beside_its_own_fmu_runs(evcosim, tmp_path):
    """The same edits without a mistake are accepted, so the refusals above are for the mistakes alone."""
    shutil.copy(fmu_file("Scooter"), tmp_path / "Mine.fmu")
    path = tmp_path / "scooter.toml"
    path.write_text(SCOOTER.replace('fmu = "Scooter"', 'fmu = "Mine.fmu"'), encoding="utf-8")
    answer = evcosim("run", path, "--stop-time", "0.1", "--no-plot", "--set", "vehicle.mass=150")
    assert (answer.code, answer.err) == (0, "")


def test_reader_that_goes_away_is_no_error(process):
    run = process("list")
    run.stdout.close()
    run.stdout = None
    assert run.communicate()[1] == ""
    assert run.returncode == 141


@pytest.mark.skipif(sys.platform == "win32", reason="a POSIX shell closes the streams")
@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
@pytest.mark.parametrize(
    ("arguments", "begins", "complains"),
    [
        ("run Battery --stop-time 0.1 --step-size 0.01 --no-plot -q --engine python", "", ""),
        ("run Battery --stop-time 0.1 --step-size 0.01 --no-plot --isolation process", "run ", ""),
        ("list", "System ", ""),
        ("run scoter", "", "evcosim: unknown system"),
    ],
)
def test_a_closed_stream_is_no_error(tmp_path, arguments, begins, complains, closed):
    """What would be printed there is lost, and the other stream has what it has else."""
    command = f"{shlex.join([sys.executable, '-m', 'evcosim'])} {arguments} {closed}"
    ended = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True)
    assert ended.returncode == (2 if complains else 0), ended.stderr
    out, err = begins if closed == "2>&-" else "", complains if closed == ">&-" else ""
    assert ended.stdout.startswith(out) and bool(ended.stdout) == bool(out)
    assert ended.stderr.startswith(err) and bool(ended.stderr) == bool(err)


@pytest.mark.skipif(sys.platform == "win32", reason="a POSIX shell closes the streams")
def test_no_file_gets_the_number_of_a_closed_stream(tmp_path):
    """What native code, or a process started from this one, prints would stand in it."""
    code = (
        "import os, subprocess; from evcosim.master.cli.failures import open_closed_streams as o; o();"
        "file = open('file', 'w'); os.write(1, b'native'); subprocess.run(['echo', 'started'], check=True)"
    )
    subprocess.run(f"{shlex.join([sys.executable, '-c', code])} >&-", shell=True, cwd=tmp_path, check=True)
    assert (tmp_path / "file").read_text() == ""


@pytest.mark.skipif(sys.platform != "linux", reason="how few files Python itself needs is known for Linux")
@pytest.mark.parametrize("most", range(5, 13))
def test_every_number_of_open_files_works_or_is_named(most, process):
    """Python itself needs four: the standard streams, and one file after the other of what it imports."""
    run = process(
        *("run", "scooter", "--stop-time", "0.1", "-o", "out"),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most)),
        close_fds=True,
    )
    err = run.communicate(timeout=60)[1]
    if run.returncode == 0:
        assert err == ""
        return
    assert run.returncode in (1, 2)
    first, *more = err.splitlines()
    assert first.startswith("evcosim: ")
    assert first.endswith(f"Too many open files: the limit of open files is {most} (`ulimit -n`)")
    assert more in ([], ["in out: results.csv, run.json"])


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (
            ("run", "scooter", "--stop-time", "10s"),
            "'--stop-time': a number is needed, as 10 or 0.5, without",
        ),
        (("budget", "scooter", "--workers", "x"), "'--workers': a whole number is needed"),
        (
            ("run", "scooter", "--input", "ecu.throttle_request=3"),
            "a [[stimulus]] of a scenario drives an input",
        ),
        (("identify", "scooter", "--input", "throtle"), "--input throtle: it is not there"),
        (("plot", "."), ".: is a folder without results of a run (results.csv)"),
    ],
    ids=lambda part: part[0] if isinstance(part, tuple) else "",
)
def test_what_was_typed_wrong_is_said_with_what_to_type(evcosim, command, said):
    refused(evcosim(*command), said)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full is a device of Linux")
@pytest.mark.parametrize("arguments", [["list"], ["schema", "system"], ["--version"], ["--help"]])
def test_output_that_finds_no_room_is_named(arguments, process):
    with open("/dev/full", "w") as full:
        run = process(*arguments, stdout=full)
        err = run.communicate(timeout=60)[1]
    said = "evcosim: standard output: No space left on device: make room on the disk\n"
    assert (run.returncode, err) == (1, said)


@pytest.mark.parametrize(
    ("arguments", "terminal", "told"),
    [
        (["run", "scooter"], True, True),
        (["run", "scooter"], False, False),
        (["run", "scooter", "-q"], True, False),
        (["run", "scooter", "--json"], True, False),
    ],
)
def test_what_takes_long_is_told_on_a_terminal(monkeypatch, capsys, arguments, terminal, told):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    with progress.reporting(failures._report_to(arguments)):
        progress.announce("compiling the engine, once: some seconds")
    assert capsys.readouterr().err == ("evcosim: compiling the engine, once: some seconds\n" if told else "")
