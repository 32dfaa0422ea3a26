"""`evcosim compare`: exit code, table, figure and JSON of two results."""

from __future__ import annotations

from evcosim.cosim.results.results import Results


def test_compare(evcosim, two_runs):
    same = evcosim("compare", "a", "a")
    assert (same.code, same.out.startswith("equal")) == (0, True)
    other = evcosim("compare", "a", "b", "--plot", "both.png")
    assert other.code == 1
    assert "vehicle.speed" in other.out
    assert (two_runs / "both.png").stat().st_size > 10_000
    in_range = evcosim("compare", "a", "b", "--tolerance", "1e9")
    assert in_range.code == 0
    assert "metric " in other.out and not any("metric " in answer.out for answer in (same, in_range))
    line = next(line for line in other.out.splitlines() if line.startswith("mean speed "))
    said = [Results.read(name).manifest["metrics"]["mean speed"]["value"] for name in ("a", "b")]
    assert line.split()[2::2] == [f"{value:.6g}" for value in said]
    data = evcosim("compare", "a", "b", "--json").json
    assert (data["equal"], data["common"]) == (False, False)
    metrics = {m["name"]: m for m in data["metrics"]}
    mean = metrics["mean speed"]
    assert ([mean["a"], mean["b"]], mean["a_unit"], mean["equal"]) == (said, "km/h", False)
    table = other.out.partition("metric ")[2].partition("\n\n")[0].splitlines()[1:]
    assert {line.split("  ")[0] for line in table} <= {m for m in metrics if not metrics[m]["equal"]}
    assert evcosim("compare", "a", "b", "--json", "--signals", "vehicle.speed").json["metrics"] == []
    assert all(m["equal"] for m in evcosim("compare", "a", "a", "--json").json["metrics"])
    assert evcosim("compare", "a", "b", "--tolerance", "-1").code == 2


def test_a_page_of_two_runs(evcosim, two_runs):
    said = evcosim("compare", "a", "b", "--plot", "both.html")
    assert said.code == 1 and said.out == evcosim("compare", "a", "b").out
    page = (two_runs / "both.html").read_text(encoding="utf-8")
    assert "<title>a and b</title>" in page and "What differs in how they were made" in page
    assert evcosim("compare", "a", "b", "--signals", "vehicle.speed", "--plot", "one.HTML").code == 1
    assert "vehicle.speed: difference" in (two_runs / "one.HTML").read_text(encoding="utf-8")


def test_two_tables_of_other_times_are_compared_at_the_times_of_both(evcosim, tmp_path):
    (tmp_path / "a.csv").write_text("time,v\n0,0\n2,2\n3,3\n")
    (tmp_path / "b.csv").write_text("time,v\n0,0\n1,9\n2,2\n")
    said = evcosim("compare", "a.csv", "b.csv")
    assert said.code == 1
    lines = said.out.splitlines()
    assert "different: 1 of 1 common variables at 3 times, tolerance 0" in lines
    assert "the first goes from 0 to 3 s, the second from 0 to 2 s" in lines
    assert lines[-1] == "not compared: 1 point of the first at 3 s"
    other = evcosim("compare", "b.csv", "a.csv", "--json").json
    assert (other["equal"], other["points"], other["rows"][0]["difference"]) == (False, 3, 8.0)
    assert other["not_compared"] == [{"side": "second", "points": 1, "begin": 3.0, "end": 3.0}]
    assert evcosim("compare", "a.csv", "b.csv", "--relative", "1e400").code == 2


def test_a_variable_on_one_side_alone(evcosim, tmp_path):
    (tmp_path / "a.csv").write_text("time,u.v,u.w\n0,0,1\n1,0,1\n")
    (tmp_path / "b.csv").write_text("time,u.v\n0,0\n1,0\n")
    for pair, side in ((("a.csv", "b.csv"), "first"), (("b.csv", "a.csv"), "second")):
        said = evcosim("compare", *pair)
        assert (said.code, said.out.splitlines()[-1].startswith(f"only in the {side}: u.w (a diff")) == (
            1,
            True,
        )
        common = evcosim("compare", *pair, "--common")
        assert (common.code, common.out.splitlines()[-1]) == (0, f"only in the {side}: u.w")
        assert evcosim("compare", *pair, "--signals", "u.*").code == 1
        assert evcosim("compare", *pair, "--signals", "u.w").code == 1
        assert evcosim("compare", *pair, "--signals", "u.v").code == 0
        assert evcosim("compare", *pair, "--signals", "x.*").code == 2
        assert evcosim("compare", *pair, "--signals", "u.*", "--plot", "x.html").code == 1
        assert evcosim("compare", *pair, "--signals", "u.*", "--plot", "x.png").code == 1
        data = evcosim("compare", *pair, "--common", "--json").json
        assert (data["equal"], data["common"], data["only_a"] + data["only_b"]) == (True, True, ["u.w"])


SHORT = ("--stop-time", "0.1")


def test_a_run_and_a_comparison_say_it(tmp_path, evcosim):
    path = tmp_path / "drive.csv"
    path.write_text("time;throttle\n0;10\n1;1.500\n")
    answer = evcosim(
        "run", "Scooter", "--input", f"throttle={path}", "--stop-time", "0.1", "-o", str(tmp_path / "r")
    )
    said = " ".join(answer.err.split()) + " ".join(answer.out.split())
    assert answer.code == 0
    assert "drive.csv: line 3, column 'throttle': '1.500' is read as 1.5; where the point" in said
    answer = evcosim("compare", str(path), str(path))
    assert answer.code == 0 and "'1.500' is read as 1.5; where" in " ".join(answer.err.split())


def test_a_file_compared_with_itself_has_one_warning(evcosim, tmp_path):
    (tmp_path / "a.csv").write_text("time;v\n0;1.500\n1;2.000\n")
    for other in ("a.csv", "./a.csv", str(tmp_path / "a.csv")):
        said = evcosim("compare", "a.csv", other)
        assert (said.code, said.err.count("warning: a.csv: line 2")) == (0, 1)


def test_a_pattern_with_an_exclamation_mark_leaves_out(evcosim, tmp_path):
    (tmp_path / "a.csv").write_text("time,u.v,w.a,w.b\n0,0,1,1\n")
    (tmp_path / "b.csv").write_text("time,u.v,w.a,w.b\n0,0,1,2\n")
    codes = [
        evcosim("compare", "a.csv", "b.csv", *(word for p in patterns for word in ("--signals", p))).code
        for patterns in (["!w.*"], ["!w.b"], ["!u.*"], ["!w.b", "w.*"], ["w.b"], ["!*"], ["!x.*"])
    ]
    assert codes == [0, 0, 1, 0, 1, 2, 2]
    assert "--signals !*: no variable is left" in evcosim("compare", "a.csv", "b.csv", "--signals", "!*").err


def test_two_columns_of_times_are_a_warning(evcosim, tmp_path):
    (tmp_path / "a.csv").write_text("t [s],time,x\n0,0,1\n1,2,5\n")
    said = evcosim("compare", "a.csv", "a.csv")
    assert (said.code, said.err.count("2 is taken as the time, though column 't [s]' has another one")) == (
        0,
        1,
    )
