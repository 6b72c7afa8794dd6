"""``--load``: what a user may type, and what is said when it cannot be used."""

from __future__ import annotations

import pytest

from workhold.cli.search_options import parse_load
from workhold.errors import InputError
from workhold.model.requirements import ANY_DIRECTION, Load


@pytest.mark.parametrize(
    ("text", "load"),
    [
        ("force=200 at=10,5 direction=30..60", Load([(10, 5)], 200, (30, 60))),
        ("force=200 at=10,5", Load([(10, 5)], 200, ANY_DIRECTION)),
        ("force=200 at=10,5 direction=any", Load([(10, 5)], 200, ANY_DIRECTION)),
        ("force=200 at=10,5 direction=0..360", Load([(10, 5)], 200, ANY_DIRECTION)),
        ("force=200 at=10,5 direction=90", Load([(10, 5)], 200, (90, 90))),
        ("force=200 at=-10,.5 direction=-30..30", Load([(-10, 0.5)], 200, (330, 390))),
        ("force=200 at=10,5 direction=350..10", Load([(10, 5)], 200, (350, 370))),
        ("moment=5000", Load(moment=5000)),
        ("moment=-5N.m", Load(moment=-5000)),
        ("moment=5N·m", Load(moment=5000)),
        ("force=0.2kN at=1,2 moment=3", Load([(1, 2)], 200, moment=3)),
        ("force=150 path=0,0;40,0;40,20", Load([(0, 0), (40, 0), (40, 20)], 150)),
        ("name='rough cut' force=1.5e2 at=1,1", Load([(1, 1)], 150, name="rough cut")),
    ],
)
def test_what_may_be_typed(text: str, load: Load) -> None:
    """Each text is the load it describes."""
    assert parse_load(text, 1.0) == load


def test_lengths_are_in_the_users_unit() -> None:
    """Points are scaled; force, direction and moment are not."""
    assert parse_load("force=2 at=1,2 direction=30 moment=5", 25.4) == Load([(25.4, 50.8)], 2, (30, 30), 5)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "does nothing"),
        ("force=200", "needs the point it acts at"),
        ("force=200 N at=1,1", "cannot be used at 'N'"),
        ("force=200 at=10", "at '10' is not a point"),
        ("force=200 at=10;5", "at '10;5' is not a point"),
        ("force=200 at=10mm,5", "is not a point"),
        ("force=200 at=10,5 direction=1..2..3", "direction '1..2..3' cannot be used"),
        ("force=200 at=10,5 direction=0..361", "at most 360 degrees"),
        ("force=two at=10,5", "force 'two' cannot be used"),
        ("force=200 force=300 at=10,5", "has force twice"),
        ("power=200", "unknown key 'power'"),
        ("direction=30", "has direction but no force"),
        ("name='rough", "quote that is not closed"),
        ("force=1_000 at=0,0", "force '1_000' cannot be used"),
        ("force=200 path=0,0", "path '0,0' is not a path"),
    ],
)
def test_bad_loads_are_refused_in_one_sentence(text: str, said: str) -> None:
    """The message shows what was typed and says what to type."""
    with pytest.raises(InputError) as refused:
        parse_load(text, 1.0)
    message = str(refused.value)
    assert (
        said in message
        and message.startswith(f'--load "{text}"')
        and message.endswith(".")
        and "\n" not in message
    )
