"""The set-ups of a family in a plain vise: parallels, and where the work stop is.

A set-up of flat jaws has no pegs. What is changed from one to the next is the pair of parallels, and the work stop:
the end of the jaws at which it stands, and how far its tip is from the fixed jaw. One stop serves several parts only
if its tip meets a face of each. So the places across the jaws at which a part can be stopped are a range, and places
of the tip to try are the ends of the ranges of all parts.

Lengths are in mm in the frame of the vise: x along the jaws from their left end, y from the fixed jaw.
"""

from __future__ import annotations

from collections.abc import Iterable

from attrs import frozen

from workhold.fixels.jaw_pair import JawPair
from workhold.fixels.toolkit import Toolkit
from workhold.model.hold_words import describe_work_stop, format_short_length
from workhold.model.jaw_hold import JawHold
from workhold.model.pose import Pose
from workhold.model.query import Query
from workhold.model.vise_bodies import find_stop_stretch, list_vise_bodies
from workhold.statics.jaw_clearance import find_tool_in_the_way
from workhold.units import Unit

__all__ = [
    "JawSetUp",
    "StopRange",
    "choose_stop_level",
    "describe_changes",
    "describe_jaw_setup",
    "is_stop_clear",
    "list_changed_places",
    "measure_stop_range",
]

# Of the width of a work stop's tip, how much of it on each side of its middle may miss the part.
TIP_SHARE = 0.25
# Ends of the jaws by their number in a pattern; None without a work stop.
STOPS = (None, "left", "right")
# Steps in a millimetre of lengths in a pattern.
STEPS = 1000


@frozen
class StopRange:
    """The range of y, in thousandths of a mm, in which the middle of a work stop's tip stops a part well.

    Parameters
    ----------
    low, high : its ends.
    own : where the tip meets the middle of the part's face.
    """

    low: int
    high: int
    own: int

    def holds(self, level: int) -> bool:
        """Return whether a place of the tip, in thousandths of a mm, lies in the range."""
        return self.low <= level <= self.high


def measure_stop_range(query: Query, jaws: JawPair, hold: JawHold, pose: Pose) -> StopRange:
    """Return where across the jaws a work stop's tip stops a part.

    The middle half of the tip meets the part's face there, and the tip stays between the jaws if it has room. It is
    the range of the middle of the face alone where the tip is wider than the opening.
    """
    low, high = find_stop_stretch(query.workpiece, jaws, hold, pose)
    own, half, spare = (low + high) / 2, jaws.stop_width / 2, TIP_SHARE * jaws.stop_width
    least = min(max(low - spare, half), own)
    most = max(min(high + spare, hold.opening - half), own)
    return StopRange(*(round(STEPS * value) for value in (least, most, own)))


def is_stop_clear(query: Query, hold: JawHold, pose: Pose, level: float) -> bool:
    """Return whether the query's program keeps clear of the vise with the work stop's tip at y = ``level``, in mm.

    True without a program.
    """
    jaws = query.toolkit.flat_jaws
    if query.program is None or jaws is None:
        return True
    bodies = list_vise_bodies(jaws, hold, query.part_height, level)
    return find_tool_in_the_way(query.program, bodies, pose) is None


@frozen
class JawSetUp:
    """A set-up of a vise with two flat jaws.

    Parameters
    ----------
    parallels : height of the parallels in mm; 0 without parallels, on the bed.
    stop : end of the jaws at which the work stop is, "left" or "right"; None without a stop.
    place : x in mm at which the stop touches parts; 0 without one.
    level : y in mm of the middle of its tip; 0 without one.
    """

    parallels: float
    stop: str | None = None
    place: float = 0.0
    level: float = 0.0

    @property
    def words(self) -> tuple[int, int, int, int]:
        """The set-up as whole numbers, equal for equal set-ups; they sort by parallels, stop and its tip."""
        return (
            round(STEPS * self.parallels),
            STOPS.index(self.stop),
            round(STEPS * self.place),
            round(STEPS * self.level),
        )

    @classmethod
    def from_words(cls, words: Iterable[int]) -> JawSetUp:
        """Return the set-up of whole numbers, the first of which are those of :attr:`words`."""
        parallels, stop, place, level, *_ = words
        return cls(parallels / STEPS, STOPS[stop], place / STEPS, level / STEPS)


def describe_jaw_setup(setup: JawSetUp, toolkit: Toolkit, unit: Unit) -> str:
    """Return a phrase that names the parallels, and where the work stop is."""
    on = (
        f"parallels of {format_short_length(setup.parallels, unit)}"
        if setup.parallels
        else "no parallels, on the bed"
    )
    jaws = toolkit.flat_jaws
    if setup.stop is None or jaws is None:
        return on
    end = describe_work_stop(setup.stop, jaws.stop_offset, unit)
    return f"{on}; stop: {end}, its tip {format_short_length(setup.level, unit)} from the fixed jaw"


def describe_changes(setup: JawSetUp, before: JawSetUp | None) -> str:
    """Return a phrase on what is changed after the set-up ``before``.

    >>> describe_changes(JawSetUp(25, "left", 0, 15), JawSetUp(20, "left", 0, 15))
    'change the parallels, the stop stays'
    """
    if before is None:
        return "the first"
    has_stop = setup.stop is not None or before.stop is not None
    stays = setup.words[1:] == before.words[1:]
    parallels = "the parallels stay" if setup.parallels == before.parallels else "change the parallels"
    if not has_stop:
        return parallels
    if stays:
        return f"{parallels}, the stop stays"
    return (
        "move the stop, the parallels stay" if parallels.endswith("stay") else f"{parallels}, move the stop"
    )


def list_changed_places(setup: JawSetUp) -> list[tuple[int, int, int]]:
    """Return what stands in a set-up as places that a plan counts: the parallels, and the work stop.

    A set-up needs as many changes after another as it has entries that the other has not.
    """
    parallels, stop, place, level = setup.words
    return [(0, parallels, 0), (1, 2 * place + (stop == STOPS.index("right")), level if stop else -1)]


def choose_stop_level(
    ranges: Iterable[StopRange], tried: float, parts: Iterable[tuple[Query, JawHold, Pose]]
) -> float | None:
    """Return y in mm for the tip of a work stop that serves several parts; None where none is found.

    It is the middle of what their ranges have in common, to a whole millimetre if possible, or else ``tried``: the
    first of these at which the programs of all parts are clear of the vise.
    """
    known, held = list(ranges), list(parts)
    low, high = max(one.low for one in known), min(one.high for one in known)
    middle = (low + high) / 2 / STEPS
    for level in (float(round(middle)), round(middle, 3), tried):
        inside = low <= round(STEPS * level) <= high
        if inside and all(is_stop_clear(query, hold, pose, level) for query, hold, pose in held):
            return level
    return None
