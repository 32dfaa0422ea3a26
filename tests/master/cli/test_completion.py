"""Completion by the Tab key: the scripts, and the names that are offered for a line."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from evcosim.cosim.system.scenario import scenario_names
from evcosim.cosim.system.system import load_system, system_names
from evcosim.master.builtin import builtin_names
from evcosim.master.cli import completion
from evcosim.master.cli.app import command


@pytest.fixture
def offered(capsys, monkeypatch, tmp_path):
    """The names that the bash script gets for a line whose last word is incomplete.

    In this process; the last test here asks as the script does.
    """
    monkeypatch.chdir(tmp_path)

    def run(line):
        words = line.split(" ")
        monkeypatch.setenv("COMP_WORDS", line)
        monkeypatch.setenv("COMP_CWORD", str(len(words) - 1))
        assert completion.completed(command(), "complete_bash") == 0
        out, err = capsys.readouterr()
        assert err == ""
        return out.split()

    return run


def test_names_for_a_line(offered):
    assert offered("evcosim run sc") == ["scooter"]
    assert offered("evcosim re") == ["reproduce", "results"]
    bounds = ["fig8", "fig8_wheels", "fig9", "fig9_wheels"]
    assert offered("evcosim run scooter --scenario f") == bounds
    assert offered("evcosim new mine --from b") == ["braking"]
    assert offered("evcosim info Sl") == ["SlipController"]
    assert offered("evcosim check my.fmu --as scooter.v") == ["scooter.vehicle"]
    assert offered("evcosim run my.toml --fmu ") == []  # then the shell offers files


def test_scenarios_of_a_system_of_ones_own_stand_beside_it(offered, tmp_path, monkeypatch):
    """And those built in for a system of its name, as a run finds them."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenarios" / "mine").mkdir(parents=True)
    for name in ("calm.toml", "windy.toml", "notes.txt"):
        (tmp_path / "scenarios" / "mine" / name).touch()
    (tmp_path / "own.toml").write_text('name = "mine"\n')
    assert offered("evcosim run own.toml --scenario ") == ["calm", "windy"]
    assert offered(f"evcosim run --ideal {tmp_path}/own.toml -s w") == ["windy"]
    (tmp_path / "own.toml").write_text('name = "scooter"\n')
    assert "fig8" in offered("evcosim budget own.toml --scenario ")


@pytest.mark.parametrize("text", [None, "name = ", "title = 'x'", "name = 3", "name = 'other'"])
def test_an_unknown_or_broken_system_has_no_scenarios(offered, tmp_path, text):
    if text is not None:
        (tmp_path / "own.toml").write_text(text)
    assert offered("evcosim run own.toml --scenario ") == []
    assert offered("evcosim run scoter --scenario ") == []


def test_names_are_those_of_the_files():
    assert completion.systems() == system_names()
    assert completion.fmus() == sorted(builtin_names())
    systems = {name: load_system(name) for name in system_names()}
    assert completion.places() == [f"{name}.{unit}" for name, s in systems.items() for unit in s.file.units]

    class Line:
        """The part of a click context that is looked at."""

        params: dict[str, str]
        args: list[str]

    line = Line()
    for name, system in systems.items():
        line.params, line.args = {"system": name}, []
        assert completion.scenarios(line) == scenario_names(system)
        line.params, line.args = {}, [name]
        assert completion.scenarios(line) == scenario_names(system)
    line.params, line.args = {}, []
    every = {scenario for system in systems.values() for scenario in scenario_names(system)}
    assert completion.scenarios(line) == sorted(every)


def test_the_script_of_a_shell(evcosim):
    for shell, words in (("bash", "complete -o default"), ("zsh", "#compdef evcosim"), ("fish", "complete")):
        answer = evcosim("--show-completion", shell)
        assert (answer.code, answer.err) == (0, "")
        assert words in answer.out and "_EVCOSIM_COMPLETE=complete_" in answer.out


def test_the_shell_is_detected_where_none_is_named(evcosim, monkeypatch):
    monkeypatch.setattr(completion, "_detected", lambda: "zsh")
    assert "#compdef evcosim" in evcosim("--show-completion").out
    monkeypatch.setattr(completion, "_detected", lambda: "")
    answer = evcosim("--show-completion")
    assert answer.code == 2
    assert "the shell is not known; name one of them: bash, zsh, fish" in answer.err


def test_an_unknown_shell(evcosim):
    answer = evcosim("--install-completion", "tcsh")
    assert answer.code == 2
    assert "'tcsh' is no shell that can be set up; name one of them: bash, zsh, fish" in answer.err


def test_installing_it(evcosim, monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    answer = evcosim("--install-completion", "bash")
    script = tmp_path / ".bash_completions" / "evcosim.sh"
    assert (answer.code, answer.err) == (0, "")
    assert str(script) in answer.out
    assert "_evcosim_completion" in script.read_text()
    assert str(script) in (tmp_path / ".bashrc").read_text()
    assert f"{tmp_path / '.bashrc'} was edited" in answer.out


def test_installing_it_for_a_shell_without_a_start_file_to_edit(evcosim, monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    assert "was edited" in evcosim("--install-completion", "zsh").out
    assert (tmp_path / ".zshrc").is_file()
    answer = evcosim("--install-completion", "fish")
    assert "evcosim.fish: completion for fish" in answer.out and "edited" not in answer.out


def test_the_key_is_answered_at_once():
    """Nothing is loaded that a run needs, and no shell is looked for; pydantic is, by typer itself."""
    code = "import sys; from evcosim.master.cli import main; main(); print(*sys.modules, file=sys.stderr)"
    environment = {"_EVCOSIM_COMPLETE": "complete_bash", "COMP_WORDS": "evcosim run sc", "COMP_CWORD": "2"}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ | environment
    )
    assert done.stdout.split() == ["scooter"]
    heavy = {"numpy", "scipy", "fmpy", "rich", "cantools", "shellingham.posix"}
    assert not heavy & set(done.stderr.split())
