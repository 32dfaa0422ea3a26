"""HTML of sections: whatever goes in comes out as text."""

from __future__ import annotations

from evcosim.cosim.report.markup import block, escaped, folded, listed, section, table


def test_texts_are_escaped_in_every_part():
    bad = "<b>\"&'\u202e"
    for made in (
        escaped(bad),
        block(bad),
        section(bad, "x"),
        folded(bad, "x"),
        listed([bad]),
        table([bad], [[bad]]),
    ):
        assert "<b>" not in made and "\u202e" not in made
        assert "&lt;b&gt;&quot;&amp;&#x27;\\u202e" in made


def test_lines_are_kept_in_a_block_alone():
    assert escaped("a\nb") == "a b"
    assert block("a\nb") == "<pre>a\nb</pre>"


def test_what_is_empty_is_left_out():
    assert [section("a"), section("a", "", ""), folded("a", ""), listed([]), table(["a"], [])] == [""] * 5


def test_a_table_says_which_columns_stand_at_the_right():
    made = table(("a", "b"), [("1", "2")], right=("b",))
    assert '<th class="right">b</th>' in made
    assert '<td data-head="a">1</td><td class="right" data-head="b">2</td>' in made
    assert "stacks" not in made and 'class="stacks"' in table(("a", "b", "c"), [("1", "2", "3")])
