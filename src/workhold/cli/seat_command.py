"""The command ``seat``: whether the part ends up in the pose of a fixture, and the other places where it can
rest.
"""

from __future__ import annotations

from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING

from attrs import frozen

from workhold.cli.commands import make_option, print_remark, spread_option_groups
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, read_rank, read_result_with_rank
from workhold.cli.outputs import FORCE, JSON, print_json, read_picture_path, write_picture
from workhold.cli.table import Table, print_tables
from workhold.cli.values import choose_printed_unit, read_choice, read_optional_positive_length, read_unit
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.model.seating import Seat, Seating
    from workhold.seating.clamping import Gauge

__all__ = ["describe_steps_by_hand", "seat", "tabulate_seats", "describe_seating"]

SIDES = ("both", "drawn", "turned-over")


@frozen
class SeatOptions:
    """The options that choose what is shown of a seating and where it is drawn, as typed."""

    side: str = make_option(
        None, "WORD", "Side of the part that may lie up: drawn, turned-over, or both.", default="both"
    )
    opening: str | None = make_option(
        None,
        "LENGTH",
        "Open the jaws, or draw the clamp back, by this much to put the part in; as far as "
        "possible if not given.",
    )
    draw: str | None = make_option(
        None, "FILE", "Draw the places in which the part can rest into this file, .svg or .png."
    )
    force: bool = FORCE
    unit: str | None = SHOWN_UNIT
    json_: bool = JSON


@frozen
class SeatTask:
    """A fixture whose seating is to be shown.

    Parameters
    ----------
    side, opened : limits on the seats shown, see :func:`list_shown_seats`.
    unit : of lengths shown.
    """

    result: Result
    rank: int
    side: str
    opened: float | None
    picture: Path | None
    unit: Unit
    as_json: bool

    @property
    def fixture(self) -> Fixture:
        """The fixture of the rank."""
        return self.result[self.rank - 1]

    @property
    def title(self) -> str:
        """Heading with rank, number of fixtures and part."""
        return f"Seating of fixture {self.rank} of {len(self.result)}: {self.result.workpiece.name}"

    @property
    def written(self) -> list[str]:
        """Paths of what is written: the picture, or none."""
        return [] if self.picture is None else [str(self.picture)]


@spread_option_groups
def seat(result_file: ResultArgument, number: RankArgument, *, words: SeatOptions) -> None:
    """Report whether the part ends up in the pose of fixture N when you tighten the vise or the clamp.

    The report says how far the jaws may be open when you let the part go, and how far the part may lie from
    its place. It lists the other places in which the part can come to rest, and what a caliper reads there.
    For two clamps it says how to put the part in by hand, and in which order to tighten them.

    Example: workhold seat part.json 1 --draw seats.svg
    """
    asked = parse(result_file, read_rank(number), words)
    if asked.result.toolkit.closes_at_once:
        report(asked, find_seating_of_fixture(asked))
    else:
        report_by_hand(asked)


def parse(result_file: str, rank: int, words: SeatOptions) -> SeatTask:
    """Return what was typed as a task, with the result read."""
    shown, side = read_unit(words.unit), read_choice("--side", words.side, SIDES)
    opened = read_optional_positive_length("--opening", words.opening, shown)
    picture = read_picture_path(words.draw, (result_file,), words.force)
    result = read_result_with_rank(result_file, rank)
    unit = choose_printed_unit(words.unit, result.toolkit)
    return SeatTask(result, rank, side, opened, picture, unit, words.json_)


def find_seating_of_fixture(asked: SeatTask) -> Seating:
    """Return the seating of the fixture, taken from the result if it is there, else computed."""
    result = asked.result
    known: Seating | None = asked.fixture.seating
    if known is not None:
        return known
    from workhold.cli.warming import compile_seating
    from workhold.seating.pattern import refuse_unseated
    from workhold.seating.solver import SeatingSolver

    refuse_unseated(result.toolkit)
    compile_seating(Event())
    return SeatingSolver(result.workpiece, result.toolkit).solve(asked.fixture)


