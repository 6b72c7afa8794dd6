"""Figures of how far a fixture bends its part, as the engine ``bending`` computes them and result files keep them."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Any, Self

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.model.elastic_material import ElasticMaterial
from workhold.model.quality import Figure, make_figure_key
from workhold.units import Unit

__all__ = [
    "BENDING_COLUMNS",
    "BENDING_FIGURES",
    "BendingFigures",
    "BentPlace",
    "LargestStress",
    "PadsBelow",
    "describe_cut_faces",
    "find_bending_figure",
    "round_force",
]

BENDING_FIGURES = (
    Figure(
        "clamp_distortion",
        "mm",
        False,
        "How far clamping alone bends the faces to be cut, or any face: what springs back.",
    ),
    Figure("give", "mm", False, "How far the part gives at the cutter, or where a load acts."),
)
# The columns of tables, in mm, MPa and N.
BENDING_COLUMNS = (
    "clamp_distortion",
    "clamp_distortion_error",
    "give",
    "give_error",
    "clamp_stress",
    "clamp_stress_error",
    "bent_at_force",
)
# Digits of figures and decimals of places in mm in files: far finer than the error of any mesh.
DIGITS, DECIMALS = 6, 6


def find_bending_figure(name: str) -> Figure:
    """Return the figure with a name as a user writes it.

    Raises
    ------
    InputError
        For a name that is none.

    Examples
    --------
    >>> find_bending_figure("clamp-distortion").key
    'clamp_distortion'
    """
    key = make_figure_key(name)
    for figure in BENDING_FIGURES:
        if figure.key == key:
            return figure
    known = " or ".join(figure.option for figure in BENDING_FIGURES)
    raise InputError(f"{name[:40]!r} is not a figure of bending to rank by: choose {known}.")


def describe_cut_faces(faces: Sequence[int | str]) -> str | None:
    """Return the faces to be cut in words; None if there are none, which means all faces."""
    numbers = ", ".join(str(face) for face in faces if isinstance(face, int))
    level = [str(face) for face in faces if isinstance(face, str)]
    return ", ".join([*level, *([f"faces {numbers}"] if numbers else [])]) or None


def round_figure(value: float) -> float:
    """Return a figure with as many digits as files have."""
    return float(f"{value:.{DIGITS}g}") + 0.0


def round_force(value: float) -> float:
    """Return a force in N with as many digits as files have."""
    return float(f"{value:.12g}")


def round_place(at: Sequence[float]) -> tuple[float, ...]:
    """Return a point in mm with as many decimals as files have."""
    return tuple(round(float(value), DECIMALS) + 0.0 for value in at)


@frozen(eq=False)
class PadsBelow:
    """Three pads under the part and a clamp on top of it, in the part's coordinates.

    Parameters
    ----------
    pads : (3, 2) centres of the pads in mm.
    pad_radius : in mm.
    clamp : (3,) point in mm where the clamp's tip presses on the part.
    tip_radius : in mm.
    force : force of the clamp in N.
    """

    pads: NDArray[np.float64]
    pad_radius: float
    clamp: NDArray[np.float64]
    tip_radius: float
    force: float

    def to_data(self) -> dict[str, Any]:
        """Return plain data: lengths in mm, forces in N."""
        return {
            "pads": [list(round_place(pad)) for pad in self.pads.tolist()],
            "pad_radius": self.pad_radius,
            "clamp": list(round_place(self.clamp.tolist())),
            "tip_radius": self.tip_radius,
            "force": self.force,
        }


@frozen
class PlacedFigure:
    """A figure with its error estimate, and the place (x, y, z) in mm, in the part's coordinates, that it is of."""

    value: float
    error: float
    at: tuple[float, ...]

    @property
    def rounded(self) -> Self:
        """The same with six digits, and the place to 1e-6 mm, as files have it."""
        return evolve(
            self, value=round_figure(self.value), error=round_figure(self.error), at=round_place(self.at)
        )

    def to_rounded_data(self, unit: str) -> dict[str, Any]:
        """Return value, error, unit and place as plain data, rounded as files have them."""
        told = self.rounded
        return {"value": told.value, "error": told.error, "unit": unit, "at": list(told.at)}


