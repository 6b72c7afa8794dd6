"""Another program's fixtures are found whatever holes, names and half turns they are written with; others are not."""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workhold.benchmark.catalogue import find_set, make_set_query
from workhold.benchmark.making import compare_entry
from workhold.benchmark.matching import (
    Comparison,
    ListedPlaces,
    PlaceIndex,
    Submission,
    compare_places,
    read_entered_fixture,
    read_entry,
)
from workhold.errors import InputError

Content = Callable[[str], dict[str, Any]]
TOLERANCE = 1e-3
EVERY_KIND = (
    "kite-vise",
    "saddle-opening",
    "bar-plate",
    "bar-pair",
    "el-fence",
    "el-fence-pair",
    "house-flat-opening",
)


def compare(
    name: str, fixtures: list[dict[str, Any]], content: Content, symmetric: bool = False
) -> Comparison:
    """The comparison of some fixtures with a set."""
    part = make_set_query(find_set(name)).workpiece
    complete, theirs = (
        ListedPlaces(part, [read_entered_fixture(one) for one in several])
        for several in (content(name)["fixtures"], fixtures)
    )
    return compare_places(complete, theirs, TOLERANCE, symmetric)


def shifted(fixture: dict[str, Any], x: float, y: float) -> dict[str, Any]:
    """The fixture somewhere else on the lattice."""
    made = deepcopy(fixture)
    for place in (made["pose"], *made["pegs"]):
        place["x"] += x
        place["y"] += y
    return made


def half_turned(fixture: dict[str, Any]) -> dict[str, Any]:
    """The fixture after half a turn of the whole, by which jaws and directions change their names."""
    made = deepcopy(fixture)
    made["pose"]["theta_deg"] = (made["pose"]["theta_deg"] + 180.0) % 360.0
    swap = {"left": "right", "right": "left", "-x": "+x", "+x": "-x", "-y": "+y", "+y": "-y"}
    for place in (made["pose"], *made["pegs"]):
        place["x"], place["y"] = -place["x"], -place["y"]
    for where in (made, *made["pegs"]):
        for key in ("jaw", "direction"):
            if key in where:
                where[key] = swap[where[key]]
    return made


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", EVERY_KIND)
def test_the_list_itself_is_found_whole(name: str, content: Content) -> None:
    """A set's own file finds every fixture once and nothing else."""
    outcome = compare(name, content(name)["fixtures"], content)
    assert len(outcome.found) == outcome.listed == find_set(name).size > 0
    assert outcome.share == 1.0
    assert (outcome.missed, outcome.extra, outcome.repeated) == ((), (), ())


@pytest.mark.parametrize("name", ["kite-vise", "bar-plate", "bar-pair", "saddle-opening"])
def test_other_words_for_the_same_fixtures(name: str, content: Content) -> None:
    """Elsewhere on the lattice, with the pegs in another order, after half a turn of the whole."""
    pitch = content(name)["toolkit"]["pitch"]
    theirs = [half_turned(shifted(one, 3 * pitch[0], -2 * pitch[1])) for one in content(name)["fixtures"]]
    for one in theirs:
        one["pegs"].reverse()
    outcome = compare(name, theirs, content)
    assert len(outcome.found) == outcome.listed
    assert outcome.extra == ()


def test_what_is_lost_doubled_or_wrong_is_said(content: Content) -> None:
    """The numbers of what is missed, extra and repeated are those of the fixtures."""
    theirs = content("kite-vise")["fixtures"]
    wrong = deepcopy(theirs[4])
    wrong["pegs"][0]["x"] += 2 * TOLERANCE
    again = shifted(theirs[9], 16.0, 0.0)
    outcome = compare("kite-vise", [*theirs[:2], *theirs[5:], wrong, again], content)
    count = len(theirs)
    assert outcome.missed == (2, 3, 4)
    assert outcome.extra == (count - 3,)
    assert outcome.repeated == (count - 2,)
    assert outcome.share == pytest.approx((count - 3) / count)


def test_another_jaw_or_a_quarter_turn_is_another_fixture(content: Content) -> None:
    """Pegs at the same places of the part do not make it the same when other pegs move."""
    one = content("kite-vise")["fixtures"][0]
    other = deepcopy(one)
    other["pegs"][0]["jaw"] = "right"
    assert compare("kite-vise", [other], content).extra == (0,)
    turned = deepcopy(content("bar-plate")["fixtures"][0])
    turned["pose"]["theta_deg"] += 90.0
    for place in (turned["pose"], *turned["pegs"]):
        place["x"], place["y"] = -place["y"], place["x"]
    turned["direction"] = "-y"
    assert compare("bar-plate", [turned], content).extra == (0,)


