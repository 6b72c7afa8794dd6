"""How a part gets into two clamps: it is pushed against its locators by hand, then clamped.

The locators alone fix the pose, and neither clamp holds the part alone. So it is not known from where one of
them would bring it home: there is no opening, no reading, no cage. The order of tightening is known, and
which locators each clamp alone does not press the part on. So is the friction below which both bring home a
part that is a little off a locator.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import floor, inf
from typing import Any

from attrs import frozen

from workhold.conventions import NO_REACTION
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture, Pair, Peg
from workhold.model.seating import DRY_STEEL, length
from workhold.model.setting import settings_of
from workhold.model.tightening import clamp_names, first_clamps, order_words
from workhold.model.workpiece import Workpiece
from workhold.plain import listed
from workhold.units import MILLIMETRE

__all__ = ["WHY", "ByHand", "by_hand"]

WHY = (
    "Neither of the two clamps holds the part alone, so from where they bring it home is not known: put it in its place by "
    "hand. The locators alone fix that place."
)
LOCATORS = 3
# Friction is given to so many decimals, rounded down.
DECIMALS = 3
# A ratio of forces below this is given to two digits, others to hundredths.
SMALL = 0.1


@frozen(repr=False)
class ByHand:
    """How to put a part into two clamps, and what is known of it there.

    Parameters
    ----------
    fixture, toolkit : what holds it.
    sticking_friction : the coefficient below which a part a little off a locator comes home in both clamps at
        their working ratio. It is infinite where the part always does, and None for pegs with a flat.
    """

    fixture: Fixture
    toolkit: Toolkit
    sticking_friction: float | None

    def __repr__(self) -> str:
        friction = "" if self.sticking_friction is None else f", sticks from a friction of {self.sticking_friction:.3f}"
        return f"<ByHand of {self.fixture}{friction}>"

    @property
    def pair(self) -> Pair:
        """What is particular to the two clamps."""
        assert self.fixture.pair is not None
        return self.fixture.pair

    @property
    def unpressed(self) -> tuple[tuple[Peg, ...], ...]:
        """The locators, and ends of the contact with a wall, without force under each clamp alone."""
        known = list(zip(self.fixture.pegs, self.pair.reactions, strict=True))[:LOCATORS]
        return tuple(tuple(peg for peg, pressed in known if pressed[k] < NO_REACTION) for k in range(2))

    def as_fields(self, text: Callable[[float], str] = MILLIMETRE.text) -> dict[str, Any]:
        """What is known and what to do, as JSON has it, with clamps and locators by their names.

        Parameters
        ----------
        text : writes a length in mm with its unit.
        """
        return {
            "clamps": list(clamp_names(self.fixture)),
            "first": list(first_clamps(self.fixture)),
            "unpressed": [[peg.hole for peg in pegs] for pegs in self.unpressed],
            "ratio": [length(end) for end in self.pair.ratio],
            "working_ratio": length(self.pair.working_ratio),
            "sticking_friction": length(self.sticking_friction),
            "why": WHY,
            "steps": self.steps(text),
        }

    def steps(self, text: Callable[[float], str] = MILLIMETRE.text, with_order: bool = True) -> list[str]:
        """What to do at the machine, and what to look at, one step each.

        Parameters
        ----------
        text : writes a length in mm with its unit.
        with_order : whether the order of tightening is among the steps; some papers have it elsewhere.
        """
        order = [order_words(self.fixture)] if with_order else []
        steps = [self.push_words(), self.touch_words(), " ".join([*order, self.hold_words()])]
        return [*steps, *self.friction_words(), self.after_words(text)]

    def push_words(self) -> str:
        """How to put the part in, in one step."""
        locators = [peg.hole for peg in self.fixture.pegs[:LOCATORS] if not peg.is_on_wall]
        wall, noun = self.toolkit.wall, self.toolkit.carriers[0].peg
        against = f"all three {noun}s, {listed(locators)}"
        if wall is not None:
            against = f"the {wall.noun}, flush, and against the {noun} in {listed(locators)}"
        ways = (self.fixture.direction or "").split()
        # Of clamps that push against each other neither shows the way.
        way = "" if len({name[1] for name in ways}) < len(set(ways)) else f" {self.towards}"
        return f"Draw both clamps back and push the part{way} by hand until it lies against {against}."

    @property
    def towards(self) -> str:
        """The direction in which both clamps push, in words."""
        return self.toolkit.arrangement(self.fixture.type, self.fixture.direction).towards

    def touch_words(self) -> str:
        """How to see that it lies right."""
        touched = listed([f"{peg.touching} at {place_of(peg, self.toolkit)}" for peg in self.fixture.pegs[:LOCATORS]])
        return f"Pull at a slip of paper at each: {touched}. If none comes out, the part lies against all of them."

    def hold_words(self) -> str:
        """Until when to hold the part."""
        hold = "Hold the part in its place until both are tight"
        first, names = first_clamps(self.fixture), clamp_names(self.fixture)
        loose = [
            f"{name} alone does not press it on {listed(places_of(pegs, self.toolkit))}"
            for name, pegs in zip(names, self.unpressed, strict=True)
            if name in first
        ]
        return f"{hold}: {', and '.join(loose)}." if loose else f"{hold}."

    def friction_words(self) -> list[str]:
        """What friction does, one sentence or none."""
        least, (first, second) = self.sticking_friction, clamp_names(self.fixture)
        if least is None:
            return []
        ratio = self.pair.working_ratio
        together = f"{second} with {ratio:{'.2f' if ratio >= SMALL else '.2g'}} times the force of {first}"
        if least == inf:
            return [
                f"Tightened together, {together}, both bring home a part a little off a locator, whatever the friction."
            ]
        friction = f"{floor(least * 10.0**DECIMALS) / 10.0**DECIMALS:.{DECIMALS}f}"
        steel = "dry steel has 0.1 to 0.2"
        if least >= DRY_STEEL:
            return [
                f"Tightened together, {together}, both bring home a part a little off a locator while friction is below "
                f"{friction}; {steel}."
            ]
        return [
            f"From a friction of {friction} on the part can stay a little off a locator also under both clamps, {together}; "
            f"{steel}, so tap it home meanwhile."
        ]

    def after_words(self, text: Callable[[float], str]) -> str:
        """What to look at in the end."""
        settings = settings_of(self.fixture, self.toolkit)
        names = clamp_names(self.fixture)
        lengths = [f"a {one.name} of {text(one.length)} at {name}" for one, name in zip(settings, names, strict=True)]
        return f"Try the paper again. Right is {listed(lengths)}; if not, the part lies against them another way."


def by_hand(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> ByHand:
    """How to put a part into the two clamps of a fixture, and what is known of it there."""
    from workhold.seating.sticking_friction import sticking_friction_of_two

    friction = None if toolkit.has_flats else sticking_friction_of_two(fixture, workpiece, toolkit)
    return ByHand(fixture, toolkit, friction)


def place_of(peg: Peg, toolkit: Toolkit) -> str:
    """Where a locator is, or an end of the contact with a wall."""
    if not peg.is_on_wall or toolkit.wall is None:
        return peg.hole
    return f"the {toolkit.wall.noun} on the {peg.hole.rpartition(' ')[2]}"


def places_of(pegs: Sequence[Peg], toolkit: Toolkit) -> list[str]:
    """Where some locators are; both ends of the contact with a wall are the wall."""
    walls = sum(peg.is_on_wall for peg in pegs)
    if toolkit.wall is None or walls < 2:
        return [place_of(peg, toolkit) for peg in pegs]
    return [f"the {toolkit.wall.noun}", *(peg.hole for peg in pegs if not peg.is_on_wall)]
