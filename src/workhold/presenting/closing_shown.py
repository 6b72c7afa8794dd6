"""A simulated closing of a fixture: the part starts slightly off its place, and the closing jaws bring it
into its place.

The starting distance depends on the cage, the poses from which the part still settles (``model.seating``). If
the seating cannot be computed, or the cage is too small to see, the part stays in its place and only the jaw
or clamp moves.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

from workhold.drawing.scene import LengthUnit
from workhold.drawing.seating_words import SeatingSentences
from workhold.errors import InputError
from workhold.model.clamps import describe_tightening_order
from workhold.model.fixture import Fixture
from workhold.model.pose import Pose
from workhold.model.seating import Seating
from workhold.presenting.live_picture import LivePicture
from workhold.seating.closing_simulation import simulate_closing
from workhold.seating.solver import SeatingSolver

__all__ = ["show_closing"]

# Of the capture opening, how far what moves is opened, and of the cage, how far the part is turned and
# shifted: the first with which it comes home is shown.
OF_CAPTURE, SHARES = 0.9, (0.7, 0.4, 0.2)
# Where the part is never lost: how far it is turned in degrees.
ANY_TURN = 12.0
# mm. Caught from less, no motion would be seen.
VISIBLE = 0.2
# Keyframes that are kept of a closing.
MOST_KEYFRAMES = 120


def show_closing(picture: LivePicture) -> dict[str, Any]:
    """Return the closing of a picture's fixture as keyframes and words, plain data for the browser.

    If no motion of the part can be shown, only the moving carrier moves, and the words say why.
    """
    fixture, toolkit = picture.fixture, picture.result.toolkit
    if not toolkit.closes_at_once:
        return picture.describe_closing(words=describe_tightening_order(fixture))
    try:
        solver = SeatingSolver(picture.result.workpiece, toolkit)
        seating = fixture.seating or solver.solve(fixture)
        return close_fixture(picture, solver, seating)
    except InputError as error:
        return picture.describe_closing(words=f"The part is held in its place while it is clamped: {error}")


def close_fixture(picture: LivePicture, solver: SeatingSolver, seating: Seating) -> dict[str, Any]:
    """Return the closing of a fixture with a known seating as plain data.

    It starts from the first start pose that leads home. Where the capture opening is too small to see, or no
    start pose leads home, the part does not move.
    """
    fixture, toolkit = picture.fixture, picture.result.toolkit
    sentences = SeatingSentences(seating, fixture, toolkit, LengthUnit.in_mm())
    most = picture.opened if seating.capture_opening is None else OF_CAPTURE * seating.capture_opening
    opening = min(picture.opened, most)
    if opening < VISIBLE:
        caught = f"The part is caught only while {seating.opened} by less than {opening / OF_CAPTURE:.3f} mm"
        return picture.describe_closing(words=f"{caught}: hold it in its place while you close.")
    for pose in list_starts(picture, fixture, seating):
        try:
            way = simulate_closing(solver, fixture, seating.seats, pose, opening)
        except InputError:
            continue
        if way.ending in ("right", "same place"):
            sign = toolkit.clamping
            every = -(-len(way.poses) // MOST_KEYFRAMES)
            keyframes = [
                picture.make_keyframe(one, max(sign * (travelled - fixture.travel), 0.0))
                for one, travelled in zip(way.poses[::-1][::every], way.travels[::-1][::every], strict=True)
            ]
            return picture.describe_closing(
                keyframes[::-1], sentences.describe_ending(way.ending, way.seat, way.travels[-1])
            )
    return picture.describe_closing(words="The part is held in its place while it is clamped.")


def list_starts(picture: LivePicture, fixture: Fixture, seating: Seating) -> Iterator[Pose]:
    """Yield start poses within the cage, each nearer to the fixture's pose than the previous one; the last is
    the fixture's pose itself.
    """
    middle, cage = picture.result.workpiece.center, seating.cage
    turns, shifts = (-ANY_TURN, ANY_TURN), (0.0, 0.0)
    if cage is not None:
        turns, shifts = cage.theta_deg, cage.y
    x, y = fixture.pose.apply(*middle)
    for share, turn, shift in product(SHARES, sorted(turns, key=abs, reverse=True), shifts):
        turned = Pose(fixture.pose.theta_deg + share * turn, 0.0, 0.0)
        dx, dy = turned.apply(*middle)
        yield Pose(turned.theta_deg, float(x - dx), float(y - dy + share * shift / 2))
    yield fixture.pose