@frozen
class BentPlace(PlacedFigure):
    """The largest movement of one kind (by clamping, or at the cutter), and where it is.

    Parameters
    ----------
    value : in mm, with elements of the third order.
    error : error estimate in mm: twice the change of the movement there from elements of the second order to
        the third.
    at : (x, y, z) in mm, in the part's coordinates.
    line, tool : line and tool of the program, where a cut causes the movement; None otherwise.
    load : number, from 1, of the load that causes the movement; None otherwise.
    """

    line: int | None = None
    tool: int | None = None
    load: int | None = None

    def describe(self, unit: Unit) -> str:
        """Return size, error and place as text, with lengths in the unit."""
        place = ", ".join(unit.format_number(value, unit.decimals - 1) for value in self.at)
        because = ""
        if self.line is not None:
            because = f", in line {self.line} with T{self.tool}"
        elif self.load is not None:
            because = f", under load {self.load}"
        value, error = unit.format_small_length(self.value), unit.format_small_length(self.error)
        return f"{value} (give or take {error}) at ({place}){because}"

    def to_data(self) -> dict[str, Any]:
        """Return plain data, rounded as files have it; lengths in mm."""
        return self.to_rounded_data("mm") | {"line": self.line, "tool": self.tool, "load": self.load}


@frozen
class LargestStress(PlacedFigure):
    """The largest von Mises stress on the surface under clamping, and its place. Pressed patches do not
    count.

    Parameters
    ----------
    value : in MPa, with elements of the third order.
    error : error estimate in MPa: twice the change of the stress there from elements of the second order to the
        third, and a tenth of the stress.
    at : (x, y, z) in mm, in the part's coordinates.
    """

    def describe(self, unit: Unit) -> str:
        """Return size, error and place as text, with lengths and stresses in the unit."""
        place = ", ".join(unit.format_number(value, unit.decimals - 1) for value in self.at)
        error = unit.format_stress_number(self.error)
        return f"{unit.format_stress_number(self.value)} {unit.pressure} (give or take {error}) at ({place})"

    def to_data(self) -> dict[str, Any]:
        """Return plain data, rounded as files have it; stresses in MPa, lengths in mm."""
        return self.to_rounded_data("MPa")


