"""How a part is clamped: the reading at the jaw or clamp, the order of tightening, and the sticking friction.

The reading is the length by which a user sees in which seat the part rests: an opening, a stroke, or the
place of a tip.

With two clamps, a part is pushed against its locators by hand, then clamped. The locators alone fix the pose,
and neither clamp holds the part alone. So there is no opening, no reading and no cage, since it is not known
from which poses one clamp would bring the part into the seat. The instructions give the order of tightening,
and the locators on which each clamp alone does not press.

With little friction a part cannot stick near its seat. For a vise, or one clamp, it can stick if the friction
is at least the mu at which three of the four contacts balance the jaw with forces in their friction cones.
Contact i presses with h (-n + s mu t), |s| <= 1. Three forces balance where the determinant of their wrenches
is zero. At the least mu either all three |s| are 1, or one contact has no force. For given signs of s the
determinant is a cubic in mu. If even less friction suffices, the jaw's share of the forces vanishes at the
least mu: the three contacts lock with any force. That mu is found by bisection. Reference: V.-D. Nguyen,
"Constructing force-closure grasps", International Journal of Robotics Research 7 (1988).

Two clamps push with forces in a given ratio. Near the pose both tips touch, and a part that is not in the
pose has no contact with some locator. So the result is the least mu at which the contacts without one of the
three locators balance the clamps in their friction cones. As cones grow with mu, bisection finds it. Contacts
of poses that approach the fixture's pose approach the fixture's contacts, and forces with the sum 1 have a
limit. So below that mu the part cannot stick near the pose.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations
from math import floor, inf
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import NO_REACTION
from workhold.errors import join_words
from workhold.fixels.toolkit import Carrier, Toolkit
from workhold.kernels.seating.sticking import find_least_friction
from workhold.limits import MOST_FRICTION
from workhold.model.clamps import (
    LOCATORS,
    compute_clamp_force_ratio,
    describe_tightening_order,
    name_clamps,
    name_first_clamps,
)
from workhold.model.fixture import ClampPair, Fixture, Peg
from workhold.model.seating import DRY_STEEL, round_length
from workhold.model.setup import LengthSetting, list_length_settings
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.loads import find_contacts_on_part, make_cone_edges
from workhold.units import MILLIMETRE

__all__ = [
    "WHY",
    "HandLoading",
    "Gauge",
    "OpeningWords",
    "plan_hand_loading",
    "find_sticking_friction",
    "find_sticking_friction_of_two",
]


@frozen
class OpeningWords:
    """Phrases about opening and closing a jaw or clamp, to be put into sentences.

    Parameters
    ----------
    open, close : imperatives, such as "Open the jaws" and "close them".
    done, far : such as "Opened" and "wide the jaws open".
    hold, whose : such as "they hold" and "jaws'".
    """

    open: str
    close: str
    done: str
    far: str
    hold: str
    whose: str


CLAMP = OpeningWords(
    "Draw the clamp back", "tighten it", "Drawn back", "far the clamp is drawn back", "it holds", "clamp's"
)
# Jaws that clamp by closing (1), and by opening (-1).
VISE = {
    1: OpeningWords("Open the jaws", "close them", "Opened", "wide the jaws open", "they hold", "jaws'"),
    -1: OpeningWords("Close the jaws", "open them", "Closed", "far the jaws close", "they hold", "jaws'"),
}


@frozen
class Gauge:
    """The length that a user reads on a fixture to tell in which of its seats the part rests.

    Parameters
    ----------
    fixture, toolkit : the fixture, and its toolkit.
    """

    fixture: Fixture
    toolkit: Toolkit

    @property
    def carrier(self) -> Carrier:
        """The carrier that moves."""
        carriers = (self.toolkit.find_carrier(peg.carrier) for peg in self.fixture.pegs)
        return next(carrier for carrier in carriers if carrier.travel is not None)

    @property
    def setting(self) -> LengthSetting:
        """The length to be read (its name and its value in mm) when the part is in the fixture's own pose."""
        return list_length_settings(self.fixture, self.toolkit)[0]

    @property
    def opening_words(self) -> OpeningWords:
        """The words for opening and closing this toolkit's jaw or clamp."""
        return VISE[self.toolkit.clamping] if self.carrier.on is None else CLAMP

    @property
    def grows(self) -> bool:
        """Whether the reading grows as the jaw or clamp is opened. An opening grows; a stroke becomes
        smaller.
        """
        return self.compute_reading(self.fixture.travel + self.toolkit.clamping) > self.setting.length

    def place_pegs(self, travelled: float) -> tuple[Peg, ...]:
        """Return all of the fixture's pegs with the moving jaw or clamp at another travel.

        Parameters
        ----------
        travelled : travel of the moving carrier in mm, such as the jaw separation.
        """
        moving = self.carrier
        assert moving.travel is not None
        (x, y), by = moving.travel.unit, travelled - self.fixture.travel
        return tuple(
            evolve(peg, x=peg.x + by * x, y=peg.y + by * y) if peg.carrier == moving.name else peg
            for peg in self.fixture.pegs
        )

    def compute_reading(self, travelled: float) -> float:
        """Return the length in mm to be read when the jaw or clamp is at the travel ``travelled`` (mm).

        Examples
        --------
        >>> from workhold import Plate
        >>> from workhold.model.fixture import Pose
        >>> tip = Peg("clamp -x", 4, 1, 66.0, 20.0, 2, 1.0)
        >>> fixture = Fixture("clamp", (tip,), Pose(0, 0, 0), -14.0, {}, "-x")
        >>> Gauge(fixture, Plate(pitch=20, peg_radius=3, travel=(10, 30))).compute_reading(-12.5)
        12.5
        """
        moved = evolve(self.fixture, pegs=self.place_pegs(travelled), travel=travelled)
        return list_length_settings(moved, self.toolkit)[0].length


