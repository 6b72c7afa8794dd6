"""The same fixture is recognized however it is written."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import attrs
import pytest

from judged import known_in, place_in_order, rules_in
from workhold import Fence, Fixture, Peg, Pose, Result, Vise
from workhold.verification import repeats
from workhold.verification.repeats import Key, KnownFixtures, Place


def shifted(fixture: Fixture, rows: int) -> Fixture:
    """The fixture moved up by rows of 8 mm."""
    pegs = [attrs.evolve(peg, row=peg.row + rows, y=peg.y + 8.0 * rows) for peg in fixture.pegs]
    return attrs.evolve(
        fixture, pegs=tuple(pegs), pose=attrs.evolve(fixture.pose, y=fixture.pose.y + 8.0 * rows)
    )


def renamed(fixture: Fixture) -> Fixture:
    """The fixture with its pegs in another order."""
    return attrs.evolve(fixture, pegs=fixture.pegs[::-1])


def half_turned(fixture: Fixture) -> Fixture:
    """The fixture seen from the other side of the vise, whose jaws have two columns: (x, y) becomes (width - x, -y)."""
    width = fixture.travel + 16.0
    pegs = [
        attrs.evolve(
            peg,
            carrier="left" if peg.carrier == "right" else "right",
            column=1 - peg.column,
            row=-peg.row,
            x=width - peg.x,
            y=-peg.y,
        )
        for peg in fixture.pegs
    ]
    pose = Pose(fixture.pose.theta_deg + 180.0, width - fixture.pose.x, -fixture.pose.y)
    return attrs.evolve(fixture, pegs=tuple(pegs), pose=pose)


def moved(fixture: Fixture, distance: float) -> Fixture:
    """The same holes with the workpiece elsewhere."""
    return attrs.evolve(fixture, pose=attrs.evolve(fixture.pose, x=fixture.pose.x + distance))


@pytest.mark.parametrize("again", [lambda f: f, lambda f: shifted(f, 3), renamed, half_turned])
def test_the_same(widget_result: Result, again: object) -> None:
    seen = known_in(widget_result.toolkit)
    for index, fixture in enumerate(widget_result):
        assert seen.add(index, fixture) is None
    for index, fixture in enumerate(widget_result):
        assert seen.add(100 + index, again(fixture)) == index  # type: ignore[operator]


def test_not_the_same(widget_result: Result) -> None:
    """Another place of the workpiece, or another opening with the same left pegs and pose."""
    seen = known_in(widget_result.toolkit)
    fixture = widget_result[0]
    right = [attrs.evolve(peg, x=peg.x + 5.0 * (peg.carrier == "right")) for peg in fixture.pegs]
    wider = attrs.evolve(fixture, pegs=tuple(right), travel=fixture.travel + 5.0)
    assert [seen.add(k, f) for k, f in enumerate((fixture, moved(fixture, 0.01), wider))] == [
        None,
        None,
        None,
    ]
    assert seen.add(3, moved(fixture, 1e-8)) == 0


@attrs.frozen
class Placed:
    """A fixture as far as its place counts."""

    place: Place
    type: str = "I"


def one_pattern(fixture: Placed, hardware: object) -> Iterator[tuple[Key, Place]]:
    """Every fixture stands in the same holes."""
    yield ("holes",), fixture.place


@pytest.mark.parametrize(("off", "sets"), [(0.0, 1), (3e-6, 1), (5e-6, 2)])
@pytest.mark.parametrize("number", range(4))
def test_one_set_when_a_rotation_carries_one_to_the_other(
    monkeypatch: pytest.MonkeyPatch, number: int, off: float, sets: int
) -> None:
    """The rotation is known to the millionths by which a drawing may miss its symmetry; so much may the fixtures differ
    that it carries into each other."""
    monkeypatch.setattr(repeats, "list_patterns", one_pattern)
    seen = KnownFixtures(rules_in(Vise(pitch=10, columns=1, peg_radius=0)), [pi / 2], (10.0, -4.0))
    image = [0.5 + pi / 2, 10.0 + 7.0, -4.0 - 20.0, 33.0]
    image[number] += off
    assert seen.add(0, Placed((0.5, 30.0, 3.0, 33.0))) is None  # type: ignore[arg-type]
    assert seen.add(1, Placed(tuple(image))) is None  # type: ignore[arg-type]
    assert seen.sets == {"I": sets}


def test_beside_a_wall_only_steps_along_it_leave_a_fixture_as_it_is() -> None:
    """Not steps away from it, nor the half turn that a plate without a wall allows."""

    def moved_by(columns: int, rows: int, sign: int) -> Fixture:
        """One locator, the wall's ends and a clamp, moved by holes and turned half way round (-1)."""
        places = [("plate", 0, 1, 0.0, 26.0), ("wall", 0, 0, 5.0, 0.0), ("wall", 0, 0, 40.0, 0.0)]
        places.append(("clamp -x" if sign > 0 else "clamp +x", 3, 2, 51.0, 46.0))
        pegs = [
            Peg(
                name,
                sign * column + columns,
                sign * row + rows,
                sign * x + 20.0 * columns,
                sign * y + 20.0 * rows,
                0,
                0.5,
            )
            for name, column, row, x, y in places
        ]
        pose = Pose(10.0 + 90.0 * (1 - sign), sign * 7.0 + 20.0 * columns, sign * 3.0 + 20.0 * rows)
        return Fixture("edge", tuple(pegs), pose, 0.0, {}, "-x" if sign > 0 else "+x")

    seen = known_in(Fence(20, 3, wall_offset=6))
    assert seen.add(0, moved_by(0, 0, 1)) is None
    assert seen.find(moved_by(2, 0, 1)) == 0
    assert seen.find(moved_by(0, 1, 1)) is None and seen.find(moved_by(0, 0, -1)) is None


def test_a_half_turn_leaves_the_place_in_the_order_as_it_is(widget_result: Result) -> None:
    """Of fixtures with two pegs on each jaw, which are seen as they lie below half a turn."""
    toolkit, looked_at = widget_result.toolkit, 0
    for fixture in widget_result:
        if fixture.type == "I":
            (holes, angle, faces), (others, theta, touched) = (
                place_in_order(f, toolkit) for f in (fixture, half_turned(fixture))
            )
            assert (holes, faces) == (others, touched) and angle == pytest.approx(theta, abs=1e-9)
            looked_at += len(set(faces[:2]) ^ set(faces[2:])) > 0
    assert looked_at > 3