@frozen(kw_only=True)
class BendingFigures:
    """How far one fixture bends its part, with the data for which this holds.

    Parameters
    ----------
    material : material of the part.
    thickness : height of the part in mm.
    jaw_force : jaw force in N for which the figures hold; the force of each strap if straps hold the part.
    is_assumed : whether the jaw force is assumed because none was given.
    stiffness : ratio of the stiffness of the closed jaw to that of one contact; inf for a screw.
    faces : the faces to be cut: face numbers of the outline, "top" and "bottom"; empty for all.
    below : the pads under the part and the clamp on top; None for a part that lies on its level faces or is
        held by straps.
    clamp_distortion : largest movement under clamping alone, after a rigid motion has laid the part against
        its locators.
    give : largest movement at the cutter or at a load, including the bending of pegs; None when nothing acts.
    stress : largest stress by clamping on the surface, dents and sharp inner edges not counted.
    elements : number of tetrahedra of the mesh.
    """

    material: ElasticMaterial
    thickness: float
    jaw_force: float
    is_assumed: bool
    stiffness: float
    faces: tuple[int | str, ...]
    below: PadsBelow | None
    clamp_distortion: BentPlace
    give: BentPlace | None
    stress: LargestStress
    elements: int

    @property
    def figures(self) -> dict[str, float]:
        """Figures by key, in mm."""
        known = {"clamp_distortion": self.clamp_distortion.value}
        return known if self.give is None else known | {"give": self.give.value}

    def list_values(self) -> list[float | None]:
        """Return the values of :data:`BENDING_COLUMNS`; None for a give that is not known."""
        bent, stress, give = self.clamp_distortion, self.stress, self.give
        gives = (None, None) if give is None else (give.value, give.error)
        return [bent.value, bent.error, *gives, stress.value, stress.error, self.jaw_force]

    def list_sentences(self, mover: str, unit: Unit) -> list[str]:
        """Return sentences that say how far clamping bends the part and how far the part moves at the cutter.

        Parameters
        ----------
        mover : name of the carrier that presses, such as "jaw".
        """
        force = f"At a {mover} force of {unit.format_force(self.jaw_force)}"
        if self.is_assumed:
            force = f"For each {unit.format_force(self.jaw_force)} of {mover} force"
        cut = describe_cut_faces(self.faces)
        where = "the part" if cut is None else f"what is cut of the part ({cut})"
        said = [
            f"{force} clamping bends {where} by {self.clamp_distortion.describe(unit)}; that springs back."
        ]
        if self.give is not None:
            said.append(f"It gives at the cutter by up to {self.give.describe(unit)}.")
        strength = self.material.strength
        known = (
            ""
            if strength is None
            else f"; {self.material.name} is reckoned to yield at {unit.format_stress(strength)}"
        )
        said.append(f"Clamping stresses it by up to {self.stress.describe(unit)}{known}.")
        return said

    @property
    def yields(self) -> bool | None:
        """Whether clamping stresses the part by as much as its material's strength, less the error estimate; None
        where the strength or the jaw force is not known.
        """
        if self.material.strength is None or self.is_assumed:
            return None
        return self.stress.rounded.value + self.stress.rounded.error >= self.material.strength

    def list_warnings(self, limit: float | None, unit: Unit) -> list[str]:
        """Return a warning of a part that would yield, and one for each figure above ``limit`` in mm.

        Where the limit is None there are none of figures.
        """
        return list(self.find_warnings(limit, unit).values())

    def find_warnings(self, limit: float | None, unit: Unit) -> dict[str, str]:
        """Return the warnings of :meth:`list_warnings` by the key of what they are about: "stress" or that of a
        figure.
        """
        found = {}
        if self.yields and self.material.strength is not None:
            least = self.stress.value - self.stress.error
            would = "would yield" if least >= self.material.strength else "might yield"
            found["stress"] = (
                f"The part {would}: clamping stresses it by {self.stress.describe(unit)}, and {self.material.name} is "
                f"reckoned to bear {unit.format_stress(self.material.strength)}. Clamp it less hard or where it is thicker, "
                "or support the wall."
            )
        if limit is None:
            return found
        more = f"more than {unit.format_small_length(limit)}"
        if self.clamp_distortion.value > limit:
            found["clamp_distortion"] = (
                f"Clamping bends the part by {unit.format_small_length(self.clamp_distortion.value)}, {more}: clamp it "
                "less hard or where it is thicker, or leave some stock and clamp it anew for the last cut."
            )
        if self.give is not None and self.give.value > limit:
            found["give"] = (
                f"The part gives by {unit.format_small_length(self.give.value)} at the cutter, {more}: support it "
                "nearer to the cut, or cut less at once there."
            )
        return found

    def to_data(self) -> dict[str, Any]:
        """Return plain data, as result files have it: lengths in mm, forces in N, stresses in MPa."""
        return {
            "material": self.material.name,
            "elastic_modulus": self.material.elastic_modulus,
            "poisson": self.material.poisson,
            "strength": self.material.strength,
            "thickness": self.thickness,
            "jaw_force": round_force(self.jaw_force),
            "is_assumed": self.is_assumed,
            "jaw": "screw" if self.stiffness == inf else self.stiffness,
            "faces": list(self.faces),
            **({} if self.below is None else {"below": self.below.to_data()}),
            "clamp_distortion": self.clamp_distortion.to_data(),
            "give": None if self.give is None else self.give.to_data(),
            "stress": self.stress.to_data(),
            "yields": self.yields,
            "elements": self.elements,
        }
