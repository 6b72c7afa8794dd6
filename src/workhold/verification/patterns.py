"""Whether fixtures whose pegs stand to each other in the same way are among each other's seats."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from workhold.model.fixture import Fixture
from workhold.model.query import Query

__all__ = ["pattern_faults"]

# Degrees and mm. A fixture is a seat told whose pose and separation agree to this.
SAME_SEAT = 1e-5


def pattern_faults(fixtures: Sequence[Fixture], query: Query) -> Iterator[str]:
    """A fault for the first fixture that is not among the seats of one whose pegs stand as its own do, in a vise."""
    if query.toolkit.moving.on is not None:
        return
    seated = [fixture for fixture in fixtures[: query.seating or 0] if fixture.seating is not None]
    patterns: dict[tuple[Any, ...], list[int]] = {stance(fixture)[0]: [] for fixture in seated}
    for place, fixture in enumerate(fixtures if patterns else ()):
        if (found := patterns.get(stance(fixture)[0])) is not None:
            found.append(place)
    for number, fixture in enumerate(seated, 1):
        key, (x, y), separation = stance(fixture)
        for place in patterns[key]:
            other = fixtures[place]
            _, (u, v), apart = stance(other)
            pose = {"theta_deg": other.pose.theta_deg, "x": other.pose.x - u + x, "y": other.pose.y - v + y}
            if not any(is_seat(seat, pose, apart - separation) for seat in fixture.seating.fields["seats"]):
                yield f"fixture {place + 1} stands on the pegs of fixture {number}, but is not among its seats"
                return


def stance(fixture: Fixture) -> tuple[tuple[Any, ...], tuple[float, float], float]:
    """How the pegs of a fixture in a vise stand to each other, where the first is, and how far apart its jaws are."""
    still = sorted((peg.x, peg.y) for peg in fixture.pegs if peg.carrier == "left")
    moved = sorted((peg.x, peg.y) for peg in fixture.pegs if peg.carrier != "left")
    (x, y), (u, _) = still[0], moved[0]
    places = [*((a - x, b - y) for a, b in still), *((a - u, b - y) for a, b in moved)]
    return (len(still), *(round(part, 5) + 0.0 for place in places for part in place)), (x, y), u - x


def is_seat(seat: Mapping[str, Any], pose: Mapping[str, float], difference: float) -> bool:
    """Whether a seat is on four faces, in a pose and at a difference."""
    turn = (seat["pose"]["theta_deg"] - pose["theta_deg"] + 180.0) % 360.0 - 180.0
    away = max(abs(seat["pose"][name] - pose[name]) for name in ("x", "y"))
    kind = seat["kind"] == "fixture" and not seat["mirrored"]
    return kind and max(abs(turn), away, abs(seat["difference"] - difference)) < SAME_SEAT
