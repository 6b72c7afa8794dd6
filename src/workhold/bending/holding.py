"""Holds of a part as loads on an elastic body: unit loads, their factors under clamping and under a load, and
locators.

Pegs, tips and walls press along their normals on strips; their forces are those of ``statics``, without
friction. Forces downward and moments that tilt the part are borne from below: by three pads, or by the level
faces that the part lies on, with a pressure that is affine over them. Flat jaws press with the affine
pressures of least norm, and the friction forces that balance a load are those of least norm as well.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.bending.elastic import PointForces
from workhold.bending.laying import Constraints, find_rigid_motion
from workhold.bending.patches import (
    PEG_WIDTH,
    LoadPatch,
    make_disc,
    make_rectangle,
    make_strip,
)
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.loads import compute_shared_forces, find_contacts_on_part
from workhold.statics.pins import PinRuns, compute_deflections, find_runs_on_solid

__all__ = ["ElasticHold", "PadsBelow", "make_elastic_hold"]

Array = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])
# Of a wrench (F_x, F_y, F_z, M_x, M_y, M_z): what is borne from below.
BELOW = [2, 3, 4]


@frozen(eq=False)
class PadsBelow:
    """Three pads under the part and a clamp on top of it, in the part's coordinates.

    Parameters
    ----------
    pads : (3, 2) centres of the pads in mm.
    pad_radius : in mm.
    clamp : (3,) point in mm where the clamp's tip presses on the part.
    tip_radius : in mm.
    force : force of the clamp in N.
    """

    pads: Array
    pad_radius: float
    clamp: Array
    tip_radius: float
    force: float


@frozen(eq=False)
class ElasticHold:
    """How a fixture holds a part.

    Parameters
    ----------
    columns : C unit loads on the part.
    clamping : (C,) factor of each unit load under clamping, in N.
    answers : (C, 6) factors of the unit loads that balance a unit force along x, y, z, or a unit moment about
        the origin.
    locating : levels of readings that are 0 where the part lies against its locators, the most binding level
        first.
    movers : (R, M) how far the contact of each of the R readings of the first level moves with each of M
        carriers.
    gives : (R, C) how far each of these contacts gives way outward, in mm per N of each unit load.
    pressed : (K, 3) points that are pressed, around which the surface is dented.
    size : a length of the part in mm, by which turns are scaled.
    """

    columns: tuple[PointForces, ...]
    clamping: Array
    answers: Array
    locating: tuple[tuple[PointForces, ...], ...]
    movers: Array
    gives: Array
    pressed: Array
    size: float
    constraints: tuple[Array, ...] = field(init=False)

    def __attrs_post_init__(self) -> None:
        count = self.movers.shape[1]
        scale = np.array([1.0, 1.0, 1.0, *[1.0 / self.size] * 3])
        rows = []
        for number, level in enumerate(self.locating):
            wrenches = np.array([read.wrench for read in level]).reshape(-1, 6) * scale
            moving = -self.movers if number == 0 else np.zeros((len(level), count))
            rows.append(np.hstack([wrenches, moving]))
        object.__setattr__(self, "constraints", tuple(rows))

    def find_motion(self, readings: Sequence[Array], gives: Array) -> Array:
        """Return the rigid motion (6,) that lays the part against its locators: shifts in mm, then turns in
        radians.

        Parameters
        ----------
        readings : for each level of ``locating``, the readings (R,) of the movement in mm.
        gives : (R,) how far the contacts of the first level give way outward, in mm.
        """
        values = [-read for read in readings]
        values[0] = values[0] + gives
        levels = [Constraints(rows, value) for rows, value in zip(self.constraints, values, strict=True)]
        motion = find_rigid_motion(levels)[:6]
        return np.concatenate([motion[:3], motion[3:] / self.size])


def make_elastic_hold(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    foot: LoadPatch,
    *,
    jaw_force: float,
    height: float,
    pressed_up_to: float | None = None,
    stiffness: float = np.inf,
    below: PadsBelow | None = None,
) -> ElasticHold:
    """Return the elastic hold of a part in a fixture.

    Parameters
    ----------
    foot : the level faces that the part lies on.
    jaw_force : in N.
    height : height of the part in mm.
    pressed_up_to : height in mm up to which pegs press on a prism; None for its height. Not used for a solid.
    stiffness : stiffness of the closed jaw over that of one contact.
    below : pads and a clamp on top; if None the part lies on ``foot``.
    """
    size = max(np.ptp(np.array(workpiece.bounds).reshape(2, 2), axis=0).max(), height)
    if isinstance(fixture.hold, StrappedHold):
        raise InputError(
            "how far straps bend a part is not worked out: leave bending out, or take a plate with clamps."
        )
    if fixture.hold is not None:
        return make_elastic_jaw_hold(fixture, fixture.hold, foot, jaw_force, height, float(size))
    if workpiece.solid is None:
        pressed_up_to = height if pressed_up_to is None else min(height, pressed_up_to)
    touched = TouchableFeatures.from_workpiece(workpiece, toolkit)
    matrices = touched.compute_for_fixture(fixture, toolkit)
    contacts, normals, *_ = find_contacts_on_part(fixture, workpiece, toolkit, touched, matrices)
    points = contacts + touched.center
    carriers = toolkit.find_carrier_numbers(peg.carrier for peg in fixture.pegs)
    low, high = find_pressed_heights(fixture, workpiece, toolkit, matrices.points, height, pressed_up_to)
    strips = [
        make_strip((point[0], point[1]), (normal[0], normal[1]), *heights)
        for point, normal, *heights in zip(points, normals, low, high, strict=True)
    ]
    outward = np.column_stack([normals, np.zeros(len(normals))])
    pegs = tuple(strip.press(-normal) for strip, normal in zip(strips, outward, strict=True))
    forces = matrices.inverses[0].T / np.array([1.0, 1.0, touched.length, 1.0])
    shared = compute_shared_forces(forces[:, :3], matrices.closing[0], stiffness)
    cx, cy = touched.center
    in_plane = np.array([[1.0, 0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0, 0], [cy, -cx, 0, 0, 0, 1.0]])
    moving = [number for number in dict.fromkeys(carriers) if toolkit.carriers[number].travel is not None]
    movers = np.zeros((len(pegs), len(moving)))
    for column, number in enumerate(moving):
        along = fixture.pose.inverse.turn(touched.directions[number])
        own = np.array(carriers) == number
        movers[own, column] = normals[own] @ np.asarray(along)
    gives = np.zeros((len(pegs), len(pegs)))
    np.fill_diagonal(gives, find_flexibilities(fixture, workpiece, toolkit, matrices.points, pressed_up_to))
    held = ElasticHold(
        pegs,
        jaw_force * forces[:, 3],
        shared @ in_plane,
        (tuple(strip.read(normal) for strip, normal in zip(strips, outward, strict=True)),),
        movers,
        gives,
        np.concatenate([strip.points for strip in strips]),
        float(size),
    )
    return add_support_from_below(held, foot, below)


def find_pressed_heights(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    points: Array,
    height: float,
    pressed_up_to: float | None,
) -> tuple[Array, Array]:
    """Return (low, high), each (P,): heights between which each contact presses, in mm above the part's lower
    side.

    On a prism they are 0 and ``pressed_up_to``; on a solid those of its faces, at most ``height``.
    """
    count = len(fixture.pegs)
    if workpiece.solid is None:
        return np.zeros(count), np.full(count, pressed_up_to)
    faces = np.array([[peg.face for peg in fixture.pegs]])
    low, high = find_runs_on_solid(faces, points + np.array(workpiece.center), workpiece)
    whole = np.isnan(low[0]) | np.isnan(high[0])
    return np.where(whole, 0.0, low[0]), np.where(whole, height, np.minimum(high[0], height))


def find_flexibilities(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, points: Array, pressed_up_to: float | None
) -> Array:
    """Return how far each contact gives way (P,), in mm per N; 0 for tips and walls, and where it is not
    known.
    """
    carriers = np.array([toolkit.find_carrier_numbers(peg.carrier for peg in fixture.pegs)])
    faces = np.array([[peg.face for peg in fixture.pegs]])
    runs = PinRuns.from_fixtures(faces, carriers, workpiece, toolkit, points, pressed_up_to)
    found: Array = np.nan_to_num(compute_deflections(1.0, runs.middle[0], runs.diameter[0]))
    return found


def add_support_from_below(held: ElasticHold, foot: LoadPatch, below: PadsBelow | None) -> ElasticHold:
    """Return the hold with the supports below the part added, and the factors with which they bear clamping
    and loads.

    They are the pads with their clamp on top, or where ``below`` is None the level faces ``foot``.
    """
    count = len(held.columns)
    more: tuple[PointForces, ...] = ()
    extra = np.zeros(0)
    dents = [held.pressed]
    if below is None:
        bearing, reads = press_foot(foot)
    else:
        pads = [make_disc(np.array([x, y, 0.0]), below.pad_radius, -UP) for x, y in below.pads]
        tip = make_disc(below.clamp, below.tip_radius, UP)
        bearing, reads = tuple(pad.press(UP) for pad in pads), tuple(pad.read(-UP) for pad in pads)
        more, extra = (tip.press(-UP),), np.array([below.force])
        dents += [patch.points for patch in (*pads, tip)]
    wrenches = np.array([one.wrench for one in (*held.columns, *more)]).T
    pressing = np.concatenate([held.clamping, extra])
    inverse = np.linalg.inv(np.array([one.wrench[BELOW] for one in bearing]).T)
    clamped = -inverse @ (wrenches @ pressing)[BELOW]
    idle = np.zeros((len(more), 6))
    together = wrenches @ np.vstack([held.answers, idle]) + np.eye(6)
    borne = -inverse @ together[BELOW]
    return evolve(
        held,
        columns=(*held.columns, *more, *bearing),
        clamping=np.concatenate([pressing, clamped]),
        answers=np.vstack([held.answers, idle, borne]),
        locating=(*held.locating, reads),
        gives=np.hstack([held.gives, np.zeros((count, len(more) + len(bearing)))]),
        pressed=np.concatenate(dents),
    )


def press_foot(foot: LoadPatch) -> tuple[tuple[PointForces, ...], tuple[PointForces, ...]]:
    """Return (unit loads, readings) of the foot, three each.

    The loads are upward pressures 1, x and y about the centre, which add up to any affine pressure; the
    readings fit a plane to the movement of the foot.
    """
    assert foot.weights is not None
    middle = foot.weights @ foot.points
    arms = foot.points - middle
    factors = [np.ones(len(arms)), arms[:, 0], arms[:, 1]]
    return tuple(foot.press(UP, one) for one in factors), tuple(foot.press(-UP, one) for one in factors)


def make_elastic_jaw_hold(
    fixture: Fixture, hold: JawHold, foot: LoadPatch, jaw_force: float, height: float, size: float
) -> ElasticHold:
    """Return the elastic hold of two flat jaws, which press with affine pressures on what they touch.

    Of all pressures that balance, those of least norm are taken.
    """
    pose = fixture.pose.inverse
    columns: list[PointForces] = []
    normal_columns: list[list[int]] = []
    reads: tuple[PointForces, ...] = ()
    dents = []
    for patch, y, side in ((hold.fixed, 0.0, -1.0), (hold.moving, hold.opening, 1.0)):
        points, areas = zip(*(sample_rectangle(one, y, height) for one in patch.rectangles), strict=True)
        there, weights = np.concatenate(points), np.concatenate(areas) / sum(map(np.sum, areas))
        x, up = there[:, 0] - weights @ there[:, 0], there[:, 2] - weights @ there[:, 2]
        turned = np.column_stack([pose.apply(there[:, :2]), there[:, 2]])
        outward, along = (np.array([*pose.turn(np.array(v)), 0.0]) for v in ((0.0, side), (1.0, 0.0)))
        own = LoadPatch(turned, turned, outward, weights)
        factors = [np.ones(len(there)), *(one / max(np.sqrt(weights @ one**2), 1e-9) for one in (x, up))]
        normal_columns.append(list(range(len(columns), len(columns) + 3)))
        columns += [own.press(-outward, one) for one in factors]
        columns += [own.press(along), own.press(UP), own.press(UP, factors[1])]
        dents.append(turned)
        if side < 0:
            reads = tuple(own.press(outward, one) for one in factors)
    first, other = normal_columns
    bearing, below = press_foot(foot)
    wrenches = np.array([one.wrench for one in (*columns, *bearing)]).T
    scale = np.array([1.0, 1.0, 1.0, *[1.0 / size] * 3])
    normal = wrenches[:, [*first, *other]]
    totals = np.zeros((2, 6))
    totals[0, 0] = totals[1, 3] = 1.0
    rows = np.vstack([totals, scale[:, None] * normal])
    pressed, *_ = np.linalg.lstsq(rows, np.array([jaw_force, jaw_force, *[0.0] * 6]), rcond=1e-9)
    clamping = np.zeros(wrenches.shape[1])
    clamping[[*first, *other]] = pressed
    answers = -np.linalg.pinv(scale[:, None] * wrenches, rcond=1e-9) @ np.diag(scale)
    return ElasticHold(
        (*columns, *bearing),
        clamping,
        answers,
        (reads, below),
        np.zeros((3, 0)),
        np.zeros((3, wrenches.shape[1])),
        np.concatenate(dents),
        size,
    )


def sample_rectangle(
    rectangle: tuple[float, float, float, float], y: float, height: float
) -> tuple[Array, Array]:
    """Return points (M, 3) of a rectangle on a jaw, in the vise's frame, and the area in mm² that each stands
    for.

    The rectangle is (x0, x1, z0, z1) in mm, cut off at ``height``; one narrower than a peg's strip is widened
    to it.
    """
    x0, x1, z0, z1 = rectangle
    z1 = min(z1, height)
    if x1 - x0 < PEG_WIDTH:
        x0, x1 = (x0 + x1 - PEG_WIDTH) / 2, (x0 + x1 + PEG_WIDTH) / 2
    if z1 <= z0:
        raise InputError("the jaws do not reach the part at the thickness given: give the part's own.")
    sides = (np.array([x1 - x0, 0.0, 0.0]), np.array([0.0, 0.0, z1 - z0]))
    return make_rectangle(np.array([x0, y, z0]), sides)
