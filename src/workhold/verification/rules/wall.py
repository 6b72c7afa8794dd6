"""A straight wall that the part lies flush on, as two contacts at the ends of a hull edge.

The wall runs along x at y = 0 with the part above it. The contacts are derived from the outline at the
written pose: the lowest joints and convex arcs. The two ends are contacts like any other, each with its own
equation: its lowest point is at y = 0.

A wall that has ends, such as a flat jaw, covers only a range of x. The part touches the wall's line in faces
along it, joints and arcs. The stretch from the first to the last of these points within that range is the
common stretch, and the wall pushes at its ends. The point at which the wall's total force acts follows from
the pegs alone and does not depend on the range.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan
from typing import ClassVar

from attrs import evolve, frozen
from flint import arb

from workhold.model.fixture import Peg
from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    LineSide,
    Point,
    Side,
    compute_norm,
    make_exact_point,
    turn_vector,
)
from workhold.verification.contacts import BallContact, BallPose
from workhold.verification.tolerances import (
    AGREEMENT,
    FLUSH,
    HAIR,
    LEAST_FLUSH,
    SAME,
    SPARE,
    Finding,
    format_middle,
    judge_slack,
)

__all__ = ["EndedWall", "WallContact", "check_flush", "make_wall_contacts"]


@frozen(eq=False)
class WallSupport:
    """A joint or a convex arc of an outline that may touch a wall.

    Parameters
    ----------
    center, bow : centre and radius of the arc, or the joint itself and 0; in mm in the workpiece's frame.
    faces : numbers of the arc, or of the two faces that meet at the joint.
    """

    center: Point
    bow: arb
    faces: tuple[int, ...]

    def find_lowest_point(self, pose: BallPose) -> Point:
        """Return the lowest point in the toolkit's frame, in mm."""
        x, y = turn_vector(self.center, pose.cosine, pose.sine)
        return x + pose.x, y + pose.y - self.bow


@frozen(eq=False)
class WallContact(BallContact):
    """A joint or a convex arc that touches a wall.

    Parameters
    ----------
    piece : the joint or arc.
    faces : numbers of the arc, or at a joint of a face that lies along the wall, else of the two that meet
        there.
    length : of the part's contact with the wall, in mm.
    """

    is_flush: ClassVar[bool] = True

    piece: WallSupport
    faces: tuple[int, ...]
    length: arb

    @property
    def size(self) -> arb:
        """The length in mm of the part's contact with the wall."""
        return self.length

    def compute_outward_normal(self, pose: BallPose) -> Point:
        """Return the unit vector toward the wall (-y of the toolkit) in the part's frame."""
        return -pose.sine, -pose.cosine

    def compute_center_in_part(self, pose: BallPose) -> Point:
        """Return the point that touches the wall, in the part's frame in mm."""
        (x, y), (across, down) = self.piece.center, self.compute_outward_normal(pose)
        return x + self.piece.bow * across, y + self.piece.bow * down

    def compute_point(self, pose: BallPose) -> Point:
        """Return the point that touches the wall, in the toolkit's frame in mm."""
        return self.piece.find_lowest_point(pose)

    def evaluate_equation(self, pose: BallPose) -> tuple[arb, list[arb]]:
        """Return the y in mm of the lowest point, and its four derivatives by theta, x, y and travel."""
        x, y = self.piece.find_lowest_point(pose)
        return y, [x - pose.x, arb(0), arb(1), arb(0)]


def make_wall_contacts(sides: Sequence[Side], outline: BallOutline, pose: BallPose) -> list[WallContact]:
    """Return [left end, right end] of the part's contact with a wall at a pose.

    ``sides`` gives the side of each contact, left first. If no face lies on the wall, the two lowest points
    are the ends.
    """
    lows = [
        (float(y.mid()), float(x.mid()), piece)
        for piece in list_supports(outline, pose)
        for x, y in (piece.find_lowest_point(pose),)
    ]
    lows.sort(key=lambda low: low[0])
    flat = [low for low in lows if abs(low[0]) <= 10 * AGREEMENT] or lows[:2]
    left, right = (find_end([(sign * x, piece) for _, x, piece in flat]) for sign in (1, -1))
    # A common tangent of two circles, or of joints.
    far = compute_norm((right.center[0] - left.center[0], right.center[1] - left.center[1]))
    square = far * far - (left.bow - right.bow) * (left.bow - right.bow)
    length, here = square.sqrt() if square > 0 else arb(0), make_exact_point(0.0, 0.0)
    return [
        WallContact(here, here, side, arb(0), end, find_touching_numbers(end, outline, pose), length)
        for side, end in zip(sides, (left, right), strict=True)
    ]


