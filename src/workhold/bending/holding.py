"""How a fixture loads an elastic part: unit loads, their factors under clamping and under cutting loads, and
locators.

Pegs, tips and walls press along their normals on strips; their forces are those of ``statics``, without
friction. Three pads carry the downward forces and tilting moments from below. Without pads, the level faces
that the part lies on carry them, with a pressure that is affine over these faces. Flat jaws press with the
affine pressures of least norm, and the friction forces that balance a load are those of least norm as well.
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
    RestingFaces,
    make_disc,
    make_rectangle,
    make_strip,
)
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.part_bending import PadsBelow
from workhold.model.straps import StrappedHold
from workhold.model.support_request import find_usual_pad_radius
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.loads import (
    compute_forces_with_jaw_stiffness,
    find_contacts_on_part,
    find_touched_points,
)
from workhold.statics.pins import PinRuns, compute_deflections, find_runs_on_solid

__all__ = ["BELOW", "ElasticHold", "make_elastic_hold"]

Array = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])
# Of a wrench (F_x, F_y, F_z, M_x, M_y, M_z): what is borne from below.
BELOW = [2, 3, 4]


@frozen(eq=False)
class ElasticHold:
    """How a fixture holds a part.

    Parameters
    ----------
    columns : C unit loads on the part.
    clamping : (C,) factor of each unit load under clamping, in N.
    answers : (C, 6) factors of the unit loads that balance a unit force along x, y or z, or a unit moment
        about such an axis through the origin.
    locating : levels of readings that are 0 when the part lies against its locators; the level with the
        highest priority comes first.
    movers : (R, M) distance that the contact of each first-level reading moves per unit motion of each of M
        carriers.
    gives : (R, C) distance that each of these contacts gives way outward, in mm per N of each unit load.
    pressed : (K, 3) pressed points in mm; the surface around them is dented.
    size : a length of the part in mm that scales turns to lengths.
    resting : indices of the unit loads from a plate below that the part may lift off. Their factors under
        clamping and their rows of ``answers`` are 0 until :mod:`workhold.bending.resting` has found which of
        them touch.
    """

    columns: tuple[PointForces, ...]
    clamping: Array
    answers: Array
    locating: tuple[tuple[PointForces, ...], ...]
    movers: Array
    gives: Array
    pressed: Array
    size: float
    resting: tuple[int, ...] = ()
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
        """Return the rigid motion (6,) that lays the part against its locators: three shifts in mm, then
        three turns in radians.

        Parameters
        ----------
        readings : for each level of ``locating``, the readings (R,) of the movement in mm.
        gives : (R,) distance in mm by which each contact of the first level gives way outward.
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
    pressed_top: float | None = None,
    stiffness: float = np.inf,
    below: PadsBelow | None = None,
    faces: RestingFaces | None = None,
) -> ElasticHold:
    """Return the elastic hold of a part in a fixture.

    Parameters
    ----------
    foot : patch of the level faces that the part lies on.
    jaw_force : jaw force in N; the force of each strap where straps hold the part.
    height : height of the part in mm.
    pressed_top : height in mm up to which pegs press on a prism; None for its height. Not used for a solid.
    stiffness : ratio of the stiffness of the closed jaw to that of one contact.
    below : pads and a clamp on top; if None the part lies on ``foot``.
    faces : the faces of ``foot``, cut into cells; needed for a part that straps press on a plate.
    """
    size = max(np.ptp(np.array(workpiece.bounds).reshape(2, 2), axis=0).max(), height)
    if workpiece.solid is None:
        pressed_top = height if pressed_top is None else min(height, pressed_top)
    if isinstance(fixture.hold, StrappedHold):
        return make_strapped_hold(
            fixture, fixture.hold, workpiece, toolkit, foot, faces, jaw_force, height, pressed_top
        )
    if fixture.hold is not None:
        return make_elastic_jaw_hold(fixture, fixture.hold, foot, jaw_force, height, float(size))
    touched = TouchableFeatures.from_workpiece(workpiece, toolkit)
    matrices = touched.compute_for_fixture(fixture, toolkit)
    contacts, normals, *_ = find_contacts_on_part(fixture, workpiece, toolkit, touched, matrices)
    points = contacts + touched.center
    carriers = toolkit.find_carrier_numbers(peg.carrier for peg in fixture.pegs)
    strips = make_contact_strips(fixture, workpiece, points, normals, height, pressed_top)
    outward = np.column_stack([normals, np.zeros(len(normals))])
    pegs = tuple(strip.make_force(-normal) for strip, normal in zip(strips, outward, strict=True))
    forces = matrices.inverses[0].T / np.array([1.0, 1.0, touched.length, 1.0])
    shared = compute_forces_with_jaw_stiffness(forces[:, :3], matrices.closing[0], stiffness)
    cx, cy = touched.center
    in_plane = np.array([[1.0, 0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0, 0], [cy, -cx, 0, 0, 0, 1.0]])
    moving = [number for number in dict.fromkeys(carriers) if toolkit.carriers[number].travel is not None]
    movers = np.zeros((len(pegs), len(moving)))
    for column, number in enumerate(moving):
        along = fixture.pose.inverse.turn(touched.directions[number])
        own = np.array(carriers) == number
        movers[own, column] = normals[own] @ np.asarray(along)
    gives = np.zeros((len(pegs), len(pegs)))
    np.fill_diagonal(gives, find_flexibilities(fixture, workpiece, toolkit, matrices.points, pressed_top))
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


