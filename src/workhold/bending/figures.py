"""Figures of how far one fixture bends its part."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.bending.materials import ElasticMaterial
from workhold.bending.surface import Surface
from workhold.errors import InputError
from workhold.model.quality import Figure
from workhold.units import Unit

__all__ = ["BENDING_FIGURES", "Bending", "BentPlace", "LargestStress", "find_bending_figure"]

Array = NDArray[np.float64]

BENDING_FIGURES = (
    Figure(
        "clamp_distortion",
        "mm",
        False,
        "How far clamping alone bends the faces to be cut, or any face: what springs back.",
    ),
    Figure("give", "mm", False, "How far the part gives at the cutter, or where a load acts."),
)


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
    key = name.strip().lower().replace("-", "_").replace(" ", "_")
    for figure in BENDING_FIGURES:
        if figure.key == key:
            return figure
    known = " or ".join(figure.option for figure in BENDING_FIGURES)
    raise InputError(f"{name[:40]!r} is not a figure of bending to rank by: choose {known}.")


@frozen
class BentPlace:
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

    value: float
    error: float
    at: tuple[float, float, float]
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
        """Return plain data: lengths in mm."""
        return {
            "value": self.value,
            "error": self.error,
            "at": list(self.at),
            "line": self.line,
            "tool": self.tool,
            "load": self.load,
        }


@frozen
class LargestStress:
    """The largest von Mises stress on the surface by clamping, outside of what is pressed, and where it is.

    Parameters
    ----------
    value : in MPa, with elements of the third order.
    error : error estimate in MPa: twice the change of the stress there from elements of the second order to the
        third, and a tenth of the stress.
    at : (x, y, z) in mm, in the part's coordinates.
    """

    value: float
    error: float
    at: tuple[float, float, float]

    def describe(self, unit: Unit) -> str:
        """Return size, error and place as text, with lengths and stresses in the unit."""
        place = ", ".join(unit.format_number(value, unit.decimals - 1) for value in self.at)
        error = unit.format_stress_number(self.error)
        return f"{unit.format_stress_number(self.value)} {unit.pressure} (give or take {error}) at ({place})"

    def to_data(self) -> dict[str, Any]:
        """Return plain data: stresses in MPa, lengths in mm."""
        return {"value": self.value, "error": self.error, "at": list(self.at)}


@frozen(eq=False)
class Bending:
    """How far one fixture bends its part.

    Parameters
    ----------
    material : material of the part.
    jaw_force : jaw force in N that the figures hold for.
    is_stated : whether the jaw force is a convention, because nobody said how hard the jaws press.
    clamp_distortion : largest movement by clamping alone, where the part is laid against its locators as if
        it were stiff.
    give : largest movement at the cutter, or where a load acts, with the bending of pegs; None where nothing
        acts.
    stress : largest stress by clamping on the surface, dents and sharp inner edges not counted.
    elements : number of tetrahedra of the mesh.
    faces : the faces to be cut, in words; None for all.
    surface : surface of the mesh, in the part's coordinates.
    moved : (N, 3) movement of each node of the surface by clamping, in mm.
    pressed : (N,) whether something presses at the node, so that its dent is not counted.
    """

    material: ElasticMaterial
    jaw_force: float
    is_stated: bool
    clamp_distortion: BentPlace
    give: BentPlace | None
    stress: LargestStress
    elements: int
    faces: str | None
    surface: Surface = field(repr=False)
    moved: Array = field(repr=False)
    pressed: NDArray[np.bool_] = field(repr=False)

    @property
    def figures(self) -> dict[str, float]:
        """Figures by key, in mm."""
        known = {"clamp_distortion": self.clamp_distortion.value}
        return known if self.give is None else known | {"give": self.give.value}

    def list_sentences(self, mover: str, unit: Unit) -> list[str]:
        """Return sentences on how far clamping bends the part and how far it gives at the cutter.

        Parameters
        ----------
        mover : name of what presses, such as "jaw".
        """
        force = f"At a {mover} force of {unit.format_force(self.jaw_force)}"
        if self.is_stated:
            force = f"For each {unit.format_force(self.jaw_force)} of {mover} force"
        where = "the part" if self.faces is None else f"what is cut of the part ({self.faces})"
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
        if self.material.strength is None or self.is_stated:
            return None
        return self.stress.value + self.stress.error >= self.material.strength

    def list_warnings(self, limit: float | None, unit: Unit) -> list[str]:
        """Return a warning of a part that would yield, and one for each figure above ``limit`` in mm.

        Where the limit is None there are none of figures.
        """
        found = []
        if self.yields and self.material.strength is not None:
            least = self.stress.value - self.stress.error
            would = "would yield" if least >= self.material.strength else "might yield"
            found.append(
                f"The part {would}: clamping stresses it by {self.stress.describe(unit)}, and {self.material.name} is "
                f"reckoned to bear {unit.format_stress(self.material.strength)}. Clamp it less hard or where it is thicker, "
                "or support the wall."
            )
        if limit is None:
            return found
        more = f"more than {unit.format_small_length(limit)}"
        if self.clamp_distortion.value > limit:
            found.append(
                f"Clamping bends the part by {unit.format_small_length(self.clamp_distortion.value)}, {more}: clamp it "
                "less hard or where it is thicker, or leave some stock and clamp it anew for the last cut."
            )
        if self.give is not None and self.give.value > limit:
            found.append(
                f"The part gives by {unit.format_small_length(self.give.value)} at the cutter, {more}: support it "
                "nearer to "
                "the cut, or cut less at once there."
            )
        return found

    def to_data(self) -> dict[str, Any]:
        """Return plain data: lengths in mm, forces in N."""
        return {
            "material": self.material.name,
            "elastic_modulus": self.material.elastic_modulus,
            "poisson": self.material.poisson,
            "jaw_force": self.jaw_force,
            "is_stated": self.is_stated,
            "clamp_distortion": self.clamp_distortion.to_data(),
            "give": None if self.give is None else self.give.to_data(),
            "stress": self.stress.to_data(),
            "strength": self.material.strength,
            "yields": self.yields,
            "faces": self.faces,
            "elements": self.elements,
        }
