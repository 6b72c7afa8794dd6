"""Lists of supports held against a slow enumeration: every three holes, and every place of the clamp, by cells.

The enumeration is the one of ``verification.support_listing``, which shares no arithmetic with the search."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from random import Random

import pytest
from attrs import evolve

from supports.cases import case
from supports.random_supports import TOOLKITS, random_demand, random_fixtures
from workhold import Fixture
from workhold.files.supports_file import write_supports
from workhold.model.support_request import SupportRequest
from workhold.supports.listing import find_supports
from workhold.verification.supports import verify_supports_file


def with_reach(random: Random, request: SupportRequest, fixture: Fixture) -> SupportRequest:
    """The request, now and then with a clamp that reaches only a ring or two about its pegs."""
    if random.random() < 0.6:
        return request
    rings = [(peg.x, peg.y, 5.0, random.uniform(15, 60)) for peg in random.sample(fixture.placed, 2)]
    return evolve(request, reach=rings)


def compare(seed: int, of_each: int, path: Path) -> Counter[str]:
    """Compares the lists of some fixtures in each toolkit with the enumeration; counts what was compared."""
    seen = Counter[str]()
    for random, query, fixture in random_fixtures(seed, of_each):
        request, loads = random_demand(random, query.workpiece)
        found = find_supports(fixture, query, with_reach(random, request, fixture), loads)
        write_supports(found, path)
        outcome = verify_supports_file(path)
        assert outcome.holds, (seed, query.toolkit, outcome.faults, outcome.unproven[:1])
        seen += Counter({"fixtures": 1, "triples": len(found.triples), "undecided": outcome.undecided})
        seen["with triples"] += bool(found.triples)
    return seen


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [pytest.param(11, marks=pytest.mark.prove), 12])
def test_lists_of_random_fixtures_are_complete(seed: int, tmp_path: Path) -> None:
    """One fixture in each kind of toolkit, with zones, margins, limits of columns and reach."""
    seen = compare(seed, 1, tmp_path / "supports.json")
    assert seen["fixtures"] >= len(TOOLKITS) - 2 and seen["with triples"] > 2 and not seen["undecided"]


@pytest.mark.prove
def test_lists_of_two_hundred_fixtures_are_complete(tmp_path: Path) -> None:
    """Two hundred fixtures of random parts in all kinds of toolkits."""
    seen = Counter[str]()
    for seed in range(100, 140):
        if seen["fixtures"] < 200:
            seen += compare(seed, 1, tmp_path / "supports.json")
    assert seen["fixtures"] >= 200 and seen["with triples"] > 60 and not seen["undecided"]


@pytest.fixture(scope="module")
def complete_list(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The file of a complete list."""
    one = case("bracketL")
    path = tmp_path_factory.mktemp("complete") / "supports.json"
    write_supports(find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force), path)
    assert verify_supports_file(path).holds
    return path.read_text()


@pytest.fixture
def written(complete_list: str, tmp_path: Path) -> Path:
    """A copy of that file."""
    path = tmp_path / "supports.json"
    path.write_text(complete_list)
    return path


def refusal(path: Path) -> str:
    """The first sentence that a judge has against a file."""
    outcome = verify_supports_file(path)
    assert not outcome.holds
    return (*outcome.faults, *(one.reason for one in outcome.unproven))[0]


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("place", [0, 40, -1])
def test_a_removed_triple_is_missed(written: Path, place: int) -> None:
    """Also where the count was made smaller with it."""
    entry = json.loads(written.read_text())
    del entry["triples"][place]
    written.write_text(json.dumps(entry))
    assert "counts say 92 triples, but 91 are listed" in refusal(written)
    entry["counts"]["triples"] -= 1
    written.write_text(json.dumps(entry))
    assert "is missing" in refusal(written)


@pytest.mark.thorough
def test_a_moved_hole_and_a_wrong_count_of_holes_are_refused(written: Path) -> None:
    """A triple in another hole has other figures, or breaks a rule; holes are counted anew."""
    text = written.read_text()
    entry = json.loads(text)
    entry["triples"][0]["holes"][0][2] += 1
    written.write_text(json.dumps(entry))
    assert refusal(written)
    entry = json.loads(text)
    entry["counts"]["positions"] += 1
    written.write_text(json.dumps(entry))
    assert "holes could hold a support, but" in refusal(written)


@pytest.mark.thorough
def test_a_wrong_band_is_refused(written: Path) -> None:
    """Figures hold for the worst heights of the band that is written."""
    entry = json.loads(written.read_text())
    entry["heights"]["band"][0] *= 0.5
    written.write_text(json.dumps(entry))
    assert " at the best point is " in refusal(written)


@pytest.mark.thorough
def test_more_listed_than_counted_is_refused(written: Path) -> None:
    """A list that does not say it is complete still has no more triples than are counted."""
    entry = json.loads(written.read_text())
    entry |= {"complete": False, "counts": {"positions": 29, "triples": 5}}
    written.write_text(json.dumps(entry))
    assert refusal(written) == "counts say 5 triples, but 92 are listed"
