"""The solids of a STEP file, in mm, with their names.

A solid may be named itself, by its product, and by the places in which assemblies use the product. The
nearest meaningful name is used: the solid's own if a product has several solids, else that of the product,
else that of the assembly around it.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from difflib import get_close_matches
from io import BytesIO
from math import isfinite
from typing import Any

from attrs import astuple, evolve, frozen

from workhold.errors import InputError, shorten_middle
from workhold.errors import make_printable as plain_text
from workhold.files.apart import run_apart
from workhold.files.questions import PART_NUMBER
from workhold.files.step.library import (
    compute_bounding_box,
    list_sub_shapes,
    load_step_library,
    occ,
    read_guarded,
)
from workhold.limits import MOST_LENGTH
from workhold.model.solid import FileSolid

__all__ = [
    "Solid",
    "choose_solid",
    "list_solids",
    "describe_lost_solids",
    "number_solids",
    "read_as_plain_data",
    "prepare",
    "read_solids",
    "describe_other_solids",
    "list_solids_of_shapes",
]

SOLID_LIST = 10
LONGEST_NAME = 80
# What programs write where nobody has given a name.
NO_NAME = re.compile(
    r"(?:none|unnamed|no_?name|solid|compound|shell|shape|body|\d+|nauo\d*|=>\[[\d:]*\]|open cascade .*)?",
    re.IGNORECASE,
)


@frozen
class Solid:
    """One solid of a file.

    Parameters
    ----------
    number : number of the solid, from 1 by decreasing volume.
    shape : Open CASCADE's solid, in mm.
    volume : volume in mm³.
    low, high : corners (x, y, z) of its bounding box in mm.
    name : name in the file; empty if it has none.
    """

    number: int
    shape: Any
    volume: float
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    name: str = ""

    @property
    def listed(self) -> FileSolid:
        """The solid as a row of the list that users see: number, name, sizes and lowest corner."""
        size = tuple(b - a for a, b in zip(self.low, self.high, strict=True))
        return FileSolid(self.number, self.name, size, self.low)


def read_solids(content: bytes) -> tuple[Solid, ...]:
    """Return every solid of a STEP file, wherever assemblies place it, by decreasing volume.

    Raises InputError for files that are not STEP, damaged, without a unit of length, or without a solid.
    """
    load_step_library()
    refuse_other_formats(content)
    reader = read_through(content)
    shape = reader.OneShape()
    found = list_sub_shapes(shape, "SOLID")
    named = list_named_shapes(reader) if len(found) > 1 else None
    solids = number_solids(found) if named is None else number_solids(*zip(*named, strict=True))
    if not solids:
        if count_solids_in_text(content):
            raise InputError(
                "no solid of the STEP file can be read: repair it in a CAD program and export it again."
            )
        sheets = len(list_sub_shapes(shape, "FACE"))
        held = f"surfaces ({sheets}) but no solid" if sheets else "no solid"
        raise InputError(f"the STEP file holds {held}: export the part as a closed solid.")
    return solids


def list_solids(content: bytes) -> tuple[FileSolid, ...]:
    """Return the solids of the bytes of a STEP file, by decreasing volume; a child process reads them."""
    return tuple(FileSolid(*one) for one in run_apart(__name__, content, {}, "the STEP file"))


def prepare() -> None:
    """Load the library; called in the child process before a
    file is read, see :func:`workhold.files.apart.run_apart`.
    """
    load_step_library()


def read_as_plain_data(content: bytes) -> Any:
    """Return the solids of a STEP file as tuples; called in the child process of :func:`list_solids`."""
    return read_guarded(lambda: [astuple(solid.listed) for solid in read_solids(content)], ValueError)


def number_solids(shapes: Sequence[Any], names: Sequence[str] = ()) -> tuple[Solid, ...]:
    """Return Open CASCADE's solids with numbers from 1 by
    decreasing volume; ``names`` has one for each, or none at all.
    """
    called = names or [""] * len(shapes)
    found = [evolve(measure_solid(shape), name=name) for shape, name in zip(shapes, called, strict=True)]
    solids = sorted(found, key=lambda solid: (-solid.volume, solid.low, solid.high))
    return tuple(evolve(solid, number=number) for number, solid in enumerate(solids, start=1))


def list_solids_of_shapes(shapes: Sequence[Any]) -> tuple[Solid, ...]:
    """Return every solid inside some shapes of Open CASCADE, by decreasing volume; () where there is none."""
    load_step_library()
    return number_solids([solid for shape in shapes for solid in list_sub_shapes(shape, "SOLID")])


def count_solids_in_text(content: bytes) -> int:
    """Return how many solids the text of a STEP file defines; one that assemblies repeat counts once."""
    return len(re.findall(rb"=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS|FACETED_BREP)\s*\(", content))


def describe_lost_solids(content: bytes, solids: tuple[Solid, ...]) -> list[str]:
    """Return one sentence if the text of the file defines more solids than ``solids`` has, otherwise []."""
    if count_solids_in_text(content) <= len(solids):
        return []
    return [
        f"The file names {count_solids_in_text(content)} solids, but only {len(solids)} could be read: "
        "check that yours "
        "is there."
    ]


def refuse_other_formats(content: bytes) -> None:
    """Raise InputError for a file that is not STEP, is cut
    short, or has no unit (for which the library would take mm).
    """
    if content.startswith(b"PK"):
        raise InputError("this is a compressed file, not a STEP file: unpack it first.")
    if b"ISO-10303-21" not in content[:4096]:
        raise InputError(
            "this is not a STEP file (it does not begin with ISO-10303-21): export the part as STEP."
        )
    if b"END-ISO-10303-21" not in content[-4096:]:
        raise InputError("the STEP file is cut short (it has no end mark): export or copy it again.")
    # Files with nothing in them have no unit either, and are distinguished later.
    if b"_REPRESENTATION" in content and b"LENGTH_UNIT" not in content:
        raise InputError("the STEP file does not give its unit of length: export it again, with units.")


def read_through(content: bytes) -> Any:
    """Return Open CASCADE's STEP reader that has read and
    translated the file; raise InputError if it cannot.
    """
    reader = occ.STEPControl_Reader()
    try:
        status = reader.ReadStream("part", BytesIO(content))
        is_read = status == occ.IFSelect_RetDone and reader.TransferRoots()
        if is_read and not reader.OneShape().IsNull():
            return reader
    except Exception as error:  # a damaged file may fail anywhere inside the library
        raise InputError("the STEP file is damaged: open it in a CAD program and export it again.") from error
    if status != occ.IFSelect_RetDone:
        raise InputError("the STEP file is damaged: open it in a CAD program and export it again.")
    raise InputError("the STEP file holds no solid: export the part as a closed solid.")


def measure_solid(shape: Any) -> Solid:
    """Return a solid with its volume and bounding box, and 0 for its number.

    Raises InputError for a volume of 0 and for coordinates beyond ``MOST_LENGTH``.
    """
    properties = occ.GProp_GProps()
    occ.BRepGProp.VolumeProperties_s(shape, properties)
    volume = abs(properties.Mass())
    low, high = compute_bounding_box(shape)
    if not all(isfinite(value) and abs(value) <= MOST_LENGTH for value in (*low, *high)):
        raise InputError("a solid lies more than 1 km from the origin or has no end: check the part's unit.")
    if not (isfinite(volume) and volume > 1e-9):
        raise InputError("a solid has no volume: repair it in the CAD program and export it again.")
    return Solid(0, shape, volume, low, high)


def choose_solid(solids: tuple[Solid, ...], number: int | str | None) -> Solid:
    """Return the solid with the given number (from 1) or name; the largest for None.

    Raises InputError for a number or a name that no solid has, and for a name that several solids have.
    """
    if number is None:
        return solids[0]
    if isinstance(number, str):
        return find_solid_by_name(solids, number)
    if not 1 <= number <= len(solids):
        have = "only one solid" if len(solids) == 1 else f"solids 1 to {len(solids)}"
        raise InputError(f"There is no part {number}: the file holds {have}, numbered by decreasing volume.")
    return solids[number - 1]


def find_solid_by_name(solids: tuple[Solid, ...], name: str) -> Solid:
    """Return the only solid with a name; if none has exactly this name, the only one that has it in other capitals.

    Raises InputError in three cases: no solid has the name (the message suggests similar names), several have
    it (the message gives their numbers), or the file has a single solid, so that no name is needed.
    """
    if len(solids) == 1:
        raise InputError(f"the STEP file holds only one solid: leave {PART_NUMBER} out.")
    asked = " ".join(name.split())
    shown = shorten_middle(plain_text(asked))
    found = [solid for solid in solids if solid.name == asked]
    found = found or [solid for solid in solids if solid.name.casefold() == asked.casefold()]
    if len(found) == 1:
        return found[0]
    if found:
        numbers = ", ".join(str(solid.number) for solid in found[:SOLID_LIST])
        more = f" and {len(found) - SOLID_LIST} more" if len(found) > SOLID_LIST else ""
        raise InputError(
            f"{len(found)} solids of the file are called {found[0].name!r}: give the number of one of them, "
            f"{numbers}{more}."
        )
    names = {solid.name.casefold(): solid.name for solid in solids if solid.name}
    if not names:
        raise InputError(
            f"The solids of the file have no names: give a number from 1 to {len(solids)} instead of "
            f"{shown!r}."
        )
    close = get_close_matches(asked.casefold(), list(names), SOLID_LIST, 0.5) or list(names)[:SOLID_LIST]
    raise InputError(
        f"No solid of the file is called {shown!r}: give a number, or a name such as "
        f"{', '.join(names[one] for one in close)}."
    )


def describe_other_solids(solids: tuple[Solid, ...], chosen: Solid, asked: int | str | None) -> list[str]:
    """Return one sentence that lists the solids and says which is used; [] for a single solid.

    ``asked`` is the number or name that the user gave; None for none.
    """
    if len(solids) == 1:
        return []
    more = f"; and {len(solids) - SOLID_LIST} smaller ones" if len(solids) > SOLID_LIST else ""
    because = "" if asked is not None else f", the largest (choose another with {PART_NUMBER})"
    listing = "; ".join(str(solid.listed) for solid in solids[:SOLID_LIST])
    return [f"The file holds {len(solids)} solids: {listing}{more}. Solid {chosen.number} is used{because}."]


def list_named_shapes(reader: Any) -> list[tuple[Any, str]] | None:
    """Return (solid, name) for every solid that a STEP
    reader has read; the name is "" where the file has none.

    None where the names cannot be read, or where they belong to solids that the reader does not have.
    """
    # Whatever fails over names, the solids are there without them.
    with suppress(Exception):
        naming = occ.STEPCAFControl_Reader(reader.WS(), False)
        for other in (naming.SetColorMode, naming.SetLayerMode, naming.SetPropsMode, naming.SetGDTMode):
            other(False)
        document = occ.TDocStd_Document(occ.TCollection_ExtendedString("names"))
        if not naming.Transfer(document):
            return None
        process = naming.ChangeReader().WS().TransferReader()
        found = []
        for label in list_child_labels(occ.XCAFDoc_DocumentTool.ShapesLabel_s(document.Main())):
            if occ.XCAFDoc_ShapeTool.IsFree_s(label):
                for product, names in list_places_under(label, occ.TopLoc_Location(), ()):
                    solids = list_sub_shapes(product, "SOLID")
                    found += [(solid, read_name(solid, names, len(solids), process)) for solid in solids]
        wanted = Counter(map(round_position, list_sub_shapes(reader.OneShape(), "SOLID")))
        return found if Counter(round_position(solid) for solid, _ in found) == wanted else None
    return None


def round_position(shape: Any) -> tuple[float, ...]:
    """Return the rows of a solid's placement (rotation and
    translation), rounded so that two readings of a file agree.
    """
    move = shape.Location().Transformation()
    return tuple(round(move.Value(row, column), 6) for row in (1, 2, 3) for column in (1, 2, 3, 4))


def list_child_labels(label: Any) -> Iterator[Any]:
    """Yield the direct children of a label of Open CASCADE's document."""
    at = occ.TDF_ChildIterator(label, False)
    while at.More():
        yield at.Value()
        at.Next()