def report(asked: SeatTask, seating: Seating) -> None:
    """Print how the part settles in its place and where else it can rest, and draw that if asked."""
    from workhold.seating.clamping import Gauge

    result, fixture, unit = asked.result, asked.fixture, asked.unit
    gauge, seats = Gauge(fixture, result.toolkit), list_shown_seats(seating, asked.side, asked.opened, result)
    if not asked.as_json:
        print_tables(
            asked.title,
            "",
            *describe_setting(seating, gauge, unit),
            "",
            *describe_wrong_seats(seating, seats, asked.opened, gauge, unit),
            tabulate_seats(seats, gauge, unit),
        )
    for words in seating.unsettled:
        print_remark(words)
    if asked.picture is not None:
        from workhold.drawing.seats import draw_seats

        held = (fixture, result.workpiece, result.toolkit)
        write_picture(asked.picture, draw_seats(seats, *held, title=f"Fixture {asked.rank}", unit=unit))
    if asked.as_json:
        print_json(rank=asked.rank, seating=seating.to_fields(), written=asked.written)
    else:
        print_tables(*(f"Drawn in {path}." for path in asked.written))


def report_by_hand(asked: SeatTask) -> None:
    """Print how to put in by hand a part that two clamps hold, and draw the fixture if asked."""
    from workhold.drawing.fixture_pictures import draw_fixture
    from workhold.seating.clamping import plan_hand_loading

    result, unit = asked.result, asked.unit
    held = (asked.fixture, result.workpiece, result.toolkit)
    if asked.picture is not None:
        write_picture(asked.picture, draw_fixture(*held, title=f"Fixture {asked.rank}", unit=unit))
    if asked.as_json:
        steps = plan_hand_loading(*held).to_fields(unit.format_length)
        print_json(rank=asked.rank, seating=None, by_hand=steps, written=asked.written)
        return
    print_tables(asked.title, *describe_steps_by_hand(asked.rank, result, unit))
    print_tables(*(f"Drawn in {path}." for path in asked.written))


def describe_steps_by_hand(rank: int, result: Result, unit: Unit) -> list[str]:
    """Return lines with the numbered steps to put in a part that two clamps hold."""
    from workhold.seating.clamping import WHY, plan_hand_loading

    steps = plan_hand_loading(result[rank - 1], result.workpiece, result.toolkit).list_steps(
        unit.format_length
    )
    return ["", WHY, "", *(f"{number}. {step}" for number, step in enumerate(steps, 1))]


def list_shown_seats(seating: Seating, side: str, opened: float | None, result: Result) -> list[Seat]:
    """Return the fixture's own seat, then the other seats that can be reached.

    ``side`` is "both", "drawn" or "turned-over"; ``opened`` is how far the jaws are opened in mm, None for no
    limit.
    """
    own = [one for one in seating.seats if one.is_own]
    rest = [
        one
        for one in seating.seats
        if not one.is_own and (side == "both" or one.mirrored == (side == "turned-over"))
    ]
    if opened is not None:
        rest = [one for one in rest if seating.clamping * one.difference < opened]
    most = result.toolkit.moving.travel.most if result.toolkit.moving.travel else None
    return own + [one for one in rest if most is None or one.jaw_separation <= most]


def describe_seating(fixture: Fixture, result: Result, unit: Unit) -> list[str]:
    """Return sentences on a fixture's seating: the length to set, the readings of a caliper, and warnings."""
    from workhold.seating.clamping import Gauge

    seating: Seating = fixture.seating
    gauge = Gauge(fixture, result.toolkit)
    beware = [f"Beware: {words}." for words in seating.warnings]
    seats = list_shown_seats(seating, SIDES[0], seating.opening, result)
    return [
        "",
        *describe_setting(seating, gauge, unit),
        *describe_wrong_seats(seating, seats, seating.opening, gauge, unit),
        *beware,
    ]