def make_contact_strips(
    fixture: Fixture,
    workpiece: Workpiece,
    points: Array,
    normals: Array,
    height: float,
    pressed_top: float | None,
) -> list[LoadPatch]:
    """Return for each peg, tip or wall the strip of the part's surface that it touches.

    On a prism a strip extends from height 0 to ``pressed_top``. On a solid it covers the heights of its
    face, up to ``height``.

    Parameters
    ----------
    points, normals : (P, 2) contact points in mm and the part's outward unit normals there, in the part's
        coordinates.
    """
    count = len(points)
    if workpiece.solid is None:
        low, high = np.zeros(count), np.full(count, pressed_top)
    else:
        faces = np.array([[peg.face for peg in fixture.pegs]])
        least, most = (one[0] for one in find_runs_on_solid(faces, points[None], workpiece))
        whole = np.isnan(least) | np.isnan(most)
        low, high = np.where(whole, 0.0, least), np.where(whole, height, np.minimum(most, height))
    return [
        make_strip((point[0], point[1]), (normal[0], normal[1]), *heights)
        for point, normal, *heights in zip(points, normals, low, high, strict=True)
    ]


def find_flexibilities(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, points: Array, pressed_top: float | None
) -> Array:
    """Return the compliance (P,) of each contact in mm per N; 0 for tips, for walls, and where it is not
    known.
    """
    carriers = np.array([toolkit.find_carrier_numbers(peg.carrier for peg in fixture.pegs)])
    faces = np.array([[peg.face for peg in fixture.pegs]])
    runs = PinRuns.from_fixtures(faces, carriers, workpiece, toolkit, points, pressed_top)
    found: Array = np.nan_to_num(compute_deflections(1.0, runs.middle[0], runs.diameter[0]))
    return found


def add_support_from_below(held: ElasticHold, foot: LoadPatch, below: PadsBelow | None) -> ElasticHold:
    """Return (hold, factors): the hold with the supports below the part added, and their factors under
    clamping and loads.

    The supports are the pads with their clamp on top. If ``below`` is None they are the level faces ``foot``.
    """
    if below is None:
        return add_supports_below(held, *make_foot_loads(foot))
    tip = make_disc(below.clamp, below.tip_radius, UP)
    clamped = evolve(
        held,
        columns=(*held.columns, tip.make_force(-UP)),
        clamping=np.append(held.clamping, below.force),
        answers=np.vstack([held.answers, np.zeros((1, 6))]),
        gives=np.hstack([held.gives, np.zeros((len(held.gives), 1))]),
        pressed=np.concatenate([held.pressed, tip.points]),
    )
    return add_pads_below(clamped, below.pads, below.pad_radius)


def add_pads_below(held: ElasticHold, pads: Array, radius: float) -> ElasticHold:
    """Return the hold with three pads added below the part.

    ``pads`` (3, 2) are their centres in mm, ``radius`` is in mm.
    """
    discs = [make_disc(np.array([x, y, 0.0]), radius, -UP) for x, y in pads]
    more = np.concatenate([held.pressed, *(disc.points for disc in discs)])
    bearing, reads = (disc.make_force(UP) for disc in discs), (disc.read(-UP) for disc in discs)
    return add_supports_below(evolve(held, pressed=more), tuple(bearing), tuple(reads))