def list_supports(outline: BallOutline, pose: BallPose) -> Iterator[WallSupport]:
    """Yield the supports of an outline at a pose: first convex arcs with a horizontal tangent at their lowest
    point, then all joints.
    """
    down = -pose.sine, -pose.cosine
    for face, side in outline.faces.items():
        if isinstance(side, ArcSide) and side.sign > 0 and (side.whole or not side.measure_within(down) < 0):
            yield WallSupport(side.center, side.radius, (face,))
    before = {(float(side.end[0]), float(side.end[1])): face for face, side in outline.faces.items()}
    for face, side in outline.faces.items():
        if not (isinstance(side, ArcSide) and side.whole):
            x, y = side.start
            yield WallSupport(side.start, arb(0), tuple(sorted((before[float(x), float(y)], face))))


def find_end(flat: Sequence[tuple[float, WallSupport]]) -> WallSupport:
    """Return the support with the least place; where several have it, a joint rather than an arc.

    ``flat`` holds (place in mm, support).
    """
    least = min(place for place, _ in flat)
    near = [low for low in flat if low[0] <= least + AGREEMENT]
    return min(near, key=lambda low: (float(low[1].bow.mid()), low[0]))[1]


def find_touching_numbers(end: WallSupport, outline: BallOutline, pose: BallPose) -> tuple[int, ...]:
    """Return the face numbers of the wall contact at a support.

    At a joint of a face that lies along the wall it is that face alone, otherwise all faces of the support.
    """
    for face in end.faces:
        side = outline.faces[face]
        if isinstance(side, LineSide):
            heights = [
                turn_vector(point, pose.cosine, pose.sine)[1] + pose.y for point in (side.start, side.end)
            ]
            if all(abs(float(height.mid())) <= 3 * FLUSH for height in heights):
                return (face,)
    return end.faces


@frozen(eq=False)
class SharedStretch:
    """The common stretch of a part and a jaw.

    Parameters
    ----------
    left, right : x of its ends in mm.
    faces : numbers of the faces that touch at each end.
    """

    left: arb
    right: arb
    faces: tuple[tuple[int, ...], tuple[int, ...]]

    @property
    def length(self) -> arb:
        """The length in mm."""
        return self.right - self.left


@frozen(eq=False)
class EndedWall:
    """A wall that has ends, beside a lattice of holes whose middle column is over its middle.

    Parameters
    ----------
    noun : word for it.
    width : in mm.
    pitch : distance in mm between columns.
    columns : number of columns.
    """

    noun: str
    width: float
    pitch: float
    columns: int

    @property
    def middle(self) -> arb:
        """x of its middle in mm."""
        return arb(self.columns - 1) * self.pitch / 2

    def find_common_stretch(self, outline: BallOutline, pose: BallPose, shift: arb) -> SharedStretch | None:
        """Return the stretch common to part and jaw once the part is shifted by ``shift`` mm along x; None
        where there is none.
        """
        first, last = self.middle - arb(self.width) / 2 - shift, self.middle + arb(self.width) / 2 - shift
        lefts: list[tuple[arb, int, tuple[int, ...]]] = []
        rights: list[tuple[arb, int, tuple[int, ...]]] = []
        for low, high, faces in find_stretches_on_line(outline, pose):
            if float((low - last).mid()) > HAIR or float((first - high).mid()) > HAIR:
                continue
            # What lies along the jaw comes before a joint, and that before an arc.
            order = 0 if float((high - low).mid()) > SAME else 3 - len(faces)
            lefts.append((low.max(first), order, faces))
            rights.append((high.min(last), order, faces))
        if not lefts:
            return None
        left, right = (
            min(ends, key=lambda end: sign * float(end[0].mid())) for ends, sign in ((lefts, 1), (rights, -1))
        )
        first_faces, last_faces = (
            min((e for e in ends if abs(float((e[0] - at[0]).mid())) <= SAME), key=lambda end: end[1])[2]
            for ends, at in ((lefts, left), (rights, right))
        )
        return SharedStretch(left[0] + shift, right[0] + shift, (first_faces, last_faces))

    def limit_contacts(
        self, ends: Sequence[WallContact], outline: BallOutline, pose: BallPose
    ) -> list[WallContact]:
        """Return the contacts at the ends of the stretch common to part and jaw.

        Returns ``ends`` unchanged where part and jaw have no common stretch.
        """
        found = self.find_common_stretch(outline, pose, arb(0))
        if found is None:
            return [*ends]
        out = []
        for end, x, faces in zip(ends, (found.left, found.right), found.faces, strict=True):
            point = turn_vector((x - pose.x, -pose.y), pose.cosine, -pose.sine)
            piece = WallSupport(point, arb(0), faces)
            out.append(evolve(end, piece=piece, faces=faces, length=found.length))
        return out

    def judge(
        self, columns: Sequence[int], force_at: arb, outline: BallOutline, pose: BallPose
    ) -> Iterator[Finding]:
        """Yield a finding if the jaw does not extend to the wall's force, or other columns would hold the
        part better.

        ``columns`` are the columns of the pegs; ``force_at`` is the x in mm at which the wall's force acts.
        """
        first, found = min(columns), dict[int, tuple[SharedStretch, arb]]()
        for column in range(self.columns - (max(columns) - first)):
            shift = arb(column - first) * self.pitch
            stretch = self.find_common_stretch(outline, pose, shift)
            if stretch is not None:
                at = force_at + shift
                found[column] = stretch, (at - stretch.left).min(stretch.right - at)
        if first not in found:
            yield Finding(True, f"the part does not lie on the {self.noun} between its ends")
            return
        own, inside = found[first]
        if not -SPARE < inside - SAME < SPARE:
            yield from judge_slack(
                inside - SAME,
                f"the force of the {self.noun} acts {format_middle(-inside)} mm beyond where both touch",
            )
        # What is this near to holding, or to being as long, may count or not.
        held = {k: stretch for k, (stretch, inside) in found.items() if inside > SAME + SPARE or k == first}
        longest = max(float(stretch.length.mid()) for stretch in held.values())
        words = f"its pegs would stand better from column {{}} on: the {self.noun} holds "
        if float(own.length.mid()) < longest - SAME - SPARE:
            best = next(k for k, one in held.items() if float(one.length.mid()) == longest)
            yield Finding(True, f"{words.format(best)}{longest:.6g} mm of the part there")
            return
        equal = {
            k: abs(float(((one.left + one.right) / 2 - self.middle).mid()))
            for k, one in held.items()
            if k == first or float(one.length.mid()) >= longest - SAME + SPARE
        }
        nearest = min(equal.values())
        if equal[first] > nearest + SAME + SPARE:
            best = next(k for k, off in equal.items() if off == nearest)
            yield Finding(True, f"{words.format(best)}it nearer to its middle there")
        for k, off in equal.items():
            if k < first and off <= nearest + SAME - SPARE:
                yield Finding(True, f"{words.format(k)}it as well there")
                return


