"""The effect of loads on one fixture: peg forces, the jaw force needed, and the possible help by friction.

Contacts are without friction and bodies are rigid, so the force on the moving carrier determines the peg
forces exactly: f = f0 + F h. F is that force (the jaw force of a vise), h the peg forces per unit of it, and
f0 balances the load without pushing that carrier. The push of a hydraulic or pneumatic jaw stays constant,
and the other contacts carry a load as if the jaw were absent. A screw vise is closed with a force F and is
then locked. All contacts share a load according to their stiffness, as in a preloaded bolt (VDI 2230), and
the push of the jaw changes with it.

Let contacts be springs of the same stiffness and the jaw one of s times that, A be the contact matrix (see
``kernels.contact.contact_matrix``), B = A^-T, and h its last column. With a jaw that keeps its force, a load
g = (g_x, g_y, m / L, 0) gives f0 = B g. All forces that balance the load are f0 + k h. A spring of the jaw
takes up k / s, so the forces are those with the least energy sum f^2 + k^2 / s (Castigliano; S. Timoshenko
and J. N. Goodier, *Theory of Elasticity*, 1970, section 92; for grasps A. Bicchi, Robotics and Autonomous
Systems 13, 1994):

    f = f0 - h (h . f0) / (1 / s + h . h),

which is f0 for s = 0, and the part of f0 at right angles to h for a rigid jaw. It holds while every peg stays
in contact. Two clamps have a column each in H, the forces are f0 + H k, and f = f0 - H (1 / s + H'H)^-1 H'f0.

With friction every contact may press within its cone, along -n + mu t and -n - mu t with forces x >= 0 (V.-D.
Nguyen, International Journal of Robotics Research 7, 1988). The least jaw force that balances a load g is the
linear program

    minimize r . x   subject to   W x = -g,  x >= 0,

with r the share of each edge in pushing the carrier that moves. Its dual (V. Chvatal, *Linear Programming*,
1983, chapter 5) asks for the motion y of the part that does the most work -g . y among those with W^T y <= r.
These form a polytope, because the wrenches span the space, and for every load the maximum is at one of its
few corners.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, permutations
from math import atan2, cos, degrees, hypot, inf, isfinite, radians, sin

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import FLAT, NO_FORCE, OUTSIDE
from workhold.errors import InputError
from workhold.fixels.pegs import compute_standoff
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.contact.quality import HALF, HIGH_X, HIGH_Y, LOW_X, LOW_Y, MIDDLE_X, MIDDLE_Y
from workhold.limits import MOST_FRICTION, convert_real, refuse_strong
from workhold.model.fixture import Fixture
from workhold.model.requirements import Load
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import ContactMatrices, TouchableFeatures

__all__ = [
    "LoadCase",
    "WorstLoad",
    "make_cone_edges",
    "find_contacts_on_part",
    "compute_needed_jaw_forces",
    "read_jaw_stiffness",
    "describe_jaw",
    "compute_load_cases",
    "compute_forces_with_jaw_stiffness",
]

Array = NDArray[np.float64]
STIFFNESS = {"screw": inf, "constant": 0.0}


def read_jaw_stiffness(jaw: str | float) -> float:
    """Return the stiffness of a closed jaw, relative to that of one contact.

    Parameters
    ----------
    jaw : "screw" (rigid once it is closed), "constant" (it keeps its force), or the number itself.

    Raises
    ------
    InputError
        For anything else.

    Examples
    --------
    >>> read_jaw_stiffness("screw"), read_jaw_stiffness("constant"), read_jaw_stiffness("2.5")
    (inf, 0.0, 2.5)
    """
    if isinstance(jaw, str):
        word = jaw.strip().lower()
        if word in STIFFNESS:
            return STIFFNESS[word]
    try:
        value = float(jaw) if isinstance(jaw, str) else convert_real(jaw)
    except ValueError:
        value = -1.0
    if not value >= 0:
        raise InputError(
            f"jaw {str(jaw)[:40]!r} is not known: give screw, constant, or how many times as stiff as one "
            "contact it is."
        )
    return value


def describe_jaw(stiffness: float, toolkit: Toolkit) -> str:
    """Return a phrase that describes a jaw or clamp of a given stiffness.

    >>> from workhold import Plate, Vise
    >>> describe_jaw(0.0, Plate(pitch=20, peg_radius=5)), describe_jaw(5.0, Vise(pitch=10, columns=2, peg_radius=3))
    ('a clamp that keeps its force', 'a screw vise, its jaw 5 times as stiff as a contact')
    """
    if stiffness == 0:
        return f"a {toolkit.moving.noun} that keeps its force"
    state = "locked" if stiffness == inf else f"{stiffness:g} times as stiff as a contact"
    return f"{toolkit.locked} {state}"


def compute_forces_with_jaw_stiffness(free: Array, closing: Array, stiffness: float) -> Array:
    """Return the peg forces (..., P, 3) per unit of a load's g_x, g_y and moment, when jaws of this stiffness
    share the load.

    Parameters
    ----------
    free : (..., P, 3) peg forces per unit of load with a jaw that keeps its force.
    closing : (..., P, M) peg forces per unit of the force of each jaw or clamp.
    stiffness : stiffness of a jaw, divided by that of a contact; 0 returns ``free``, inf is a locked jaw.
    """
    if stiffness == 0:
        return free
    back = np.swapaxes(closing, -1, -2)
    springs = np.eye(closing.shape[-1]) / stiffness + back @ closing
    return np.asarray(free - closing @ np.linalg.solve(springs, back @ free))


def compute_needed_jaw_forces(inverses: Array, closing: Array, length: float, loads: Array) -> Array:
    """Return for each fixture the jaw force (N,) in N of a screw vise at which no peg lets go under any load.

    At least 0. Peg i presses with f0_i - h_i (h . f0) / (h . h) + F h_i, where h_i > 0; the letters are those
    of the module's head. With two clamps F is the sum of their forces, at the working ratio, and the
    component of f0 in the plane of both clamps' columns is subtracted.

    Parameters
    ----------
    inverses : (N, 4, P) inverses of the contact matrices, h in the last row.
    closing : (N, P, M) peg forces per unit of the force of each jaw or clamp.
    length : L in mm.
    loads : (M, 11) rows of loads, see ``kernels.contact.quality``.
    """
    held = inverses[:, 3]
    back = np.swapaxes(closing, 1, 2)
    taken = np.linalg.solve(back @ closing, back @ np.swapaxes(inverses[:, :3], 1, 2))
    shares = np.swapaxes(closing @ taken, 1, 2) / held[:, None]
    a, b, c = np.moveaxis(shares - inverses[:, :3] / held[:, None], 1, 0)
    most = np.zeros(len(inverses))
    for load in loads:
        force, px, py, moment = load[0], load[1] / length, load[2] / length, load[3] / length
        x, y = a - py * c, b + px * c
        size = np.hypot(x, y)
        ends = np.maximum(x * load[LOW_X] + y * load[LOW_Y], x * load[HIGH_X] + y * load[HIGH_Y])
        largest = np.where(x * load[MIDDLE_X] + y * load[MIDDLE_Y] >= size * load[HALF], size, ends)
        most = np.maximum(most, (moment * c + force * largest).max(axis=1))
    return most


def find_touched_points(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> tuple[Array, Array]:
    """Return (1) the points (P, 2) in mm at which pegs touch the part,
    and (2) its outward unit normals there (P, 2).

    Both are in the part's frame.
    """
    touched = TouchableFeatures.from_workpiece(workpiece, toolkit)
    points, normals, *_ = find_contacts_on_part(
        fixture, workpiece, toolkit, touched, touched.compute_for_fixture(fixture, toolkit)
    )
    return points + touched.center, normals


def find_contacts_on_part(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    touched: TouchableFeatures,
    matrices: ContactMatrices,
) -> tuple[Array, Array, Array, Array]:
    """Return (contacts, normals, moving, against) of a fixture, the
    first four arguments of :func:`make_cone_edges`.

    ``against`` is (P, 2) here.

    Parameters
    ----------
    touched : features of the part that the toolkit's pegs can touch.
    matrices : contact matrix of the fixture.
    """
    carriers = toolkit.find_carrier_numbers(peg.carrier for peg in fixture.pegs)
    faces = {face.number: face.segment for face in workpiece.numbered.faces}
    pegs = zip(fixture.pegs, (toolkit.carriers[number] for number in carriers), strict=True)
    radii = np.array([compute_standoff(one.peg_radius, one.flat, faces[peg.face]) for peg, one in pegs])
    normals = matrices.normals[0]
    against = -fixture.pose.inverse.turn(touched.directions[carriers])
    return matrices.points[0] - radii[:, None] * normals, normals, touched.moving[carriers], against


def make_cone_edges(
    contacts: Array, normals: Array, moving: Array, against: Array, friction: float, length: float
) -> tuple[Array, Array]:
    """Return (1) wrenches (2 P, 3) of the edges of friction cones, and (2) shares (2 P,) of the edges.

    A share is the force by which a unit force along the edge pushes the moving carrier back.

    Parameters
    ----------
    contacts : (P, 2) contact points relative to the part's centre, in mm (with friction they are not the peg
        centres).
    normals : (P, 2) outward unit normals.
    moving : (P,) 1 for pegs on the carrier that moves, 0 for others.
    against : (2,) unit vector in the part's frame opposite to the clamping direction, or (P, 2) for each peg.
    friction : coefficient of friction mu.
    length : length L in mm that moments are divided by.
    """
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    edges = np.concatenate([-normals + friction * tangents, -normals - friction * tangents])
    at = np.concatenate([contacts, contacts])
    moments = (at[:, 0] * edges[:, 1] - at[:, 1] * edges[:, 0]) / length
    against = np.broadcast_to(against, normals.shape)
    share = -(edges * np.concatenate([against, against])).sum(axis=1) * np.concatenate([moving, moving])
    return np.column_stack([edges, moments]), share


def list_possible_motions(
    contacts: Array, normals: Array, moving: Array, against: Array, friction: float, length: float
) -> Array:
    """Return the corners of the dual polytope, (M, 3): jaw force in N per unit of (g_x, g_y, moment in N mm).

    The parameters are those of :func:`make_cone_edges`. The jaw force needed for a load (g_x, g_y, moment) is
    its largest scalar product with a corner, at least 0. No corners mean that friction alone can jam the part
    between pegs of one carrier, so that no load needs any jaw force.
    """
    wrenches, share = make_cone_edges(contacts, normals, moving, against, friction, length)
    corners = []
    for chosen in combinations(range(len(wrenches)), 3):
        planes = wrenches[list(chosen)]
        if abs(np.linalg.det(planes)) > FLAT:
            corner = np.linalg.solve(planes, share[list(chosen)])
            if (wrenches @ corner - share <= OUTSIDE * (1.0 + np.abs(corner).max())).all():
                corners.append(corner)
    return np.asarray(-np.array(corners).reshape(-1, 3) / [1.0, 1.0, length])


@frozen
class WorstLoad:
    """The point and direction at which a load is worst.

    Parameters
    ----------
    value : the worst force there, in N.
    peg : index of the peg concerned, in the fixture's order.
    point : point where the load acts, in mm in the part's coordinates; the part's centre for a moment alone.
    direction : direction of the load, in degrees in the part's frame, in [0, 360).
    """

    value: float
    peg: int
    point: tuple[float, float]
    direction: float


@frozen
class LoadCase:
    """The effect of one load on a fixture; forces in N, for the worst point and direction of the load.

    Parameters
    ----------
    load : the load.
    jaw_stiffness : stiffness of the closed jaw, divided by that of one contact: inf for a screw, 0 for a jaw
        that keeps its force.
    jaw_force : force on the moving carrier before the load acts; ``smallest`` and ``largest`` hold for it.
    smallest, largest : smallest and largest force of each peg, in the fixture's order. A peg with a negative
        force would have to pull: it lets go, and the given forces are then no longer the real ones.
    reaction : the largest peg force at the least clamping for which no force is negative (the figure of
        quality ``compute_load_reaction``).
    needed : the jaw force above which no peg lets go, and the peg that lets go below it; never negative.
    needed_with_friction : the jaw force above which Coulomb friction could hold the part; None where no
        friction was given. It is optimistic: with friction, statics does not determine the forces, and the
        most favourable ones are assumed. It also assumes a jaw that keeps its force; a locked jaw needs no
        more. Pegs may let go.
    """

    load: Load
    jaw_stiffness: float
    jaw_force: float
    smallest: tuple[float, ...]
    largest: tuple[float, ...]
    reaction: WorstLoad
    needed: WorstLoad
    needed_with_friction: float | None

    @property
    def keeps_contact(self) -> bool:
        """Whether every peg presses on the part at this jaw force, or just touches it within rounding."""
        return min(self.smallest) >= -NO_FORCE * max(self.largest)


def compute_load_cases(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    loads: Load | Sequence[Load],
    jaw_force: float | None = None,
    friction: float | None = None,
    jaw: str | float = "screw",
) -> tuple[LoadCase, ...]:
    """Return the effect of each load, acting by itself, on a fixture.

    Parameters
    ----------
    loads : see :class:`workhold.model.requirements.Load`.
    jaw_force : force in N that pushes the moving carrier; by default the one needed so that no peg lets go
        under any load.
    friction : Coulomb's coefficient of friction between peg and part, to compute its possible help.
    jaw : "screw", "constant", or how many times as stiff as one contact the jaw is; see ``statics.loads``.

    Raises
    ------
    InputError
        For a fixture of another part or toolkit, a jaw force or a coefficient that is negative or not finite,
        and a jaw that is not known.
    """
    if fixture.hold is not None or toolkit.strap_set is not None:
        what = "straps" if toolkit.strap_set is not None else "flat jaws"
        raise InputError(
            f"{what} hold it by friction: how hard they must press under loads is found with the design, in the fixture's "
            "hold.clamp_needed_each."
        )
    fixture.refuse_others(workpiece, toolkit)
    loads = (loads,) if isinstance(loads, Load) else loads
    for name, value in (("jaw force", jaw_force), ("friction", friction)):
        if value is not None and not (isfinite(convert_real(value, name)) and value >= 0):
            raise InputError(f"{name} {convert_real(value):g} cannot be used: give 0 or more.")
    refuse_strong("jaw force", jaw_force or 0.0)
    if friction is not None and friction > MOST_FRICTION:
        raise InputError(
            f"friction {friction:g} is beyond {MOST_FRICTION:g}: give the coefficient, such as 0.15."
        )
    stiffness, touched = read_jaw_stiffness(jaw), TouchableFeatures.from_workpiece(workpiece, toolkit)
    contact_matrices = touched.compute_for_fixture(fixture, toolkit)
    # Rows: force of each peg per unit of (g_x, g_y, moment, jaw force); see kernels.contact.contact_matrix.
    forces = contact_matrices.inverses[0].T / np.array([1.0, 1.0, touched.length, 1.0])
    # The jaw was closed before the load came, so its own column stays.
    forces[:, :3] = compute_forces_with_jaw_stiffness(forces[:, :3], contact_matrices.closing[0], stiffness)
    motions = None
    if friction is not None:
        on_part = find_contacts_on_part(fixture, workpiece, toolkit, touched, contact_matrices)
        motions = list_possible_motions(*on_part, friction, touched.length)
    center = (float(touched.center[0]), float(touched.center[1]))
    needs = [find_needed_force(forces, load, center) for load in loads]
    if jaw_force is None:
        jaw_force = max((worst.value for worst in needs), default=0.0)
    jaw_force = float(jaw_force)
    return tuple(
        LoadCase(
            load=load,
            jaw_stiffness=stiffness,
            jaw_force=jaw_force,
            smallest=tuple(
                float(-find_largest_push(-row, load, center).value + jaw_force * row[3]) for row in forces
            ),
            largest=tuple(
                float(find_largest_push(row, load, center).value + jaw_force * row[3]) for row in forces
            ),
            reaction=find_largest_reaction(forces, load, center),
            needed=need,
            needed_with_friction=find_force_with_friction(motions, load, center, need, stiffness),
        )
        for load, need in zip(loads, needs, strict=True)
    )


def find_largest_value(x: float, y: float, directions: tuple[float, float]) -> tuple[float, float]:
    """Return (1) the largest x cos t + y sin t for t in a range of degrees, and (2) that t in [0, 360)."""
    low, high = directions
    peak = low + (degrees(atan2(y, x)) - low) % 360.0
    candidates = [low, high, peak] if peak <= high else [low, high]
    value, direction = max((x * cos(radians(angle)) + y * sin(radians(angle)), angle) for angle in candidates)
    return (hypot(x, y) if direction == peak else value), direction % 360.0


def find_largest_push(
    coefficients: Array, load: Load, center: tuple[float, float], peg: int = 0
) -> WorstLoad:
    """Return the point and direction at which a load makes a linear
    function of it largest, and the value there.

    The function is the scalar product of ``coefficients`` (3,) and (g_x, g_y, moment). The moment includes
    that of the force about ``center``. ``peg`` is merely copied into the result.
    """
    a, b, c = (float(value) for value in coefficients[:3])
    worst: WorstLoad | None = None
    for x, y in load.points or (center,):
        dx, dy = x - center[0], y - center[1]
        value, direction = find_largest_value(a - dy * c, b + dx * c, load.directions)
        total = load.force * value + load.moment * c
        if worst is None or total > worst.value:
            worst = WorstLoad(total, peg, (x, y), direction)
    assert worst is not None
    return worst


def find_needed_force(forces: Array, load: Load, center: tuple[float, float]) -> WorstLoad:
    """Return the jaw force below which a peg lets go under a load, with the point and direction of the load.

    The force is the largest -f0_i / h_i, at least 0. ``forces`` (P, 4) are peg forces per unit of g_x, g_y,
    moment and jaw force.
    """
    pushes = (find_largest_push(-row / row[3], load, center, peg) for peg, row in enumerate(forces))
    worst = max(pushes, key=lambda push: push.value)
    return evolve(worst, value=max(worst.value, 0.0))


def find_largest_reaction(forces: Array, load: Load, center: tuple[float, float]) -> WorstLoad:
    """Return the largest peg force under a load at the least clamping that keeps all contacts, with its point
    and direction.

    ``forces`` (P, 4) are as in :func:`find_needed_force` (Brost & Goldberg 1996,
    ``kernels.contact.quality``).
    """
    pairs = permutations(range(len(forces)), 2)
    return max(
        (
            find_largest_push(forces[j] - forces[i] * forces[j, 3] / forces[i, 3], load, center, j)
            for j, i in pairs
        ),
        key=lambda worst: worst.value,
    )


def find_force_with_friction(
    motions: Array | None, load: Load, center: tuple[float, float], need: WorstLoad, stiffness: float
) -> float | None:
    """Return the jaw force in N needed with friction: the largest work of a load on the motions, at least 0.

    None if ``motions`` is None. Otherwise ``motions`` are the corners that :func:`list_possible_motions`
    returns. With a jaw of some ``stiffness``, the result is at most the force ``need`` without friction.
    """
    if motions is None:
        return None
    least = max([0.0, *(find_largest_push(motion, load, center).value for motion in motions)])
    return min(least, need.value) if stiffness else least
