"""Sentences on what a fixture's seating means for the machinist, for the sheet and the page alike."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from math import asin, ceil, degrees, floor, inf, log10

from attrs import frozen

from workhold.drawing.scene import LengthUnit
from workhold.fixels.carrier import Measure
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.seating import CLOSE_READING, DRY_STEEL, Seat, Seating
from workhold.model.workpiece import Workpiece
from workhold.seating.clamping import Gauge
from workhold.seating.part_features import Silhouette

__all__ = ["SeatingSentences", "round_down_in_words", "capitalize_sentence"]

# A larger turn has no bound, in degrees.
ANY_TURN = 180.0
# Where what moves ends, by what is set on it.
CLAMP_STOPS, JAWS_STOP = "the clamp goes as far as it can", "the jaws meet their stop"
STOPPED: Mapping[Measure, str] = {"opening": JAWS_STOP, "stroke": CLAMP_STOPS, "tip": CLAMP_STOPS}


def round_down_in_words(value: float, digits: int = 2) -> str:
    """Return a number as text, rounded down to ``digits`` significant digits, to be used as an upper bound.

    A negative number gives "0".

    >>> [round_down_in_words(value) for value in (0.4475, 12.99, 123.4, 0.02999, 0.0)]
    ['0.44', '12', '120', '0.029', '0']
    """
    if value <= 0.0:
        return "0"
    places = digits - 1 - floor(log10(value))
    step = 10.0**-places
    return f"{floor(value / step * (1.0 + 1e-12)) * step:.{max(places, 0)}f}"


@frozen(slots=False)
class SeatingSentences:
    """Sentences on the seating of one fixture.

    Parameters
    ----------
    seating : how the part can come to rest on its pegs.
    lengths : how lengths are written.
    """

    seating: Seating
    fixture: Fixture
    toolkit: Toolkit
    lengths: LengthUnit

    @property
    def gauge(self) -> Gauge:
        """The gauge whose readings distinguish the seats."""
        return Gauge(self.fixture, self.toolkit)

    @property
    def sign(self) -> str:
        """The letter of the length that is read, such as "S"."""
        return self.gauge.setting.sign

    def compute_reading(self, seat: Seat) -> float:
        """Return the length in mm that the machinist reads when the part is in a seat."""
        return self.gauge.compute_reading(seat.jaw_separation)

    def format_reading(self, length: float) -> str:
        """Return a reading in mm as text, such as "S = 24.125 mm"."""
        return f"{self.sign} = {self.lengths.format_length(length)}"

    def format_upper_limit(self, length: float) -> str:
        """Return a length in mm that must not be exceeded as text with the unit's sign, rounded down."""
        unit = self.lengths.unit
        return f"{round_down_in_words(length / unit.millimetres)} {unit.abbreviation}"

    def compute_rounded_reading(self, opened: float) -> float:
        """Return the reading in mm at which the jaws are opened by ``opened`` mm from the fixture's own seat.

        It is rounded to the displayed decimals, toward less opening.
        """
        step = self.lengths.unit.millimetres * 10.0**-self.lengths.decimals
        reading = self.gauge.compute_reading(self.own.jaw_separation + self.seating.clamping * opened) / step
        return (floor(reading) if self.gauge.grows else ceil(reading)) * step

    @cached_property
    def own(self) -> Seat:
        """The seat in which the part lies as in the fixture."""
        return next(seat for seat in self.seating.seats if seat.is_own)

    @cached_property
    def wrong(self) -> list[Seat]:
        """The wrong seats within the opening of the query, sorted by the difference of their reading from the
        right one.
        """
        return sorted(
            self.seating.list_wrong_seats(),
            key=lambda seat: (abs(seat.difference), seat.mirrored, seat.pose.theta_deg),
        )

    @property
    def alike(self) -> int:
        """The number of other seats in which the part covers the same area as in the fixture."""
        return sum(seat.same_place and not seat.is_own for seat in self.seating.seats)

    def compute_safe_start(self, workpiece: Workpiece) -> tuple[float, float] | None:
        """Return (shift in mm, turn in degrees): a part within both of its place certainly settles in its
        place.

        Returns None if no such bound is known. Half of ``seating.placing`` is the shift. The other half is 2
        R sin(turn / 2), with R the distance of the part's farthest point from its middle.
        """
        if self.seating.placing is None:
            return None
        half = self.seating.placing / 2.0
        arm = Silhouette.from_workpiece(workpiece).arm
        return half, min(2.0 * degrees(asin(min(half / (2.0 * arm), 1.0))), ANY_TURN)

    def describe_difference(self, seat: Seat) -> str:
        """Return a phrase on the difference of a seat's reading from the right one, such as "0.35 mm less",
        or "the same".
        """
        if abs(seat.difference) < 0.5 * 10.0**-self.lengths.decimals * self.lengths.unit.millimetres:
            return "the same"
        more = self.compute_reading(seat) > self.compute_reading(self.own)
        return f"{self.lengths.format_length(abs(seat.difference))} {'more' if more else 'less'}"

    def list_steps(self, workpiece: Workpiece) -> list[str]:
        """Return sentences, in the order of work: the opening, the place of the part, and the reading."""
        seating, right = self.seating, self.format_reading(self.compute_reading(self.own))
        ways = self.gauge.opening_words
        most, more = ("at most", "more") if self.gauge.grows else ("at least", "less")
        capture, room = seating.capture_opening, seating.drop_room
        widest = inf if seating.most is None else seating.most
        if seating.is_capture_unknown:
            steps = ["It is not known how far you may open: put the part in its place and hold it there."]
        elif capture is None or room is None:
            steps = [f"{ways.open} as far as you like: the part cannot get to another place on these pegs."]
        elif self.own.jaw_separation + self.seating.clamping * capture > widest:
            steps = [f"{ways.open} as far as possible: the part cannot get to another place on the way."]
        else:
            steps = [
                f"{ways.open} to {self.format_reading(self.compute_rounded_reading(capture))} {most}, "
                f"{self.format_upper_limit(capture)} from "
                f"where {ways.hold} the part. That leaves about {self.format_upper_limit(room)} of room at every peg."
            ]
        within = self.compute_safe_start(workpiece)
        if within is not None:
            shift, turn = within
            steps.append(
                f"Put the part in within {self.format_upper_limit(shift)} and {round_down_in_words(turn)}° of its "
                "place, as far as the pegs let it: from there it settles in its place."
            )
        steps.append(
            f"{ways.close.capitalize()}. The right reading is {right}. While the reading is {more}, "
            "the part is stuck short of its place: tap it home."
        )
        least = f"{seating.sticking_friction:.2f}"
        if seating.sticking_friction < DRY_STEEL:
            steps.append(
                f"The part can stick if the friction is {least} or more, and dry steel has 0.1 to 0.2: "
                "tap it home as you close."
            )
        return steps

    def describe_wrong_seats(self) -> list[str]:
        """Return sentences on the number of wrong seats, and on those that the reading does not reveal."""
        seating, reach = self.seating, ""
        if seating.opening is not None:
            reach = f", {self.gauge.opening_words.done.lower()} by no more than {self.format_upper_limit(seating.opening)},"
        wrong, over = self.wrong, sum(seat.mirrored for seat in self.wrong)
        turned = "" if not over else f", {f'{over} of them ' if over < len(wrong) else ''}turned over"
        places = "one wrong place" if len(wrong) == 1 else f"{len(wrong)} wrong places"
        words = [f"There is no wrong place in which the same pegs{reach} hold the part."]
        if wrong:
            hint = "look how the part lies, because the reading alone does not show it"
            if abs(wrong[0].difference) >= CLOSE_READING:
                hint = "the reading shows it"
            words = [f"The same pegs{reach} can hold the part in {places}{turned}: {hint}."]
        if self.alike:
            words.append(
                f"In {self.alike} more places it lies turned round or upside down and covers the right "
                "place all the same. No reading shows that: mark the part."
            )
        return [*words, *map(capitalize_sentence, seating.unsettled)]

    def describe_ending(self, ending: str, seat: Seat | None, travelled: float) -> str:
        """Return a sentence on how a simulated closing ended, with the reading.

        ``ending`` is one of ``seating.closing_simulation.ENDINGS``, ``seat`` is the seat reached (None for no
        seat), and ``travelled`` is the separation in mm at the end.
        """
        read, stop = (
            self.format_reading(self.gauge.compute_reading(travelled)),
            STOPPED[self.gauge.carrier.measure],
        )
        if seat is not None and ending == "right":
            return f"The part is in its place: {read}."
        if seat is not None and ending == "same place":
            way = "turned over" if seat.mirrored else "turned round"
            return (
                f"The part covers its place, but {way}: {read}. The reading does not show it: mark the part."
            )
        if seat is not None:
            unsure = {"loose": " that does not locate it", "unsettled": " that is not settled"}
            kind = unsure.get(seat.kind, "")
            off = self.describe_difference(seat)
            read_as = (
                "the same as in the right place" if off == "the same" else f"{off} than in the right place"
            )
            return f"The part comes to rest in a wrong place{kind}: {read}, {read_as}."
        return {
            "stop": f"The part lies loose beside the pegs: {stop}, {read}.",
            "outside": f"The part slips out: {stop}, {read}.",
            "elsewhere": f"The part comes to rest, but a nudge moves it on: {read}.",
        }.get(ending, f"The motion could not be followed to its end; the last reading is {read}.")

    def list_cautions(self) -> list[tuple[str, str]]:
        """Return cautions as (kind, sentence); the kind is "capture" or "reading"."""
        seating, found = self.seating, list[tuple[str, str]]()
        if seating.is_capture_unknown:
            words = "It is not known how far you may open: hold the part in its place while you close."
            found.append(("capture", words))
        elif seating.capture_opening is not None and seating.is_hardly_caught:
            words = (
                f"The part settles only from very close: {self.gauge.opening_words.done.lower()} by "
                f"{self.format_upper_limit(seating.capture_opening)} it may come to rest elsewhere. Hold it in its "
                "place while you close, and compare the reading."
            )
            found.append(("capture", words))
        if self.wrong and abs(self.wrong[0].difference) < CLOSE_READING:
            off = self.describe_difference(self.wrong[0])
            off = "no different" if off == "the same" else f"only {off}"
            words = f"In a wrong place the reading is {off}: compare the part with the picture."
            found.append(("reading", words))
        return found


def capitalize_sentence(words: str) -> str:
    """Return a text with its first letter capitalized."""
    return f"{words[:1].upper()}{words[1:]}"