def add_supports_below(
    held: ElasticHold, bearing: tuple[PointForces, ...], reads: tuple[PointForces, ...]
) -> ElasticHold:
    """Return (hold, factors): the hold with three unit loads from below added, and their factors under
    clamping and loads.

    ``reads`` are the readings that are 0 when the part lies on these supports.
    """
    inverse = np.linalg.inv(np.array([one.wrench[BELOW] for one in bearing]).T)
    wrenches = np.array([one.wrench for one in held.columns]).T
    clamped = -inverse @ (wrenches @ held.clamping)[BELOW]
    borne = -inverse @ (wrenches @ held.answers + np.eye(6))[BELOW]
    return evolve(
        held,
        columns=(*held.columns, *bearing),
        clamping=np.concatenate([held.clamping, clamped]),
        answers=np.vstack([held.answers, borne]),
        locating=(*held.locating, reads),
        gives=np.hstack([held.gives, np.zeros((len(held.gives), len(bearing)))]),
    )


def make_foot_loads(foot: LoadPatch) -> tuple[tuple[PointForces, ...], tuple[PointForces, ...]]:
    """Return (unit loads, readings) of the foot, three each.

    The loads are upward pressures 1, x and y about the centre; sums of these are all affine pressures. The
    readings fit a plane to the movement of the foot.
    """
    arms = foot.points - foot.middle
    factors = [np.ones(len(arms)), arms[:, 0], arms[:, 1]]
    return tuple(foot.make_force(UP, one) for one in factors), tuple(
        foot.make_force(-UP, one) for one in factors
    )


def make_strapped_hold(
    fixture: Fixture,
    hold: StrappedHold,
    workpiece: Workpiece,
    toolkit: Toolkit,
    foot: LoadPatch,
    faces: RestingFaces | None,
    strap_force: float,
    height: float,
    pressed_top: float | None,
) -> ElasticHold:
    """Return the elastic hold of straps, each of which presses straight down with ``strap_force`` N.

    The part lies on three pads, or on a plate that presses on the touching cells of ``faces``. Friction at
    the tips and below carries loads along the plate, with the same share of the friction limit everywhere.

    Raises
    ------
    InputError
        For a fixture without straps.
    """
    radius = toolkit.strap_set.tip_radius if toolkit.strap_set is not None else hold.tip_radius
    if not hold.straps or radius is None:
        raise InputError("a fixture has no straps, so that nothing bends its part: bend one that has some.")
    back, size = fixture.pose.inverse, max(np.ptp(foot.points, axis=0).max(), height)
    raised = 0.0
    if hold.supports:
        known = None if toolkit.supports is None else toolkit.supports.height
        raised = (known if hold.support_height is None else hold.support_height) or 0.0
    tops = [height if workpiece.solid is None else one.height - raised for one in hold.straps]
    tips = [
        make_disc(np.array([*back.apply(*one.at), top]), radius, UP)
        for one, top in zip(hold.straps, tops, strict=True)
    ]
    count = len(tips)
    clamping = np.full(count, strap_force)
    columns = tuple(tip.make_force(-UP) for tip in tips)
    points, normals = find_touched_points(fixture, workpiece, toolkit)
    strips = make_contact_strips(fixture, workpiece, points, normals, height, pressed_top)
    outward = np.column_stack([normals, np.zeros(len(normals))])
    # Side clamps, if the fixture has some, are left out.
    stands = [toolkit.find_carrier(peg.carrier).travel is None for peg in fixture.pegs]
    reads = tuple(
        strip.read(normal)
        for strip, normal, is_locator in zip(strips, outward, stands, strict=True)
        if is_locator
    )
    held = ElasticHold(
        columns, clamping, np.zeros((count, 6)), (reads,), np.zeros((len(reads), 0)),
        np.zeros((len(reads), count)), np.concatenate([tip.points for tip in tips]), float(size),
    )  # fmt: skip
    if not hold.supports:
        assert faces is not None
        held = add_friction(held, (*tips, foot), np.array([*[strap_force] * count, count * strap_force]))
        cells = list(faces.cells)
        for tip, top in zip(tips, tops, strict=True):
            x, y, _ = tip.middle.tolist()
            cells += faces.make_cells_under((x, y), radius, top)
        resting = tuple(range(len(held.columns), len(held.columns) + len(cells)))
        pressing = tuple(cell.make_force(UP) for cell in cells)
        return evolve(
            held,
            columns=(*held.columns, *pressing),
            clamping=np.concatenate([held.clamping, np.zeros(len(cells))]),
            answers=np.vstack([held.answers, np.zeros((len(cells), 6))]),
            locating=(*held.locating, pressing),
            gives=np.zeros((len(reads), len(held.columns) + len(cells))),
            resting=resting,
        )
    plate = next(one for one in toolkit.carriers if one.has_lattice and one.travel is None)
    at = np.array([back.apply(*plate.compute_hole_center(*one)) for one in hold.supports])
    pad_radius = hold.pad_radius or find_usual_pad_radius(toolkit)
    borne = add_pads_below(held, at, pad_radius).clamping[count:]
    if (borne < -1e-6 * strap_force).any():
        raise InputError("the straps tip the part off its supports, so that it is not known what bears it.")
    pads = [make_disc(np.array([x, y, 0.0]), pad_radius, -UP) for x, y in at]
    limits = np.array([*[strap_force] * count, *np.maximum(borne, 1e-3 * strap_force)])
    return add_pads_below(add_friction(held, (*tips, *pads), limits), at, pad_radius)


