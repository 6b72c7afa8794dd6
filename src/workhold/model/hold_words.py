"""What is said of a part between flat jaws: how to set it up, what it asks for, and what to beware of."""

from __future__ import annotations

from collections.abc import Iterator

from workhold.model.fixture import Fixture
from workhold.model.friction import COEFFICIENTS, find_friction_coefficient
from workhold.model.jaw_hold import JawHold, Patch
from workhold.model.query import Query
from workhold.units import Unit

__all__ = [
    "describe_coefficients",
    "describe_touched_faces",
    "force_words",
    "hold_cautions",
    "hold_reasons",
    "set_force",
    "write_setup_sentences",
    "describe_work_stop",
    "write_warnings",
]


def describe_touched_faces(patch: Patch) -> str:
    """What a jaw touches, in a few words.

    >>> describe_touched_faces(Patch(((0, 5, 0, 9),), (3,))), describe_touched_faces(Patch(((0, 0, 0, 9),), (), True))
    ('face 3', 'a corner')
    """
    if not patch.segments:
        return "a corner" if len(patch.rectangles) == 1 else "corners"
    one = len(patch.segments) == 1
    return f"face{'' if one else 's'} {', '.join(map(str, patch.segments))}"


def describe_work_stop(hold: JawHold, offset: float, unit: Unit) -> str:
    """Where the work stop is; empty without one."""
    if hold.stop is None:
        return ""
    inward = ""
    if offset:
        inward = f", {short(abs(offset), unit)} {'inward' if offset > 0 else 'outward'}"
    return f"{hold.stop} end of the jaws{inward}"


def short(length: float, unit: Unit) -> str:
    """A length with as few decimals as it has."""
    return f"{round(length / unit.millimetres, 4):g} {unit.abbreviation}"


def set_force(force: float) -> float:
    """A jaw force in N rounded up to two digits, as somebody would set it."""
    if force <= 0:
        return 0.0
    step = 10.0 ** (len(str(int(force))) - 2)
    return -(-force // step) * step


def force_words(force: float, unit: Unit) -> str:
    """A jaw force rounded up to two digits, as somebody would set it.

    >>> from workhold.units import MILLIMETRE
    >>> force_words(3432.8, MILLIMETRE)
    '3500 N'
    """
    return unit.format_force(set_force(force))


def write_setup_sentences(fixture: Fixture, query: Query, unit: Unit) -> Iterator[str]:
    """How to set it up, a sentence for each thing to do, in their order."""
    hold, jaws = fixture.hold, query.toolkit.flat_jaws
    assert isinstance(hold, JawHold) and jaws is not None
    if hold.parallels:
        yield f"Take the parallels of {short(hold.parallels, unit)}, one beside each jaw"
    else:
        yield "No parallels: the part lies on the bed of the vise"
    yield f"Open the jaws a little more than {unit.format_length(hold.opening)}"
    turned = "as drawn"
    if abs(fixture.pose.written_deg) > 1e-9:
        turned = f"turned by {round(fixture.pose.written_deg, 3):g}°"
    yield (
        f"Put the part in {turned}, {describe_touched_faces(hold.fixed)} flush on the fixed jaw; the moving jaw presses "
        f"{describe_touched_faces(hold.moving)}"
    )
    start = min(hold.fixed.ends[0], hold.moving.ends[0])
    where = f"what is gripped begins {unit.format_length(start)} from the left end of the jaws"
    if hold.stop is None:
        yield f"Put it in the middle of the jaws, as there is no stop: {where}"
    else:
        yield f"Push it against the work stop, {describe_work_stop(hold, jaws.stop_offset, unit)}: {where}"
    needed = hold.clamp_needed
    if needed is not None:
        torque = jaws.compute_torque(set_force(needed))
        on_screw = "" if torque is None else f", about {unit.format_moment(torque * 1000.0)} on the screw"
        apart = f"they stand {unit.format_length(hold.opening)} apart"
        yield f"Close the jaws with {force_words(needed, unit)} or more{on_screw}; {apart}"
    else:
        yield f"Close the jaws; they stand {unit.format_length(hold.opening)} apart"


def describe_coefficients(query: Query) -> str:
    """With which friction and safety forces are stated, and where these are from."""
    value, usual = find_friction_coefficient(query.friction, "jaw"), COEFFICIENTS["jaw"]
    is_given = "jaw" in dict(query.friction or ())
    source = "as given" if is_given else f"{usual.between}, {usual.source}"
    factor = "as given" if query.safety is not None else "as usual"
    return f"Friction of the jaws {value:g} ({source}); safety factor {query.safety_factor:g} ({factor})."


def hold_reasons(fixture: Fixture, unit: Unit) -> list[str]:
    """What speaks for a hold, in the order in which holds are ranked."""
    hold = fixture.hold
    assert isinstance(hold, JawHold)
    turn = fixture.pose.written_deg
    square = abs((turn + 45.0) % 90.0 - 45.0) < 1e-6
    angle = "as drawn" if abs(turn) < 1e-6 else f"turned by {round(turn, 3):g}°"
    words = [angle if square else f"{angle}, not square to the drawing"]
    decimals = 0 if unit.millimetres == 1.0 else 2
    area = f"{hold.contact_area / unit.millimetres**2:,.{decimals}f} {unit.abbreviation}²"
    words.append(
        f"both jaws grip {short(hold.grip, unit)}, {area}" if hold.contact_area else "gripped along a line"
    )
    if hold.clamp_needed is not None:
        words.append(f"asks for a jaw force of {unit.format_force(hold.clamp_needed)}")
    if hold.above:
        words.append(f"{short(hold.above, unit)} above the jaws")
    return words


def write_warnings(hold: JawHold) -> list[str]:
    """What to beware of, as sentences."""
    return [f"{words[:1].upper()}{words[1:]}." for words in hold.warnings]


def hold_cautions(hold: JawHold) -> list[tuple[str, str]]:
    """What a sheet says to beware of, each with its kind."""
    kind = "unfit" if hold.is_unfit or not hold.full_contact else "load"
    return [(kind, sentence) for sentence in write_warnings(hold)]
