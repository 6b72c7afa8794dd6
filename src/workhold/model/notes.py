"""The remarks that a result may carry for its user, one sentence each.

They follow from the numbers of a result, so that whoever has the numbers can tell which remarks there must be.
"""

from __future__ import annotations

from workhold.fixels.toolkit import Wording

__all__ = [
    "best_note",
    "by_hand_note",
    "cut_note",
    "fitted_note",
    "kept_note",
    "no_fixture_notes",
    "no_pair_note",
    "no_place_note",
    "seated_note",
    "stopped_note",
    "undecided_note",
]


def no_fixture_notes(wording: Wording) -> tuple[str, ...]:
    """Why a search finds no fixture: all normals meet, no pegs of one carrier touch, no four touch, no four hold; or what
    the toolkit has to say instead."""
    return wording.reasons or (
        "Every face is an arc about one centre, so the forces of all pegs meet in that point and nothing keeps the part "
        "from turning.",
        f"No {wording.two} can touch the part together: the pitch is too large for it.",
        f"No {wording.four} can touch the part at the same time inside their faces.",
        f"Four pegs can touch the part at the same time, but no such set {wording.rules}.",
    )


def no_place_note(verified: int, wording: Wording) -> str:
    """Why a search finds no fixture though so many candidates are proven to hold the part."""
    return f"{verified} {wording.sets} would hold the part, but none of them can stand in {wording.within}."


def no_pair_note(seats: int, contacts: int) -> str:
    """Why no two clamps hold the part, at so many seats with so many clamps."""
    if contacts == 0:
        return "No three locators and a clamp can touch the part at the same time inside their faces."
    if seats == 0:
        return (
            "Three locators and a clamp can touch the part, but there is no place for the second clamp that is needed."
        )
    return f"No two clamps press the part against all three locators at any of the {seats} seats found."


def best_note(best: int) -> str:
    """Of a search for so many, the best, that left others out."""
    return f"Only the best {best} were sought, so how many fixtures there are in all was not counted."


def cut_note(found: int, listed: int) -> str:
    """Of a search that was stopped while its fixtures were put in order or written."""
    return f"Stopped with {found:,} fixtures found: the best {listed:,} of them are listed; more would have taken long."


def undecided_note(count: int) -> str:
    """Of a search that left so many candidates undecided."""
    some = "1 candidate is undecided" if count == 1 else f"{count} candidates are undecided"
    return f"{some}: it cannot be shown whether they are fixtures; the result's proof names them with the reason."


def fitted_note(departure: float) -> str:
    """Of a part whose outline as read is so far, in mm, from the drawn one at most."""
    return (
        f"All that is claimed, completeness too, holds for the outline of lines and arcs, which is up to {departure:.2g} mm "
        "off the drawn one."
    )


def kept_note(found: int, kept: int) -> str:
    """Of a server that keeps only some of the fixtures found, the best."""
    return f"{found:,} fixtures were found; this server keeps the best {kept:,} of them."


def seated_note(looked_at: int, kept: int) -> str:
    """Of a search that lists only fixtures whose seating is as asked: of so many looked at so many are."""
    return (
        f"The seating of the first {looked_at:,} fixtures was worked out: {kept:,} of them are as asked, and no other is "
        "listed. Of fixtures beyond these nothing is known, and some may be as asked: look at more of them to see."
    )


def by_hand_note() -> str:
    """Of a search that asks for seating with two clamps, of which there is none to order fixtures by."""
    return (
        "With two clamps the part is pushed against its locators by hand, so fixtures are in the same order as without "
        "seating. How to put the part in is told of each fixture."
    )


def stopped_note(seconds: float) -> str:
    """Of a server that ended a search after so many seconds."""
    end = f"The search was stopped after {seconds:g} s, the longest this server allows"
    return f"{end}: this is a part of the fixtures only."
