"""The form of how far a fixture bends its part, as a result file has it, and its reading."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from attrs import evolve
from pydantic import Field, ValidationError

from workhold.errors import InputError
from workhold.files.result.forms import FormPart, describe_first_fault
from workhold.model.elastic_material import MATERIALS, ElasticMaterial
from workhold.model.part_bending import BendingFigures, BentPlace, LargestStress, PadsBelow
from workhold.model.result import Result

__all__ = ["BendingPart", "add_bendings", "check_bending", "read_head_bendings"]

LARGEST = 1e9
Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Size = Annotated[float, Field(ge=0, le=LARGEST)]
Above = Annotated[float, Field(gt=0, le=LARGEST)]
Whole = Annotated[int, Field(ge=0)]
Point = Annotated[list[Number], Field(min_length=3, max_length=3)]
Centre = Annotated[list[Number], Field(min_length=2, max_length=2)]


class BentPlacePart(FormPart):
    """The largest movement of one kind, its error and its place, in mm."""

    value: Size
    error: Size
    unit: Literal["mm"]
    at: Point
    line: int | None = Field(None, description="of the program, where a cut causes it")
    tool: int | None = None
    load: Annotated[int, Field(ge=1)] | None = Field(None, description="number of the load that causes it")

    def to_place(self) -> BentPlace:
        """Return the movement as an object of the model."""
        return BentPlace(self.value, self.error, tuple(self.at), self.line, self.tool, self.load)


class LargestStressPart(FormPart):
    """The largest von Mises stress on the surface, its error in MPa, and its place in mm."""

    value: Size
    error: Size
    unit: Literal["MPa"]
    at: Point


class PadsBelowPart(FormPart):
    """Three pads under the part and a clamp on top; lengths in mm, the force in N."""

    pads: Annotated[list[Centre], Field(min_length=3, max_length=3)]
    pad_radius: Above
    clamp: Point
    tip_radius: Above
    force: Size


class BendingPart(FormPart):
    """How far clamping bends the part, how far it gives, and for what this holds; see docs/bending.md."""

    material: str
    elastic_modulus: Above = Field(description="Young's modulus in MPa")
    poisson: Annotated[float, Field(ge=0, lt=0.5)]
    strength: Above | None = Field(description="MPa from which the material yields; null where not known")
    thickness: Above = Field(description="height of the part in mm")
    jaw_force: Above = Field(description="N; of each strap where straps hold the part")
    is_assumed: bool = Field(
        description="whether the force is a mere convention, because nobody said how hard the jaws press"
    )
    jaw: Literal["screw"] | Size = Field(description="what keeps the jaw closed under loads")
    faces: list[Whole | Literal["top", "bottom"]] = Field(description="the faces to be cut; none: all")
    below: PadsBelowPart | None = None
    clamp_distortion: BentPlacePart
    give: BentPlacePart | None
    stress: LargestStressPart
    yields: bool | None
    elements: Annotated[int, Field(ge=1)]

    def to_figures(self) -> BendingFigures:
        """Return the figures as an object of the model.

        Raises InputError for a material that cannot be, and where ``yields`` contradicts the figures.
        """
        usual = MATERIALS.get(self.material)
        material = ElasticMaterial(
            self.material,
            self.elastic_modulus,
            self.poisson,
            1000.0 if usual is None else usual.density,
            strength=self.strength,
        )
        if usual is not None and evolve(
            material, source=usual.source, strength_source=usual.strength_source
        ) == (usual):
            material = usual
        pads = self.below
        found = BendingFigures(
            material=material,
            thickness=self.thickness,
            jaw_force=self.jaw_force,
            is_assumed=self.is_assumed,
            stiffness=inf if isinstance(self.jaw, str) else self.jaw,
            faces=tuple(self.faces),
            below=None
            if pads is None
            else PadsBelow(
                np.array(pads.pads), pads.pad_radius, np.array(pads.clamp), pads.tip_radius, pads.force
            ),
            clamp_distortion=self.clamp_distortion.to_place(),
            give=None if self.give is None else self.give.to_place(),
            stress=LargestStress(self.stress.value, self.stress.error, tuple(self.stress.at)),
            elements=self.elements,
        )
        if found.yields != self.yields:
            raise InputError("what it says of yielding contradicts its stress, the strength or the force.")
        return found


def check_bending(data: Any, path: Path, number: int) -> BendingFigures:
    """Return how far a fixture bends its part from its JSON object, after checking it.

    Parameters
    ----------
    number : number of the fixture, counted from 1, for messages.

    Raises
    ------
    InputError
        Naming the first key that is missing or cannot be used.
    """
    try:
        return BendingPart.model_validate(data).to_figures()
    except ValidationError as error:
        key, reason = describe_first_fault(error)
        key = ".".join(filter(None, ("bending", key)))
        raise InputError(f"{path}: fixture {number} cannot be used: {key}: {reason}.") from error
    except InputError as error:
        raise InputError(f"{path}: fixture {number} cannot be used: {error}") from error


def add_bendings(
    result: Result, bending: Mapping[int, BendingFigures], bent_by: str | None, path: Path
) -> Result:
    """Return a result with how far its fixtures bend their part, by index, and the figure that orders them.

    Raises InputError where fixtures are said to be in the order of a figure that they lack.
    """
    if bent_by is not None and (not bending or any(bent_by not in bending[row].figures for row in bending)):
        raise InputError(f"{path}: bent_by names {bent_by}, which fixtures with bending do not have.")
    return evolve(result, bending=dict(sorted(bending.items())), bent_by=bent_by)


def read_head_bendings(data: Mapping[str, Any], path: Path, count: int) -> dict[int, Any]:
    """Return the bendings, as JSON objects by index of the fixture, from the head of a file in columns.

    Parameters
    ----------
    count : number of fixtures in the file.

    Raises
    ------
    InputError
        When it is not a list of fixtures' numbers and their bending.
    """
    found: dict[int, Any] = {}
    stated = data.get("bendings", [])
    for one in stated if isinstance(stated, list) else [None]:
        entry = one if isinstance(one, dict) else {}
        number = entry.get("fixture")
        if not isinstance(number, int) or not 1 <= number <= count or number - 1 in found:
            raise InputError(
                f"{path}: bendings cannot be used: it does not name different fixtures and the bending of each."
            )
        found[number - 1] = entry.get("bending")
    return found
