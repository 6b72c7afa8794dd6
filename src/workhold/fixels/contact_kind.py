"""The kinds of contact that hold a part: round pins, pins with a flat, a straight wall, and the tips of clamps.

Reference: R. C. Brost and K. Y. Goldberg, *A complete algorithm for designing planar fixtures using modular
components*, IEEE Transactions on Robotics and Automation 12 (1996), who call such elements of a fixture fixels.
"""

from __future__ import annotations

from typing import Literal

from attrs import frozen

__all__ = ["CLAMP_TIP", "FLAT_PIN", "ROUND_PIN", "WALL_END", "ContactKind"]


@frozen
class ContactKind:
    """What a contact is to whoever draws it, writes it, or sets it up.

    Parameters
    ----------
    name : in a few words.
    role : what it does for the part: it locates it, or it clamps it.
    is_placed : whether it is a thing by itself that somebody puts in a place; the end of a contact with a wall is not.
    is_turned : whether it matters which way it is turned in its hole.
    """

    name: str
    role: Literal["locator", "clamp"]
    is_placed: bool = True
    is_turned: bool = False


ROUND_PIN = ContactKind("round pin", "locator")
FLAT_PIN = ContactKind("flat pin", "locator", is_turned=True)
WALL_END = ContactKind("wall", "locator", is_placed=False)
CLAMP_TIP = ContactKind("clamp tip", "clamp")