@pytest.mark.thorough
def test_one_stands_for_its_images_where_that_is_asked(content: Content) -> None:
    """A third of the triangle's fixtures finds all of them under its rotations, and else a third."""
    theirs = content("triangle-vise")["fixtures"]
    part = make_set_query(find_set("triangle-vise")).workpiece
    complete = ListedPlaces(part, [read_entered_fixture(one) for one in theirs])
    kept: list[dict[str, Any]] = []
    seen: set[int] = set()
    for number, (one, place) in enumerate(zip(theirs, complete.places, strict=True)):
        if number not in seen:
            kept.append(one)
            for image in complete.list_images(place):
                near = [
                    np.abs(image[:, None] - other[None]).max(-1).min(1).max() for other in complete.places
                ]
                seen.add(int(np.argmin(near)))
    assert len(kept) == sum(content("triangle-vise")["distinct"].values())
    assert compare("triangle-vise", kept, content).share == pytest.approx(len(kept) / len(theirs))
    for several, again in ((kept, ()), (theirs, ()), ([*kept, kept[4]], (len(kept),))):
        whole = compare("triangle-vise", several, content, symmetric=True)
        assert whole.share == 1.0
        assert whole.repeated == again


@pytest.mark.thorough
def test_images_of_what_is_not_listed_are_no_repetitions(content: Content) -> None:
    """A complete list may hold one fixture of those that rotations make equal: its two images differ."""
    theirs = content("triangle-vise")["fixtures"]
    part = make_set_query(find_set("triangle-vise")).workpiece
    every = ListedPlaces(part, [read_entered_fixture(one) for one in theirs])
    listed = PlaceIndex.from_places(every.places, TOLERANCE)
    images = [listed.find_nearest(place) for place in every.list_images(every.places[0])]
    alone = ListedPlaces(part, [read_entered_fixture(theirs[0])])
    others = ListedPlaces(part, [read_entered_fixture(theirs[number]) for number in images if number])
    outcome = compare_places(alone, others, TOLERANCE, symmetric=True)
    assert (len(others.places), outcome.found, outcome.extra, outcome.repeated) == (2, (0,), (), ())


def test_csv_and_json_say_the_same(tmp_path: Path, content: Content) -> None:
    """A list in CSV is the one in JSON."""
    fixtures = content("bar-plate")["fixtures"]
    pegs = range(1, 5)
    rows = [["theta_deg", "x", "y", *(f"peg{k}{end}" for k in pegs for end in ("", "_x", "_y"))]]
    for one in fixtures:
        row = [one["pose"][key] for key in ("theta_deg", "x", "y")]
        for peg in one["pegs"]:
            role = f"clamp {one['direction']}" if peg["role"] == "clamp" else peg["role"]
            row += [role, peg["x"], peg["y"]]
        rows.append(row)
    path = tmp_path / "bar-plate.csv"
    path.write_text("\n".join(",".join(map(str, row)) for row in rows))
    other = tmp_path / "mine.json"
    other.write_text(json.dumps({"set": "bar-plate", "fixtures": fixtures}))
    assert read_entry(path) == read_entry(other)
    assert read_entry(path).set_name == "bar-plate"
    outcome = compare_entry(read_entry(path), TOLERANCE, symmetric=False, threads=1)
    assert outcome is not None
    assert outcome.share == 1.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "not valid JSON"),
        ("[]", "no list of fixtures"),
        ('{"fixtures": [{"pegs": []}]}', "fixture 1: 'pose' is missing"),
        ('{"fixtures": [{"pegs": [], "pose": {"theta_deg": 0, "x": 0, "y": 0}}]}', "no pegs"),
        (
            '{"fixtures": [{"pegs": [{"role": "toe", "x": 0, "y": 0}], "pose": {"theta_deg": 0, "x": 0, "y": 0}}]}',
            "'toe' is not known",
        ),
        ('{"fixtures": [3]}', "fixture 1"),
        ('{"set": 3, "fixtures": []}', "not a name"),
    ],
)
def test_a_file_that_is_none_is_refused_in_a_sentence(tmp_path: Path, text: str, words: str) -> None:
    """The fixture is named, and what to give instead."""
    path = tmp_path / "mine.json"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        read_entry(path)
    assert words in str(error.value)
    assert str(error.value).startswith("mine.json: ")


def test_a_table_without_its_columns_is_refused(tmp_path: Path) -> None:
    """The names of the columns are said."""
    path = tmp_path / "kite-vise.csv"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="theta_deg, x, y, peg1"):
        read_entry(path)


def test_an_empty_set_is_found_whole_by_an_empty_list() -> None:
    """Nothing to find is found."""
    outcome = compare_entry(Submission("disc-vise", ()), TOLERANCE, symmetric=True, threads=1)
    assert outcome is not None
    assert (outcome.listed, outcome.share) == (0, 1.0)