def list_places_under(
    label: Any, moved: Any, names: tuple[str, ...]
) -> Iterator[tuple[Any, tuple[str, ...]]]:
    """Yield (shape, names) for every use, at a label or below it, of a product that is not an assembly.

    Parameters
    ----------
    moved : placement of the label by the assemblies around it.
    names : names of these assemblies, from the outermost inward. The yielded names are these and those of the
        label and its product.
    """
    product = label
    if occ.XCAFDoc_ShapeTool.IsReference_s(label):
        product = occ.TDF_Label()
        occ.XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
        moved = moved.Multiplied(occ.XCAFDoc_ShapeTool.GetLocation_s(label))
    names = (*names, read_label_name(label), read_label_name(product))
    if not occ.XCAFDoc_ShapeTool.IsAssembly_s(product):
        yield occ.XCAFDoc_ShapeTool.GetShape_s(product).Moved(moved), names
        return
    for below in list_child_labels(product):
        if occ.XCAFDoc_ShapeTool.IsComponent_s(below):
            yield from list_places_under(below, moved, names)


def read_label_name(label: Any) -> str:
    """Return the cleaned name at a label; "" where there is none."""
    name = occ.TDataStd_Name()
    has_name = label.FindAttribute(occ.TDataStd_Name.GetID_s(), name)
    return clean_name(name.Get().ToExtString()) if has_name else ""


def clean_name(name: str) -> str:
    """Return a name without surplus spaces and unprintable characters; "" for default names that say nothing.

    >>> clean_name(" base  plate "), clean_name("=>[0:1:1:3]"), clean_name("NONE"), clean_name("12")
    ('base plate', '', '', '')
    """
    words = shorten_middle(plain_text(" ".join(name.split())), LONGEST_NAME)
    return "" if NO_NAME.fullmatch(words) else words


def read_name(solid: Any, names: tuple[str, ...], count: int, process: Any) -> str:
    """Return a solid's own name, or else the name of the innermost named product or assembly around it.

    The product's name is preferred where it has one solid (``count`` is 1). ``names`` are the names that
    :func:`list_places_under` yields, ``process`` is Open CASCADE's transfer process.
    """
    own = ""
    with suppress(Exception):
        # Solids are known to the reader without the place that assemblies give them.
        own = clean_name(
            process.EntityFromShapeResult(solid.Located(occ.TopLoc_Location()), 1).Name().ToCString()
        )
    # The assembly of all says nothing about one of its solids.
    of_product = next((name for name in reversed(names[2:] or names) if name), "")
    return of_product if count == 1 and of_product else own or of_product