Array = NDArray[np.float64]
# mm. Contacts are counted in parts of how far they are apart, but of this at least.
SMALLEST = 1e-9
# By how much forces of sum 1 may miss their balance, or be below 0, for rounding.
BALANCED = 1e-10
# A coefficient of friction is known to this part of it.
PRECISION = 1e-9


def find_sticking_friction(points: Array, normals: Array, right: Array) -> float:
    """Return the least friction coefficient at which two or three of four contacts can balance the jaw force.

    With less friction the part slides on. The result is inf if the contacts balance at no coefficient.

    ``points`` (4, 2) are places in mm and ``normals`` (4, 2) unit vectors out of the part, both in the
    closing frame. ``right`` (4,) is 1 for contacts with pegs of the moving jaw, else 0.
    """
    size = max(float((points.max(axis=0) - points.min(axis=0)).max()), SMALLEST)
    contacts = (
        (points - points.sum(axis=0) / len(points)) / size,
        np.ascontiguousarray(normals),
        np.asarray(right, dtype=np.int64),
    )
    return float(
        find_least_friction(*contacts, np.empty((4, 3)), np.empty((4, 3)), np.empty((4, 4)), np.empty((4, 4)))
    )


def find_sticking_friction_of_two(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> float:
    """Return the least friction coefficient at which a part under two clamps can stick without touching one
    of its locators.

    At that coefficient the two clamps, with forces in their working ratio, balance while one of the locators
    has no force. The result is inf if they do not balance at any coefficient up to ``MOST_FRICTION``.
    """
    ratio = compute_clamp_force_ratio(fixture)
    touched = TouchableFeatures.from_workpiece(workpiece, toolkit)
    contacts = find_contacts_on_part(
        fixture, workpiece, toolkit, touched, touched.compute_for_fixture(fixture, toolkit)
    )
    low, high = 0.0, MOST_FRICTION

    def does_stick(friction: float) -> bool:
        """Return whether both clamps balance without one of the locators at this friction coefficient."""
        edges, share = make_cone_edges(*contacts, friction, touched.length)
        return balances_without_a_locator(edges, share, ratio)

    if not does_stick(high):
        return inf
    while high - low > PRECISION * high:
        middle = (low + high) / 2
        low, high = (low, middle) if does_stick(middle) else (middle, high)
    return high


def balances_without_a_locator(edges: Array, share: Array, ratio: float) -> bool:
    """Return whether two clamps can balance on two of the three locators.

    If a balance without negative forces exists, there is one with no more forces above zero than equations
    (V. Chvatal, *Linear Programming*, 1983, chapter 3). So all choices of that many forces are tried.

    ``edges`` and ``share`` are those of ``statics.loads.make_cone_edges`` for five pegs, the two clamps last.
    ``ratio`` is the second clamp's force divided by the first clamp's.
    """
    count = len(edges) // 2
    clamps = [np.isin(np.arange(2 * count) % count, [k]) * share for k in (LOCATORS, LOCATORS + 1)]
    # Balance, what the clamps push with in parts of an unknown force, and the sum of all.
    rows = np.vstack([edges.T, *clamps, np.ones(2 * count)])
    force = np.array([0.0, 0.0, 0.0, -1.0, -ratio, 0.0]) / (1.0 + ratio)
    wanted = np.eye(len(rows))[-1]
    for left_out in range(LOCATORS):
        columns = np.column_stack([rows[:, np.arange(2 * count) % count != left_out], force])
        chosen = columns[:, list(combinations(range(columns.shape[1]), len(rows)))].transpose(1, 0, 2)
        chosen = chosen[np.linalg.det(chosen) != 0.0]
        forces = np.linalg.solve(chosen, np.broadcast_to(wanted, (len(chosen), len(rows)))[..., None])
        missed = np.abs(chosen @ forces - wanted[:, None]).max(axis=(1, 2))
        if ((forces.min(axis=(1, 2)) > -BALANCED) & (missed < BALANCED)).any():
            return True
    return False


WHY = (
    "Neither of the two clamps holds the part alone, so it is not known from how far off "
    "they would bring it to its place: put it there by hand. The locators alone fix that "
    "place."
)
# Friction is given to so many decimals, rounded down.
DECIMALS = 3
# A ratio of forces below this is given to two digits, others to hundredths.
SMALL = 0.1


@frozen(repr=False)
class HandLoading:
    """Instructions to put a part into a fixture with two clamps by hand.

    Parameters
    ----------
    fixture, toolkit : the fixture, and its toolkit.
    sticking_friction : friction coefficient below which both clamps, at their working ratio, push a part that
        is slightly off a locator back to it. It is inf if they do so at any friction, and None (not computed)
        for pegs with a flat.
    """

    fixture: Fixture
    toolkit: Toolkit
    sticking_friction: float | None

    def __repr__(self) -> str:
        friction = (
            ""
            if self.sticking_friction is None
            else f", sticks from a friction of {self.sticking_friction:.3f}"
        )
        return f"<HandLoading of {self.fixture}{friction}>"

    @property
    def pair(self) -> ClampPair:
        """The fixture's pair of clamps."""
        assert self.fixture.pair is not None
        return self.fixture.pair

    @property
    def unpressed(self) -> tuple[tuple[Peg, ...], ...]:
        """For each clamp, the locators and wall ends on which the part has no force when only this clamp is
        tight.
        """
        known = list(zip(self.fixture.pegs, self.pair.reactions, strict=True))[:LOCATORS]
        return tuple(tuple(peg for peg, pressed in known if pressed[k] < NO_REACTION) for k in range(2))

    def to_fields(self, text: Callable[[float], str] = MILLIMETRE.format_length) -> dict[str, Any]:
        """Return the instructions as a dictionary for JSON, with clamps and locators by their names.

        Parameters
        ----------
        text : function that returns a length in mm as text with the unit's abbreviation, such as '12.5 mm'.
        """
        return {
            "clamps": list(name_clamps(self.fixture)),
            "first": list(name_first_clamps(self.fixture)),
            "unpressed": [[peg.hole for peg in pegs] for pegs in self.unpressed],
            "ratio": [round_length(end) for end in self.pair.ratio],
            "working_ratio": round_length(self.pair.working_ratio),
            "sticking_friction": round_length(self.sticking_friction),
            "why": WHY,
            "steps": self.list_steps(text),
        }

    def list_steps(
        self, text: Callable[[float], str] = MILLIMETRE.format_length, with_order: bool = True
    ) -> list[str]:
        """Return the steps at the machine in order, each a text of one or more sentences.

        Parameters
        ----------
        text : function that returns a length in mm as text with the unit's abbreviation, such as '12.5 mm'.
        with_order : whether to say in which order the clamps are tightened.
        """
        order = [describe_tightening_order(self.fixture)] if with_order else []
        steps = [self.describe_push(), self.describe_touch(), " ".join([*order, self.describe_hold()])]
        return [*steps, *self.describe_friction(), self.describe_final_check(text)]

    def describe_push(self) -> str:
        """Return the first step: draw the clamps back and push the part against its locators."""
        locators = [peg.hole for peg in self.fixture.placed[: -self.toolkit.tip_count]]
        noun = self.toolkit.carriers[0].peg
        in_holes = f"all three {noun}s, " if len(locators) == LOCATORS else f"the {noun} in "
        flush = [f"the {one.noun}, flush," for one in self.toolkit.carriers if not one.contact.is_placed]
        against = " and against ".join([*flush, in_holes + join_words(locators)])
        ways = (self.fixture.direction or "").split()
        # Of clamps that push against each other neither shows the way.
        way = "" if len({name[1] for name in ways}) < len(set(ways)) else f" {self.direction_words}"
        return f"Draw both clamps back and push the part{way} by hand until it lies against {against}."

    @property
    def direction_words(self) -> str:
        """The direction in which both clamps push, in words."""
        return self.toolkit.find_arrangement(self.fixture.type, self.fixture.direction).direction_words

    def describe_touch(self) -> str:
        """Return the step that tests with slips of paper whether the part touches all locators."""
        touched = join_words(
            [f"{peg.touching} at {name_place(peg, self.toolkit)}" for peg in self.fixture.pegs[:LOCATORS]]
        )
        out = "If no slip comes out, the part lies against all of them."
        return f"Pull at a slip of paper at each of these: {touched}. {out}"

    def describe_hold(self) -> str:
        """Return the instruction to hold the part until both clamps are tight.

        It names the locators on which the clamp that is tightened first does not press the part.
        """
        hold = "Hold the part in its place until both clamps are tight"
        first, names = name_first_clamps(self.fixture), name_clamps(self.fixture)
        loose = [
            f"{name} alone does not press it on {join_words(name_places(pegs, self.toolkit))}"
            for name, pegs in zip(names, self.unpressed, strict=True)
            if name in first
        ]
        return f"{hold}: {', and '.join(loose)}." if loose else f"{hold}."

    def describe_friction(self) -> list[str]:
        """Return a list of one sentence about friction, or an empty list where the sticking friction is
        None.
        """
        least, (first, second) = self.sticking_friction, name_clamps(self.fixture)
        if least is None:
            return []
        ratio = self.pair.working_ratio
        together = f"{second} with {ratio:{'.2f' if ratio >= SMALL else '.2g'}} times the force of {first}"
        if least == inf:
            return [
                f"Tightened together, {together}, both clamps bring a part that is a little off a locator "
                "back to it, whatever the friction."
            ]
        friction = f"{floor(least * 10.0**DECIMALS) / 10.0**DECIMALS:.{DECIMALS}f}"
        steel = "dry steel has 0.1 to 0.2"
        if least >= DRY_STEEL:
            return [
                f"Tightened together, {together}, both clamps bring a part that is a little off a locator "
                f"back to it while friction is below {friction}; {steel}."
            ]
        return [
            f"If the friction is {friction} or more, the part can stay a little off a locator even "
            f"under both clamps, {together}; {steel}, so tap it home as you tighten."
        ]

    def describe_final_check(self, text: Callable[[float], str]) -> str:
        """Return the last step: test with paper again, and compare the lengths at the clamps.

        ``text`` is that of :meth:`list_steps`.
        """
        settings = list_length_settings(self.fixture, self.toolkit)
        names = name_clamps(self.fixture)
        lengths = [
            f"a {one.name} of {text(one.length)} at {name}" for one, name in zip(settings, names, strict=True)
        ]
        wrong = "with other lengths the part lies against the locators another way"
        return f"Try the paper again. The right lengths are {join_words(lengths)}; {wrong}."


def plan_hand_loading(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> HandLoading:
    """Return the instructions for a fixture with two clamps."""
    friction = None if toolkit.has_flats else find_sticking_friction_of_two(fixture, workpiece, toolkit)
    return HandLoading(fixture, toolkit, friction)


def name_place(peg: Peg, toolkit: Toolkit) -> str:
    """Return the words for the place of a locator: its hole; for one end of a wall contact, the wall and the
    side of that end.
    """
    carrier = toolkit.find_carrier(peg.carrier)
    if carrier.contact.is_placed:
        return peg.hole
    return f"the {carrier.noun} on the {peg.hole.rpartition(' ')[2]}"


def name_places(pegs: Sequence[Peg], toolkit: Toolkit) -> list[str]:
    """Return the words for the places of some pegs. The wall is named once if both ends of its contact are
    among them.
    """
    carriers = [toolkit.find_carrier(peg.carrier) for peg in pegs]
    walls = [one.noun for one in carriers if not one.contact.is_placed]
    if len(walls) < 2:
        return [name_place(peg, toolkit) for peg in pegs]
    placed = [peg.hole for peg, one in zip(pegs, carriers, strict=True) if one.contact.is_placed]
    return [f"the {walls[0]}", *placed]
