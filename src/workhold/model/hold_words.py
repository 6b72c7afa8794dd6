"""Words about a part between flat jaws: how to set it up, the jaw force it needs, and warnings."""

from __future__ import annotations

from collections.abc import Iterator

from workhold.model.fixture import Fixture
from workhold.model.friction import COEFFICIENTS, find_friction_coefficient
from workhold.model.jaw_hold import JawHold, JawPatch
from workhold.model.query import Query
from workhold.model.raw_block import measure_jaws_over_part
from workhold.model.shown import bound_placed_part
from workhold.units import Unit

__all__ = [
    "describe_coefficients",
    "describe_parallel_places",
    "describe_touched_faces",
    "describe_touched_sides",
    "format_set_force",
    "format_short_length",
    "list_jaw_cautions",
    "list_hold_reasons",
    "round_force_up",
    "write_setup_sentences",
    "describe_work_stop",
    "write_warnings",
]

# mm. By less a part does not stand out of the jaws.
OVERHANG = 1e-3


def describe_touched_faces(patch: JawPatch) -> str:
    """Return a phrase that names the faces a jaw touches, or says that it touches corners only.

    >>> describe_touched_faces(JawPatch(((0, 5, 0, 9),), (3,))), describe_touched_faces(JawPatch(((0, 0, 0, 9),), (), True))
    ('face 3', 'a corner')
    """
    if not patch.segments:
        return "a corner" if len(patch.rectangles) == 1 else "corners"
    one = len(patch.segments) == 1
    return f"face{'' if one else 's'} {', '.join(map(str, patch.segments))}"


def describe_touched_sides(patch: JawPatch, query: Query, unit: Unit) -> str:
    """Return a phrase that names the faces a jaw touches; of a raw block also how long the side is."""
    words = describe_touched_faces(patch)
    if query.raw is None or len(patch.segments) != 1:
        return words
    x0, y0, x1, y1 = query.workpiece.bounds
    long = y1 - y0 if patch.segments[0] % 2 else x1 - x0
    return f"the {format_short_length(long, unit)} side ({words})"


def describe_work_stop(stop: str | None, offset: float, unit: Unit) -> str:
    """Return a phrase with the end of the jaws at which the work stop is, and its offset in mm if not 0.

    It is "" without a work stop.
    """
    if stop is None:
        return ""
    inward = ""
    if offset:
        inward = f", {format_short_length(abs(offset), unit)} {'inward' if offset > 0 else 'outward'}"
    return f"{stop} end of the jaws{inward}"


def describe_parallel_places(hold: JawHold, unit: Unit) -> str:
    """Return a phrase on the places of the parallels: beside the jaws, or their distances from them.

    >>> from workhold.units import MILLIMETRE
    >>> patch = JawPatch(((0, 5, 0, 9),), (3,))
    >>> hold = JawHold(20, None, patch, patch, 60, 5, True, parallel_offsets=(12, 0))
    >>> describe_parallel_places(hold, MILLIMETRE)
    'one 12 mm from the fixed jaw and one beside the moving jaw'
    """
    if not hold.has_moved_parallels:
        return "one beside each jaw"
    places = [
        f"one {f'{format_short_length(away, unit)} from' if away else 'beside'} the {jaw} jaw"
        for jaw, away in zip(("fixed", "moving"), hold.parallel_offsets, strict=True)
    ]
    return " and ".join(places)


def format_short_length(length: float, unit: Unit) -> str:
    """Return a length in mm as text with the unit's abbreviation, rounded to 4 decimals without trailing
    zeros.
    """
    return f"{round(length / unit.millimetres, 4):g} {unit.abbreviation}"


