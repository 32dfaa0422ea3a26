"""The entries of a DBC file: all spellings of a statement that real files have."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.can.dbc_entries import Definition, entries, number, whole
from evcosim.cosim.can.dbc_statements import statements

MESSAGE = 'BO_ 1 M: 8 A\n SG_ S : 0|8@1+ (1,0) [0|0] "" B\n'


def read(text: str):
    return entries(statements(text))


@pytest.mark.parametrize(
    ("line", "values"),
    [
        ('SG_ S : 0|8@1+ (1,0) [0|0] "" B', ("S", "", "0", "8", "1", "+", "1", "0", "0", "0", "", ("B",))),
        (
            'SG_ S:7|8@0-(-.5,+1E-3)[-1|1.]"km/h"B,C',
            ("S", "", "7", "8", "0", "-", "-.5", "+1E-3", "-1", "1.", "km/h", ("B", "C")),
        ),
        (
            'SG_ S m0M : 0|8@1+ (1,0) [0|0] "\\"" Vector__XXX',
            ("S", "m0M", "0", "8", "1", "+", "1", "0", "0", "0", '"', ()),
        ),
        ('SG_ S M:0|8@1+ (1,0) [0|0] "°"', ("S", "M", "0", "8", "1", "+", "1", "0", "0", "0", "°", ())),
        (
            'SG_ Größe : 0 | 8 @ 1 + ( 1 , 0 ) [ 0 | 0 ] "" A B ',
            ("Größe", "", "0", "8", "1", "+", "1", "0", "0", "0", "", ("A", "B")),
        ),
    ],
)
def test_spellings_of_a_signal(line, values):
    made = read(f"BO_ 1 M: 8 A\n {line}\n")
    (signal,) = made.messages[0].signals
    assert dataclasses.astuple(signal) == (2, *values)
    assert not made.notes


def test_an_entry_may_stand_before_what_it_is_about():
    made = read('CM_ SG_ 1 S "text";\nVAL_ 1 S 3 "Three" 1.0 "One" ;\nSIG_VALTYPE_ 1 S 2;\n' + MESSAGE)
    assert (made.comments, made.choices) == ({(1, "S"): "text"}, {(1, "S"): {3: "Three", 1: "One"}})
    assert (made.floats, made.notes) == ({(1, "S"): 2}, [])


def test_what_evcosim_needs_nothing_of_is_passed_over():
    made = read(
        MESSAGE
        + 'EV_ E: 0 [0|1] "" 0 1 DUMMY_NODE_VECTOR0 A;\nVAL_ E 1 "On" 0 "Off" ;\nSIG_GROUP_ 1 G 1 : S;\n'
        'VAL_TABLE_ T 1 "On" ;\nBA_REL_ "x" BU_BO_REL_ A 1 3;\nBA_DEF_REL_ BU_BO_REL_ "x" INT 0 9;\n'
        'BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n SG_ Lost : 0|8@1+ (1,0) [0|0] "" B\n'
        'CM_ SG_ 3221225472 Lost "nobody sends it";\n'
    )
    assert [m.name for m in made.messages] == ["M"]
    assert made.notes == []


def test_attributes_and_their_definitions():
    made = read(
        MESSAGE + 'BA_DEF_ BO_ "Kind" ENUM "a","b b";\nBA_DEF_ "Free" STRING ;\nBA_DEF_DEF_ "Kind" "a";\n'
        'BA_ "Kind" BO_ 1 1;\nBA_ "Free" "text";\n'
    )
    assert made.definitions == {"Kind": Definition("ENUM", ("a", "b b")), "Free": Definition("STRING", ())}
    assert (made.defaults["Kind"].value, made.of_file["Free"].value) == ("a", "text")
    kind = made.attribute((1, ""), "Kind")
    assert kind is not None and (kind.value, kind.line) == ("1", 6)


def test_the_values_of_an_extended_multiplexer():
    made = read(MESSAGE + "SG_MUL_VAL_ 1 S Page 0-3, 7-7,9 - 12;\n")
    assert made.selectors == {(1, "S"): ("Page", ((0, 3), (7, 7), (9, 12)))}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5", 5),
        ("-5", -5),
        ("5.0", 5.0),
        ("1e400", None),
        ("nan", None),
        ("", None),
        ("18446744073709551615", 2**64 - 1),
    ],
)
def test_numbers(text, value):
    assert (number(text), type(number(text))) == (value, type(value))
    assert whole(text) == (None if value is None else int(value))


@pytest.mark.parametrize(
    "text",
    [
        'BA_ "GenMsgCycleTime" BO_ 1 abc;',
        'BA_ "Of a \\" name" SG_ 1 S what;',
        "BA_ BO_ 1 5;",
        "CM_ BO_ 1 no string;",
        "VAL_ 1 S 1 no string;",
        "SIG_VALTYPE_ 1 S : x;",
        "BO_TX_BU_ 1 A;",
    ],
)
@pytest.mark.parametrize("first", [True, False])
def test_what_cannot_be_read_about_a_message_names_it(text: str, first: bool) -> None:
    message = 'BO_ 1 M: 8 A\n SG_ S : 0|8@1+ (1,0) [0|0] "" B\n'
    found = entries(statements(f"{text}\n{message}" if first else f"{message}\n{text}\n"))
    said = f"message 'M': not valid in a DBC file: '{text.rstrip(';')}'"
    assert (1 if first else 4, said) in [(line, note.replace(";'", "'")) for line, note in found.notes]


def test_what_cannot_be_read_about_no_message_names_none() -> None:
    found = entries(statements('BO_ 1 M: 8 A\nBA_ "x" BO_ 7 abc;\nBA_ "x" abc;\n'))
    assert [note.partition(":")[0] for _, note in found.notes] == ["not valid in a DBC file"] * 2