def add_friction(held: ElasticHold, patches: Sequence[LoadPatch], limits: Array) -> ElasticHold:
    """Return the hold with friction added on some level patches, which carries loads along the plate.

    Of all friction forces that balance a load, those with the least sum of squares over ``limits`` (P,), in
    N, are taken. Each patch is then about as near to slipping as the others.
    """
    columns: list[PointForces] = []
    weights: list[float] = []
    for patch, limit in zip(patches, limits.tolist(), strict=True):
        columns += [patch.make_force(np.array([1.0, 0.0, 0.0])), patch.make_force(np.array([0.0, 1.0, 0.0]))]
        columns.append(patch.make_unit_moment())
        weights += [limit, limit, limit * patch.compute_gyration()]
    level = [0, 1, 5]
    scale = np.array([1.0, 1.0, 1.0 / held.size])
    roots = np.sqrt(np.array(weights))
    wrenches = scale[:, None] * np.array([one.wrench[level] for one in columns]).T
    shared = roots[:, None] * np.linalg.pinv(wrenches * roots) * scale
    more = np.zeros((len(columns), 6))
    more[:, level] = -shared
    return evolve(
        held,
        columns=(*held.columns, *columns),
        clamping=np.concatenate([held.clamping, np.zeros(len(columns))]),
        answers=np.vstack([held.answers, more]),
        gives=np.zeros((len(held.gives), len(held.columns) + len(columns))),
    )


def make_elastic_jaw_hold(
    fixture: Fixture, hold: JawHold, foot: LoadPatch, jaw_force: float, height: float, size: float
) -> ElasticHold:
    """Return the elastic hold of two flat jaws, which press with affine pressures on the faces they touch.

    Of all balanced pressures the ones of least norm are taken.
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
        columns += [own.make_force(-outward, one) for one in factors]
        columns += [own.make_force(along), own.make_force(UP), own.make_force(UP, factors[1])]
        dents.append(turned)
        if side < 0:
            reads = tuple(own.make_force(outward, one) for one in factors)
    first, other = normal_columns
    bearing, below = make_foot_loads(foot)
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
    """Return points (M, 3) of a rectangle on a jaw, in the vise's frame, and the area in mm² that each
    represents.

    The rectangle is (x0, x1, z0, z1) in mm, cut off at ``height``. One narrower than a peg's strip is widened
    to that width.
    """
    x0, x1, z0, z1 = rectangle
    z1 = min(z1, height)
    if x1 - x0 < PEG_WIDTH:
        x0, x1 = (x0 + x1 - PEG_WIDTH) / 2, (x0 + x1 + PEG_WIDTH) / 2
    if z1 <= z0:
        raise InputError("the jaws do not reach the part at the thickness given: give the part's own.")
    sides = (np.array([x1 - x0, 0.0, 0.0]), np.array([0.0, 0.0, z1 - z0]))
    return make_rectangle(np.array([x0, y, z0]), sides)