def round_force_up(force: float) -> float:
    """Return a force in N rounded up to two significant digits; 0.0 for a force that is not positive."""
    if force <= 0:
        return 0.0
    step = 10.0 ** (len(str(int(force))) - 2)
    return -(-force // step) * step


def format_set_force(force: float, unit: Unit) -> str:
    """Return a jaw force in N as text in the unit's force unit, first rounded up to two significant digits of
    newtons.

    >>> from workhold.units import MILLIMETRE
    >>> format_set_force(3432.8, MILLIMETRE)
    '3500 N'
    """
    return unit.format_force(round_force_up(force))


def write_setup_sentences(fixture: Fixture, query: Query, unit: Unit) -> Iterator[str]:
    """Yield the steps to set up a fixture between flat jaws,
    one sentence each without the full stop, in their order.
    """
    hold, jaws = fixture.hold, query.toolkit.flat_jaws
    assert isinstance(hold, JawHold) and jaws is not None
    held = "part" if query.raw is None else "raw block"
    if hold.parallels:
        yield (
            f"Take the parallels of {format_short_length(hold.parallels, unit)}, {describe_parallel_places(hold, unit)}"
        )
    else:
        yield f"No parallels: the {held} lies on the bed of the vise"
    yield f"Open the jaws a little more than {unit.format_length(hold.opening)}"
    turned = "as drawn"
    if abs(fixture.pose.written_deg) > 1e-9:
        turned = f"turned by {round(fixture.pose.written_deg, 3):g}°"
    fixed, moving = (describe_touched_sides(patch, query, unit) for patch in (hold.fixed, hold.moving))
    yield f"Put the {held} in {turned}, {fixed} flush on the fixed jaw; the moving jaw presses {moving}"
    start = min(hold.fixed.ends[0], hold.moving.ends[0])
    where = f"what is gripped begins {unit.format_length(start)} from the left end of the jaws"
    extent = bound_placed_part(query.workpiece, fixture.pose)
    for end, beyond in (("left", -extent.x0), ("right", extent.x1 - jaws.width)):
        if beyond > OVERHANG:
            where = f"{where}, and it stands out {unit.format_length(beyond)} beyond their {end} end"
    if hold.stop is None:
        yield f"Put it in the middle of the jaws, as there is no stop: {where}"
    else:
        yield f"Push it against the work stop, {describe_work_stop(hold.stop, jaws.stop_offset, unit)}: {where}"
    needed = hold.clamp_needed
    if needed is not None:
        torque = jaws.compute_torque(round_force_up(needed))
        on_screw = "" if torque is None else f", about {unit.format_moment(torque * 1000.0)} on the screw"
        apart = f"they stand {unit.format_length(hold.opening)} apart"
        yield f"Close the jaws with {format_set_force(needed, unit)} or more{on_screw}; {apart}"
    else:
        yield f"Close the jaws; they stand {unit.format_length(hold.opening)} apart"


def describe_coefficients(query: Query) -> str:
    """Return a sentence on the friction coefficients and the safety factor that forces are stated with, and
    their sources.
    """
    value, usual = find_friction_coefficient(query.friction, "jaw"), COEFFICIENTS["jaw"]
    is_given = "jaw" in dict(query.friction or ())
    source = "as given" if is_given else f"{usual.between}, {usual.source}"
    factor = "as given" if query.safety is not None else "as usual"
    return f"Friction of the jaws {value:g} ({source}); safety factor {query.safety_factor:g} ({factor})."


def list_hold_reasons(fixture: Fixture, unit: Unit) -> list[str]:
    """Return phrases on the figures that a hold is ranked by: angle, grip and area, jaw force needed, height
    above the jaws.
    """
    hold = fixture.hold
    assert isinstance(hold, JawHold)
    turn = fixture.pose.written_deg
    square = abs((turn + 45.0) % 90.0 - 45.0) < 1e-6
    angle = "as drawn" if abs(turn) < 1e-6 else f"turned by {round(turn, 3):g}°"
    words = [angle if square else f"{angle}, not square to the drawing"]
    decimals = 0 if unit.millimetres == 1.0 else 2
    area = f"{hold.contact_area / unit.millimetres**2:,.{decimals}f} {unit.abbreviation}²"
    words.append(
        f"both jaws grip {format_short_length(hold.grip, unit)}, {area}"
        if hold.contact_area
        else "gripped along a line"
    )
    if hold.clamp_needed is not None:
        words.append(f"asks for a jaw force of {unit.format_force(hold.clamp_needed)}")
    query = None if fixture.listed is None else fixture.listed.result.query
    jaws = None if query is None else query.toolkit.flat_jaws
    if query is not None and query.raw is not None and jaws is not None and jaws.height is not None:
        over = measure_jaws_over_part(hold, query.raw, jaws)
        reach = f"reach {format_short_length(over, unit)} over the part's lower side"
        words.append(f"the jaws {reach if over else 'stay below the part'}")
    if hold.above:
        words.append(f"{format_short_length(hold.above, unit)} above the jaws")
    return words


def write_warnings(hold: JawHold) -> list[str]:
    """Return the warnings of a hold as sentences, with a capital and a full stop."""
    return [f"{words[:1].upper()}{words[1:]}." for words in hold.warnings]


def list_jaw_cautions(hold: JawHold) -> list[tuple[str, str]]:
    """Return a pair (kind, sentence) for each warning of a hold.

    All have the same kind: "unfit" where a jaw touches corners only or cannot press all over, else "load".
    """
    kind = "unfit" if hold.is_unfit or not hold.full_contact else "load"
    return [(kind, sentence) for sentence in write_warnings(hold)]
