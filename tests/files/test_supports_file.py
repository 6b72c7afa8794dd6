"""Files of supports: what is read is what was written, and what is wrong is named with the file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from workhold import Fence, Plate, Workpiece, circle_zone, polygon_zone
from workhold.errors import InputError
from workhold.files.supports_file import read_supports, write_supports
from workhold.model.requirements import make_zone
from workhold.model.support_request import SupportRequest, compute_usual_head
from workhold.model.support_triples import Supports, Triple
from workhold.supports.listing import find_supports

KITE = Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]])
PLATE = Plate(pitch=20, peg_radius=3, columns=6, rows=6)
BAND = (2.0, 9.0)


def supports(toolkit: Any = PLATE, **asked: Any) -> Supports:
    """The best supports of the first fixture of the kite that has some."""
    result = workhold.design(KITE, toolkit, best=6)
    request = SupportRequest(15, 3, 4, inside=3, **asked)
    return next(
        found
        for fixture in result
        if (found := find_supports(fixture, result.query, request, best=4)).triples
    )


def written(found: Supports, path: Path) -> Any:
    """The content of a file of supports."""
    write_supports(found, path)
    return json.loads(path.read_text())


def told(found: Supports) -> list[tuple[list[str], Triple]]:
    """The holes and the figures of every triple; the places of holes follow from the fixture's pose, rounded."""
    return [([pad.hole for pad in one.supports], evolve(one, supports=())) for one in found.triples]


def test_triples_are_read_in_their_order(tmp_path: Path) -> None:
    found = supports()
    write_supports(found, tmp_path / "s.json")
    again = read_supports(tmp_path / "s.json")
    assert len(found.triples) > 2 and told(again) == told(found)
    assert again.request == found.request


def test_a_point_that_was_asked_for_is_there_once(tmp_path: Path) -> None:
    """Each triple has its figures there, and the request the point."""
    best = supports().triples[0].best.at
    found = supports(point=best)
    entry = written(found, tmp_path / "s.json")
    assert entry["clamp"]["point"] == list(best)
    given = [one["given"] for one in entry["triples"] if one["given"] is not None]
    assert given and all("at" not in one and "arm" in one for one in given)
    again = read_supports(tmp_path / "s.json")
    assert told(again) == told(found)
    assert any(one.given is not None and one.given.at == best for one in again.triples)


def test_zones_are_circles_polygons_or_loops(tmp_path: Path) -> None:
    """Two arcs that are not half circles are not a circle."""
    zones = (
        circle_zone(300, 200, 12.5),
        polygon_zone([(200, 0), (220, 0), (210, 20)]),
        make_zone([[200, 100, 0.5], [240, 100, 0.5]]),
    )
    found = supports(top_zones=zones, bottom_zones=zones[::-1])
    entry = written(found, tmp_path / "s.json")
    kinds = [
        {"circle": [300.0, 200.0, 12.5]},
        {"polygon": [[200.0, 0.0], [220.0, 0.0], [210.0, 20.0]]},
        {"loop": [[200.0, 100.0, 0.5], [240.0, 100.0, 0.5]]},
    ]
    assert (entry["clamp"]["zones"], entry["supports"]["zones"]) == (kinds, kinds[::-1])
    request = read_supports(tmp_path / "s.json").request
    for read, asked in ((request.top_zones, zones), (request.bottom_zones, zones[::-1])):
        assert all(np.array_equal(one.loop, other.loop) for one, other in zip(read, asked, strict=True))


@pytest.mark.parametrize(
    ("asked", "kept"),
    [
        ({}, {}),
        ({"tip_margin": 1.5}, {"tip_margin": 1.5}),
        ({"head_radius": 7.25}, {"head_radius": 7.25}),
        ({"head_radius": compute_usual_head(4)}, {}),
    ],
)
def test_what_is_around_the_tip_is_kept_where_it_is_not_usual(
    asked: dict[str, float], kept: dict[str, float], tmp_path: Path
) -> None:
    found = supports(**asked)
    clamp = written(found, tmp_path / "s.json")["clamp"]
    assert {key: clamp[key] for key in ("tip_margin", "head_radius") if key in clamp} == kept
    assert read_supports(tmp_path / "s.json").request == found.request


def test_bands_of_pegs_and_of_the_ends_of_a_wall_are_kept(tmp_path: Path) -> None:
    """Those that a wall touches stand with the wall; without any of their own the file has none."""
    fence = Fence(pitch=15, wall_offset=8, peg_radius=3)
    for bands in ((None, BAND, (3.0, 8.0), None), ((1.0, 4.0), None, None, None)):
        found = supports(fence, bands=bands)
        entry = written(found, tmp_path / "s.json")
        placed = [peg in found.fixture.placed for peg in found.fixture.pegs]
        ends = [one for one, own in zip(bands, placed, strict=True) if not own]
        assert ("bands" in entry["fixture"]["wall"]) == any(ends)
        assert read_supports(tmp_path / "s.json").request.bands == bands
        (tmp_path / "s.json").unlink()


def negative(entry: dict[str, Any]) -> None:
    """A tip of no size."""
    entry["clamp"]["tip_radius"] = -4.0


def elsewhere(entry: dict[str, Any]) -> None:
    """A support on a plate that the toolkit has not."""
    entry["triples"][0]["holes"][0][0] = "table"


def thin(entry: dict[str, Any]) -> None:
    """Pegs as thin as nothing can be."""
    entry["toolkit"]["peg_radius"] = -3.0


def foreign(entry: dict[str, Any]) -> None:
    """A part in other units."""
    entry["workpiece"]["units"] = "inch"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (negative, "tip radius -4 cannot be used: give a length above 0"),
        (elsewhere, "a support stands on 'table': give plate"),
        (thin, "peg radius -3"),
        (foreign, "workpiece.units cannot be used"),
    ],
)
def test_what_is_wrong_is_named_with_the_file_once(
    change: Callable[[dict[str, Any]], None], words: str, tmp_path: Path
) -> None:
    path = tmp_path / "s.json"
    entry = written(supports(), path)
    change(entry)
    path.write_text(json.dumps(entry))
    with pytest.raises(InputError, match=words) as refused:
        read_supports(path)
    assert str(refused.value).startswith(f"{path}: ") and str(refused.value).count(str(path)) == 1