def find_stretches_on_line(
    outline: BallOutline, pose: BallPose
) -> Iterator[tuple[arb, arb, tuple[int, ...]]]:
    """Yield (least x, greatest x, face numbers) in mm for each line, joint or
    arc that touches a wall at a pose.
    """
    for face, side in outline.faces.items():
        if isinstance(side, LineSide):
            ends = [turn_vector(point, pose.cosine, pose.sine) for point in (side.start, side.end)]
            if all(abs(float((y + pose.y).mid())) <= 3 * FLUSH for _, y in ends):
                low, high = sorted((x + pose.x for x, _ in ends), key=lambda x: float(x.mid()))
                yield low, high, (face,)
    for piece in list_supports(outline, pose):
        x, y = piece.find_lowest_point(pose)
        if abs(float(y.mid())) <= 3 * FLUSH:
            yield x, x, piece.faces


def check_flush(
    noun: str,
    ends: Sequence[tuple[str, Peg, WallContact]],
    pose: BallPose,
    outline: BallOutline,
    stated: Sequence[WallContact] | None = None,
) -> Iterator[Finding]:
    """Yield a finding if the part does not lie flush on a wall, or its two ends are not at their written
    places.

    ``ends`` are (name, peg, contact) of the whole contact. ``stated`` are the contacts in the file, limited
    to the range of the wall; None means those of ``ends``. ``noun`` names the wall in messages.
    """
    (left, _), (right, _) = [contact.compute_point(pose) for _, _, contact in ends]
    yield from judge_slack(right - left - LEAST_FLUSH, f"the part does not lie flush on the {noun}")
    for piece in list_supports(outline, pose):
        (x, low), face = piece.find_lowest_point(pose), piece.faces[0]
        yield from judge_slack(
            low + 2 * FLUSH, f"the part enters the {noun} at face {face} by {format_middle(-low)} mm"
        )
        beyond = (left - x).max(x - right) - 2 * FLUSH
        if not (low > FLUSH / 2 or beyond < 0):
            words = f"the part lies on the {noun} at face {face}, beyond its stated ends"
            yield Finding(bool(low < -FLUSH), words)
    said = [contact for *_, contact in ends] if stated is None else stated
    for (name, peg, _), contact in zip(ends, said, strict=True):
        place = contact.compute_point(pose)
        if peg.face != min(contact.faces):
            yield Finding(True, f"{name} touches face {min(contact.faces)}, and not {peg.face}")
        for axis, written, derived in zip("xy", (peg.x, peg.y), place, strict=True):
            off = abs(derived - written)
            if not isnan(written) and not off < AGREEMENT:
                words = f"the {axis} of {name} is {format_middle(off)} mm from where the part touches"
                yield from judge_slack(AGREEMENT - off, words)
