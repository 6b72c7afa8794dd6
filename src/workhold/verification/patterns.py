"""Whether fixtures whose pegs stand to each other in the same way are among each other's seats."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from attrs import frozen

from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query

__all__ = ["pattern_faults", "stance"]

# Degrees and mm. A fixture is a stated seat whose pose and separation agree to this.
SAME_SEAT = 1e-5


def pattern_faults(fixtures: Sequence[Fixture], query: Query) -> Iterator[str]:
    """A fault for the first fixture that is not among the seats of one whose pegs stand as its own do."""
    if query.toolkit.needs_pairs:
        return
    seated = [fixture for fixture in fixtures[: query.seating or 0] if fixture.seating is not None]
    stances = [stance(fixture, query.toolkit) for fixture in (fixtures if seated else ())]
    patterns: dict[tuple[Any, ...], list[int]] = {stances[number].key: [] for number in range(len(seated))}
    for place, other in enumerate(stances):
        if (found := patterns.get(other.key)) is not None:
            found.append(place)
    for number, fixture in enumerate(seated):
        own = stances[number]
        for place in patterns[own.key]:
            other, pose = stances[place], fixtures[place].pose
            moved = {
                "theta_deg": pose.theta_deg,
                "x": pose.x - other.anchor[0] + own.anchor[0],
                "y": pose.y - other.anchor[1] + own.anchor[1],
            }
            apart = other.apart - own.apart
            if any(min(own.apart, other.apart) < there < max(own.apart, other.apart) for there in own.met):
                continue
            if not any(is_seat(seat, moved, apart) for seat in fixture.seating.fields["seats"]):
                yield f"fixture {place + 1} stands on the pegs of fixture {number + 1}, but is not among its seats"
                return


@frozen
class Stance:
    """How the pegs of a fixture stand to each other.

    Parameters
    ----------
    key : what fixtures share that differ by a shift and by the travel of what moves.
    anchor : in mm, the first peg that stands still; where only a wall does, its point below the first peg.
    apart : how far in mm the first that moves is from it, along the way on which the travel grows.
    met : at how many mm of that a clamp's tip would be in one that stands still.
    """

    key: tuple[Any, ...]
    anchor: tuple[float, float]
    apart: float
    met: tuple[float, ...]


def stance(fixture: Fixture, toolkit: Toolkit) -> Stance:
    """How the pegs of a fixture stand in a toolkit."""
    by_place = sorted((peg for peg in fixture.pegs if not peg.is_on_wall), key=lambda peg: (peg.x, peg.y))
    still = [peg for peg in by_place if toolkit.carrier(peg.carrier).travel is None]
    moved = [peg for peg in by_place if peg not in still]
    tip = moved[0]
    first_x, first_y = (still[0].x, still[0].y) if still else (tip.x, 0.0)
    carrier = toolkit.carrier(tip.carrier)
    assert carrier.travel is not None
    ux, uy = carrier.travel.unit

    def along(peg: Peg) -> float:
        return (peg.x - first_x) * ux + (peg.y - first_y) * uy

    def across(peg: Peg) -> float:
        return (peg.y - first_y) * ux - (peg.x - first_x) * uy

    places = [(peg.x - first_x, peg.y - first_y) for peg in still]
    places += [(peg.x - tip.x, peg.y - tip.y) for peg in moved]
    numbers, met = [across(tip), *(part for place in places for part in place)], list[float]()
    if carrier.on is not None:
        # A clamp's stroke is counted from its hole, and a wall stands where it is.
        x, y = carrier.place(tip.column, tip.row)
        numbers += [x - first_x, y - first_y] if carrier.has_a_hole else []
        numbers += [first_y] if toolkit.wall is not None else []
        reach = [carrier.peg_radius + toolkit.carrier(peg.carrier).peg_radius for peg in still]
        met = [along(peg) for peg, near in zip(still, reach, strict=True) if abs(across(peg) - across(tip)) < near]
    key = (fixture.direction, len(still), *(round(part, 5) + 0.0 for part in numbers))
    return Stance(key, (first_x, first_y), along(tip), tuple(met))


def is_seat(seat: Mapping[str, Any], pose: Mapping[str, float], difference: float) -> bool:
    """Whether a seat is on four faces, in a pose and at a difference."""
    turn = (seat["pose"]["theta_deg"] - pose["theta_deg"] + 180.0) % 360.0 - 180.0
    away = max(abs(seat["pose"][name] - pose[name]) for name in ("x", "y"))
    kind = seat["kind"] == "fixture" and not seat["mirrored"]
    return kind and max(abs(turn), away, abs(seat["difference"] - difference)) < SAME_SEAT
