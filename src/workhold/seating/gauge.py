"""The reading on what moves when the part rests in a seat: an opening, a stroke, or where the tip is."""

from __future__ import annotations

from attrs import evolve, frozen

from workhold.fixels.toolkit import Carrier, Toolkit
from workhold.model.fixture import Fixture, Peg
from workhold.model.setting import Setting, settings_of

__all__ = ["Gauge", "OpeningWords"]


@frozen
class OpeningWords:
    """Words for opening and closing what moves.

    Parameters
    ----------
    open, close : so that the part can be put in, and so that it is held.
    done, far : that it is open, and how far.
    hold, whose : how it holds the part, and whose way is meant.
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
    """The measure by which a fixture's seats are distinguished.

    Parameters
    ----------
    fixture, toolkit : whose.
    """

    fixture: Fixture
    toolkit: Toolkit

    @property
    def carrier(self) -> Carrier:
        """What moves."""
        carriers = (self.toolkit.carrier(peg.carrier) for peg in self.fixture.pegs)
        return next(carrier for carrier in carriers if carrier.travel is not None)

    @property
    def setting(self) -> Setting:
        """What is read in the fixture's own pose."""
        return settings_of(self.fixture, self.toolkit)[0]

    @property
    def ways(self) -> OpeningWords:
        """Words for opening and closing what moves."""
        return VISE[self.toolkit.clamping] if self.carrier.on is None else CLAMP

    @property
    def grows(self) -> bool:
        """Whether more is read as what moves is opened: a stroke gets less."""
        return self.at(self.fixture.jaw_separation + self.toolkit.clamping) > self.setting.length

    def pegs(self, travelled: float) -> tuple[Peg, ...]:
        """The pegs, with what moves elsewhere on its way.

        Parameters
        ----------
        travelled : how far it has gone, in mm, such as the jaw separation.
        """
        moving = self.carrier
        assert moving.travel is not None
        (x, y), by = moving.travel.unit, travelled - self.fixture.jaw_separation
        return tuple(
            evolve(peg, x=peg.x + by * x, y=peg.y + by * y) if peg.carrier == moving.name else peg
            for peg in self.fixture.pegs
        )

    def at(self, travelled: float) -> float:
        """What is read there, in mm.

        Examples
        --------
        >>> from workhold import Plate
        >>> from workhold.model.fixture import Pose
        >>> plate, tip = Plate(pitch=20, peg_radius=3, travel=(10, 30)), Peg("clamp -x", 4, 1, 66.0, 20.0, 2, 1.0)
        >>> fixture = Fixture("clamp", (tip,), Pose(0, 0, 0), -14.0, {}, "-x")
        >>> Gauge(fixture, plate).at(-12.5)
        12.5
        """
        moved = evolve(self.fixture, pegs=self.pegs(travelled), jaw_separation=travelled)
        return settings_of(moved, self.toolkit)[0].length
