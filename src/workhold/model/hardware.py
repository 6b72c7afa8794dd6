"""What to take from the drawer for a set-up: pegs, clamps with their bolts, supports and walls, counted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import TypeVar

from attrs import frozen

from workhold.fixels.contacts import CLAMP_TIP, WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture

__all__ = ["HardwareItem", "hardware_of"]

Key = TypeVar("Key")


@frozen
class HardwareItem:
    """Things of one kind and size.

    Parameters
    ----------
    count : how many.
    name : what they are.
    diameter : in mm; None of what is not round.
    length : of pegs, height of supports, in mm; None where nobody knows or where there is none.
    note : what else to know, in a few words.
    """

    count: int
    name: str
    diameter: float | None
    length: float | None
    note: str = ""


def hardware_of(
    fixture: Fixture,
    toolkit: Toolkit,
    peg_length: float | None = None,
    supports: tuple[float, float | None] | None = None,
    top_tip: float | None = None,
) -> list[HardwareItem]:
    """What a set-up takes, in the order in which it is put together.

    Parameters
    ----------
    peg_length : in mm.
    supports : diameter and height in mm of three supports.
    top_tip : diameter in mm of the tip of a clamp on top.

    Examples
    --------
    >>> from workhold import Plate, Workpiece, design
    >>> part = Workpiece.from_points("bar", [(0, 0), (90, 0), (70, 40), (0, 50)])
    >>> plate = Plate(pitch=20, peg_radius=3, travel=(10, 60))
    >>> [(one.count, one.name) for one in hardware_of(design(part, plate, best=1)[0], plate)]
    [(3, 'locators'), (1, 'clamp'), (1, 'bolt for a clamp')]
    """
    items: list[HardwareItem] = []
    placed = [(toolkit.carrier(peg.carrier), peg) for peg in fixture.placed]
    pegs = [carrier for carrier, _ in placed if carrier.contact is not CLAMP_TIP]
    for (name, radius, flat), count in counted((c.peg, c.peg_radius, c.flat is not None) for c in pegs):
        note = "with a flat" if flat else ""
        items.append(HardwareItem(count, plural(name, count), 2 * radius or None, peg_length, note))
    if supports is not None:
        items.append(HardwareItem(3, "supports", *supports))
    clamps = [carrier for carrier, _ in placed if carrier.contact is CLAMP_TIP]
    for (name, radius), count in counted((c.noun, c.peg_radius) for c in clamps):
        items.append(
            HardwareItem(count, plural(name, count), 2 * radius or None, None, "diameter of the tip")
        )
    bolted = sum(all(carrier.counted) for carrier in clamps)
    if bolted:
        items.append(
            HardwareItem(
                bolted, f"{plural('bolt', bolted)} for {'a clamp' if bolted == 1 else 'clamps'}", None, None
            )
        )
    if top_tip is not None:
        items.append(HardwareItem(1, "clamp on top", top_tip, None, "diameter of the tip"))
    items += [
        HardwareItem(1, carrier.noun, None, None)
        for carrier in toolkit.carriers
        if carrier.contact is WALL_END
    ]
    return items


def counted(keys: Iterable[Key]) -> list[tuple[Key, int]]:
    """Different keys in the order in which they come first, and how many there are of each."""
    return list(Counter(keys).items())


def plural(noun: str, count: int) -> str:
    """A noun for a number of things."""
    return noun if count == 1 else f"{noun}s"
