"""The solids of a STEP file that has several, with what the file calls them, and what each is made of.

A solid may be named itself, by its product, and by the places in which assemblies use the product. The
nearest of these names that says something is taken. That is its own where a product has several solids, else
that of the product, else that of what the product is in.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from workhold.errors import plain, shortened
from workhold.files.step.library import occ, sub_shapes

__all__ = ["named_shapes"]

LONGEST_NAME = 80
# What programs write where nobody has given a name.
NO_NAME = re.compile(
    r"(?:none|unnamed|no_?name|solid|compound|shell|shape|body|\d+|nauo\d*|=>\[[\d:]*\]|open cascade .*)?",
    re.IGNORECASE,
)


def named_shapes(reader: Any) -> list[tuple[Any, str]] | None:
    """Every solid of what a reader of STEP files has read, with its name; empty where it has none.

    Returns
    -------
    None where the library does not know: the solids are those of the reader then, without names.
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
        for label in children(occ.XCAFDoc_DocumentTool.ShapesLabel_s(document.Main())):
            if occ.XCAFDoc_ShapeTool.IsFree_s(label):
                for product, names in places_under(label, occ.TopLoc_Location(), ()):
                    solids = sub_shapes(product, "SOLID")
                    found += [(solid, name_of(solid, names, len(solids), process)) for solid in solids]
        wanted = Counter(map(position, sub_shapes(reader.OneShape(), "SOLID")))
        return found if Counter(position(solid) for solid, _ in found) == wanted else None
    return None


def position(shape: Any) -> tuple[float, ...]:
    """Where a solid is placed, rounded so that two readings of a file agree."""
    move = shape.Location().Transformation()
    return tuple(round(move.Value(row, column), 6) for row in (1, 2, 3) for column in (1, 2, 3, 4))


def children(label: Any) -> Iterator[Any]:
    """The labels directly under a label."""
    at = occ.TDF_ChildIterator(label, False)
    while at.More():
        yield at.Value()
        at.Next()


def places_under(label: Any, moved: Any, names: tuple[str, ...]) -> Iterator[tuple[Any, tuple[str, ...]]]:
    """Every place in which a product without others in it is used, at a label or below.

    Parameters
    ----------
    moved : where the assemblies around it place it.
    names : of these assemblies.

    Returns
    -------
    The product's shape there, and names from the outermost assembly inward.
    """
    product = label
    if occ.XCAFDoc_ShapeTool.IsReference_s(label):
        product = occ.TDF_Label()
        occ.XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
        moved = moved.Multiplied(occ.XCAFDoc_ShapeTool.GetLocation_s(label))
    names = (*names, called(label), called(product))
    if not occ.XCAFDoc_ShapeTool.IsAssembly_s(product):
        yield occ.XCAFDoc_ShapeTool.GetShape_s(product).Moved(moved), names
        return
    for below in children(product):
        if occ.XCAFDoc_ShapeTool.IsComponent_s(below):
            yield from places_under(below, moved, names)


def called(label: Any) -> str:
    """The name at a label; empty where it says nothing."""
    name = occ.TDataStd_Name()
    has_name = label.FindAttribute(occ.TDataStd_Name.GetID_s(), name)
    return shown_name(name.Get().ToExtString()) if has_name else ""


def shown_name(name: str) -> str:
    """A name fit to be shown; empty where it says nothing.

    >>> shown_name(" base  plate "), shown_name("=>[0:1:1:3]"), shown_name("NONE"), shown_name("12")
    ('base plate', '', '', '')
    """
    words = shortened(plain(" ".join(name.split())), LONGEST_NAME)
    return "" if NO_NAME.fullmatch(words) else words


def name_of(solid: Any, names: tuple[str, ...], count: int, process: Any) -> str:
    """The name of a solid of a product that has so many solids."""
    own = ""
    with suppress(Exception):
        # Solids are known to the reader without the place that assemblies give them.
        own = shown_name(
            process.EntityFromShapeResult(solid.Located(occ.TopLoc_Location()), 1).Name().ToCString()
        )
    # The assembly of all says nothing about one of its solids.
    of_product = next((name for name in reversed(names[2:] or names) if name), "")
    return of_product if count == 1 and of_product else own or of_product
