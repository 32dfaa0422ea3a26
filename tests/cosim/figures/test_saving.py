"""Figures as files: the same bytes for the same figure, and no other format or place than there is."""

from pathlib import Path

import matplotlib
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures.draw import draw
from evcosim.cosim.figures.saving import save, write
from evcosim.cosim.figures.style import style
from support.outlined_scooter import SPEC, scooter

PNG_WIDTH = 1440


def test_saved_twice_is_the_same_bytes_whatever_the_user_s_settings(tmp_path: Path) -> None:
    first = save(draw(scooter(), SPEC), tmp_path / "a")
    with matplotlib.rc_context(
        {"font.size": 30.0, "axes.grid": False, "svg.hashsalt": "x", "figure.dpi": 50}
    ):
        second = save(draw(scooter(), SPEC), tmp_path / "b")
    assert [p.name for p in first] == ["figure.png", "figure.svg"]
    assert [p.read_bytes() for p in first] == [p.read_bytes() for p in second]
    width = int.from_bytes(first[0].read_bytes()[16:20], "big")
    assert width == PNG_WIDTH


def test_what_it_shows_is_placed_once_for_both_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    figure = draw(scooter(), SPEC)
    engine, placed = figure.get_layout_engine(), []
    assert engine is not None
    execute = engine.execute
    monkeypatch.setattr(engine, "execute", lambda of: placed.append(execute(of)))
    save(figure, tmp_path)
    assert len(placed) == 1
    assert figure.get_layout_engine() is engine  # whoever goes on with the figure finds it so
    with style():
        draw(scooter(), SPEC).savefig(tmp_path / "beside.png", metadata={"Software": None})
    assert (tmp_path / "beside.png").read_bytes() == (tmp_path / "figure.png").read_bytes()


def test_a_format_or_a_place_that_does_not_exist_is_named(tmp_path: Path) -> None:
    figure = draw(scooter(), SPEC)
    with pytest.raises(ConfigError, match=r"x.bmp2: 'bmp2' is not a format of figures; use one of .*png"):
        write(figure, tmp_path / "x.bmp2")
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="cannot be written"):
        save(figure, tmp_path / "file")


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_figure_is_written_in_the_format_that_its_name_ends_in(kind: str, tmp_path: Path) -> None:
    begin = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}
    path = tmp_path / "made" / f"x.{kind.upper()}"
    write(draw(scooter(), SPEC), path)
    first = path.read_bytes()
    assert first.startswith(begin[kind])
    write(draw(scooter(), SPEC), path)
    assert path.read_bytes() == first
