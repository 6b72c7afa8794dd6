"""Whatever fixtures are ranked by, the best K are the first K of all, byte for byte: every figure, every preference, loads.

Half the parts are random outlines, half come as out of CAD, with the coincidences that make fixtures equal.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from random import Random
from typing import Any

import attrs
import pytest
from test_random_restrictions import random_toolkit

from cad_parts import cad_part
from strategies import random_outline
from workhold import InputError, Load, Plate, Result, Workpiece, design
from workhold.fixels.toolkit import Toolkit
from workhold.model.quality import (
    CLAMP_FREEDOM,
    FIGURES,
    JAW_CONTACT,
    JAW_FORCE_NEEDED,
    LOAD_REACTION,
    PREFERENCES,
)
from workhold.search import lattice_shares

pytestmark = pytest.mark.thorough


@pytest.fixture(autouse=True)
def few_contacts_are_left_out_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Searches for two clamps stop early however few contacts they have."""
    monkeypatch.setattr(lattice_shares, "COUNTED_WHOLE", 0)


# How many are asked for, and fixtures beyond which a part is left out: all are listed for each ranking.
KEPT = (1, 20)
MOST = 2000
LOADS = (
    Load(points=[(10.0, 5.0)], force=200.0, directions=(30.0, 60.0)),
    Load(points=[(0.0, 0.0)], moment=500.0),
)
OF_LOADS = {LOAD_REACTION, JAW_FORCE_NEEDED}


def rankings(toolkit: Toolkit, loads: bool) -> Iterator[dict[str, Any]]:
    """Every ranking that there is for a toolkit: the usual one, by what is preferred, and by each figure alone."""
    yield {}
    yield from ({"prefer": word} for word in PREFERENCES)
    two = isinstance(toolkit, Plate) and toolkit.clamps == 2
    # Those of a jaw's ends and of pegs that bend need what no case here has.
    for number, figure in enumerate(FIGURES[:JAW_CONTACT]):
        if (loads or number not in OF_LOADS) and (two or number != CLAMP_FREEDOM):
            yield {"rank_by": [figure.option]}


def drawn(seed: int) -> tuple[Workpiece, Toolkit, dict[str, Any]]:
    """A random part, a toolkit of any kind, and what else is asked: loads or none, of two clamps all pairs or the best."""
    random = Random(seed)
    toolkit = random_toolkit(random)
    part = random_outline(random, random.choice([3, 4, 5, 6]))
    if seed % 2:
        part, toolkit = cad_part(seed // 2), attrs.evolve(toolkit, pitch=random.choice([25.0, 30.0, 40.0]))
    asked: dict[str, Any] = {"threads": 1}
    if random.random() < 0.5:
        asked["loads"] = LOADS
    if isinstance(toolkit, Plate) and toolkit.clamps == 2 and random.random() < 0.5:
        asked["listing"] = "all"
    return part, toolkit, asked


def is_begun_by(whole: Result, best: Result, most: int) -> bool:
    """Whether a list is the beginning of another to the last byte."""
    pairs = zip(best.table.columns, whole.table.columns, strict=True)
    return all(one.tobytes() == every[:most].tobytes() for one, every in pairs)


def differences(seed: int) -> tuple[int, list[str]]:
    """How many rankings were tried on a random part, and those whose best are not the first of all."""
    part, toolkit, asked = drawn(seed)
    tried, out = 0, list[str]()
    try:
        if not 0 < len(design(part, toolkit, **asked)) <= MOST:
            return 0, []
    except InputError:
        return 0, []
    for ranking in rankings(toolkit, "loads" in asked):
        whole = design(part, toolkit, **ranking, **asked)
        for most in KEPT:
            best = design(part, toolkit, best=most, **ranking, **asked)
            tried += 1
            if not is_begun_by(whole, best, most):
                out.append(f"{seed}: the best {most} of {part.name} in {toolkit} by {ranking or 'default'}")
    return tried, out


# Every kind of toolkit once, half of them with loads; among them one and two clamps.
A_FEW = (0, 3, 4, 7, 15, 20)
MANY = [range(12 * block, 12 * (block + 1)) for block in range(20)]


@pytest.mark.parametrize("some", [A_FEW, *(pytest.param(block, marks=pytest.mark.prove) for block in MANY)])
def test_by_any_ranking_the_best_are_the_first_of_all(some: Iterable[int]) -> None:
    outcomes = [differences(seed) for seed in some]
    assert [line for _, lines in outcomes for line in lines] == []
    assert sum(tried for tried, _ in outcomes) > 100
