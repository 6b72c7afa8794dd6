"""The sheet of small pictures."""

from __future__ import annotations

import pytest
from svg_reading import by_class, matrix, texts

from workhold.drawing import draw_thumbnails
from workhold.errors import InputError
from workhold.fixels.vise import Vise
from workhold.model.fixture import Fixture
from workhold.model.workpiece import Workpiece

Many = tuple[list[Fixture], Workpiece, Vise]


@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_each_fixture_has_a_cell_with_its_caption(many: Many, count: int) -> None:
    """As many thumbnails as fixtures, all to one scale, with title, type, margin and four pegs each."""
    fixtures, workpiece, vise = many
    titles = [f"#{k + 1}" for k in range(count)]
    svg = draw_thumbnails(fixtures[:count], workpiece, vise, titles)
    assert len(by_class(svg, "thumbnail")) == count
    assert len(by_class(svg, "peg")) == 4 * count
    assert len({matrix(group)[0] for group in by_class(svg, "pegs")}) == 1
    words = texts(svg)
    assert [word for word in words if word in titles] == titles
    assert words.count("margin 0.1250") == count
    assert [word for word in words if word.startswith("Type ")] == [
        f"Type {f.type}" for f in fixtures[:count]
    ]


def test_a_sheet_has_its_limits(many: Many) -> None:
    """None, thirteen, or titles missing: refused with a sentence."""
    fixtures, workpiece, vise = many
    for chosen, titles in (([], []), ([*fixtures, fixtures[0]], ["x"] * 13), (fixtures, ["x"])):
        with pytest.raises(InputError):
            draw_thumbnails(chosen, workpiece, vise, titles)
