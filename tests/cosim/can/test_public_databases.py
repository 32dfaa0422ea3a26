"""The trial of public DBC files: what it finds in files of which it is known, and what its table says."""

from __future__ import annotations

import csv

from support.public_databases import TABLE, tried

GOOD = """VERSION ""
BS_:
BU_: A B
BO_ 256 M: 8 A
 SG_ Page M : 0|4@1+ (1,0) [0|15] "" B
 SG_ All : 15|12@0- (0.1,-5) [0|0] "" B
 SG_ P1 m1 : 32|16@1+ (1,0) [0|0] "" B
 SG_ P2 m2 : 40|16@1+ (1,0) [0|0] "" B
BO_ 2147483905 F: 12 A
 SG_ Real : 0|32@1- (1,0) [0|0] "" B
 SG_ Wide : 32|64@1+ (1,0) [0|0] "" B
 SG_ Odd : 0|8@1+ (1,0) [0|0] "" B
SIG_VALTYPE_ 2147483905 Real : 1;
"""


def test_the_outcome_of_two_files(tmp_path):
    home = tmp_path / "own+er" / "sub"
    home.mkdir(parents=True)
    (tmp_path / "own+er" / "REVISION").write_text("abc\n")
    (home / "bad.DBC").write_text("no database")
    (home / "good.dbc").write_text(GOOD)
    bad, good = tried(tmp_path)
    assert (bad.repository, bad.path, bad.revision) == ("own/er", "sub/bad.DBC", "abc")
    assert bad.loads == "line 1: not valid in a DBC file: 'no database'"
    assert (good.loads, good.messages, good.signals, good.usable) == ("yes", 2, 7, 5)
    assert (good.values, good.different_values, good.different_frames) == (15, 0, 0)
    assert good.frames > 0
    assert good.reasons == "2 x # and # overlap in bits # to #"


def test_the_table_of_public_files():
    rows = list(csv.DictReader(TABLE.read_text(encoding="utf-8").splitlines()))
    load = [row for row in rows if row["loads"] == "yes"]
    signals, usable = (sum(int(row[key]) for row in load) for key in ("signals", "usable"))
    assert len(load) == len(rows) > 240
    assert usable > 0.95 * signals > 50_000
    assert {row["different_values"] for row in rows} == {row["different_frames"] for row in rows} == {"0"}
    assert all(row["reasons"] for row in load if row["usable"] != row["signals"])