def describe_setting(seating: Seating, gauge: Gauge, unit: Unit) -> list[str]:
    """Return sentences on how far to open, what the caliper then reads, and how far the part may lie from its
    place.
    """
    from workhold.model.seating import DRY_STEEL

    setting, carrier, ways = gauge.setting, gauge.carrier, gauge.opening_words
    named = "" if setting.tip is None else f"a {setting.name} of "
    more, less = ("more", "less") if gauge.grows else ("less", "more")
    if seating.is_capture_unknown:
        words = [
            "It is not known how far you may open: put the part in its place, hold it there and "
            f"{ways.close}."
        ]
    elif seating.capture_opening is None:
        words = [f"However {ways.far}, the part cannot get to another place: put it in and {ways.close}."]
    else:
        wide = gauge.compute_reading(gauge.fixture.travel + seating.clamping * seating.capture_opening)
        words = [
            f"{ways.open} to {named}{less} than {unit.format_length(wide)}, which is "
            f"{unit.format_length(seating.capture_opening)} from where {ways.hold} the part. Put the part in "
            f"its place and {ways.close}: on the way it cannot get to another place."
        ]
    words.append(
        f"When the part is in its place, the {setting.name} is {unit.format_length(setting.length)}. While "
        f"it is {more}, the part is stuck short of its place."
    )
    if seating.drop_room is not None and not seating.is_capture_unknown:
        words.append(
            f"{ways.done} this far, there is about {unit.format_length(seating.drop_room)} of room at every "
            "peg at once."
        )
    if seating.cage is not None and seating.placing is not None:
        low, high = seating.cage.theta_deg
        shifts = (
            (seating.cage.x, seating.cage.y) if carrier.line == "row" else (seating.cage.y, seating.cage.x)
        )
        along, across = (" to ".join(unit.format_number(end) for end in ends) for ends in shifts)
        words += [
            f"The part may lie off its place by {low:.2f} to {high:.2f} degrees and by {along} "
            f"{unit.abbreviation} along the {ways.whose} way, {across} {unit.abbreviation} across it, "
            "as far as the pegs let it.",
            f"If every point of the part is nearer than {unit.format_length(seating.placing)} to its place, "
            "the part settles there.",
        ]
    tap = (
        "." if seating.sticking_friction >= DRY_STEEL else "; dry steel has 0.1 to 0.2, so tap the part home."
    )
    words.append(
        f"With a friction below {seating.sticking_friction:.3f} the part cannot stick near its place{tap}"
    )
    return words


def describe_wrong_seats(
    seating: Seating, seats: list[Seat], opened: float | None, gauge: Gauge, unit: Unit
) -> list[str]:
    """Return sentences on the wrong places in which the part can rest;
    ``opened`` is in mm, None without a limit.
    """
    wrong = [one for one in seats if one.is_wrong]
    alike = sum(one.same_place and not one.is_own for one in seats)
    words = []
    if seating.capture_opening is not None and opened is not None and opened < seating.capture_opening:
        far = f"{gauge.opening_words.done} by {unit.format_length(opened)}"
        words.append(
            f"{far}, a part let go near its place reaches no other place; a part let go elsewhere may."
        )
    if not wrong:
        words.append("There is no wrong place in which the part can come to rest.")
    else:
        near = min(wrong, key=lambda one: abs(one.difference))
        more = gauge.compute_reading(near.jaw_separation) > gauge.setting.length
        places = "one wrong place" if len(wrong) == 1 else f"{len(wrong)} wrong places"
        words.append(
            f"The part can come to rest in {places}; the reading nearest to the right one is "
            f"{unit.format_length(abs(near.difference))} {('more' if more else 'less')}."
        )
    if alike:
        words.append(
            f"In {alike} more places it covers the right place anyway, and no reading shows it: mark the part."
        )
    return words


# What stands for kinds of seats in the table.
KINDS = {
    "corner": "four pegs, one on a corner",
    "pocket": "a peg in a corner of the part",
    "curved": "held by the curvature of its faces",
    "loose": "not located",
    "unsettled": "not settled",
}


def tabulate_seats(seats: list[Seat], gauge: Gauge, unit: Unit) -> Table:
    """Return a table of seats: reading, difference, angle, side, depth and contacts."""
    of, fixture = unit.abbreviation, gauge.fixture
    kinds = {**KINDS, "fixture": gauge.toolkit.setup_words.resting}
    table = Table(
        ("seat", f">reads {of}", f">differs {of}", ">turned by", "side", f">held {of}", "how it lies")
    )
    for k, one in enumerate(seats):
        turned = 0.0 if one.is_own else (one.pose.theta_deg - fixture.pose.theta_deg + 180.0) % 360.0 - 180.0
        pegs = ", ".join(f"{fixture.pegs[c.peg].hole} {c.words}" for c in one.contacts)
        words = "right" if one.is_own else "same place" if one.same_place else kinds[one.kind]
        table.add_row(
            str(k + 1),
            unit.format_number(gauge.compute_reading(one.jaw_separation)),
            unit.format_number(gauge.compute_reading(one.jaw_separation) - gauge.setting.length),
            f"{one.pose.theta_deg:.1f}" if one.mirrored else f"{turned:.1f}",
            "over" if one.mirrored else "up",
            "-" if one.depth is None else unit.format_number(one.depth),
            f"{words}{': ' if pegs else ''}{pegs}",
        )
    return table
