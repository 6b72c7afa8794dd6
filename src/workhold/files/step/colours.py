"""Colours of the bodies in a STEP file, added to its text (ISO 10303-46, presentation appearance).

The STEP library writes colours in the order of addresses in memory, so the same bodies would not give the
same bytes. Here they follow the bodies.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

__all__ = ["Colour", "coloured"]

# Red, green and blue from 0 to 1.
Colour = tuple[float, float, float]

NUMBER = re.compile(rb"^#(\d+)\s*=", re.MULTILINE)
BODY = re.compile(
    rb"^#\d+\s*=\s*ADVANCED_BREP_SHAPE_REPRESENTATION\(\s*'[^']*'\s*,\s*\(([#\d,\s]*)\)\s*,\s*#(\d+)\s*\)",
    re.MULTILINE,
)
SOLID = re.compile(rb"^#(\d+)\s*=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS)\b", re.MULTILINE)
END = b"ENDSEC;\nEND-ISO-10303-21;"


def coloured(text: bytes, colours: Sequence[Colour]) -> bytes:
    """The text of a STEP file with a colour for each of its bodies, in their order in the file.

    Raises
    ------
    RuntimeError
        When the file has not one body for each colour.
    """
    bodies = list(BODY.finditer(text))
    if len(bodies) != len(colours) or END not in text:
        raise RuntimeError("the STEP library has written other bodies than it was given")
    solids = {int(found[1]) for found in SOLID.finditer(text)}
    number = max(int(found[1]) for found in NUMBER.finditer(text))
    lines: list[str] = []

    def add(entity: str) -> str:
        nonlocal number
        number += 1
        lines.append(f"#{number} = {entity};\n")
        return f"#{number}"

    styles: dict[Colour, str] = {}
    for body, colour in zip(bodies, colours, strict=True):
        if colour not in styles:
            part = add(f"COLOUR_RGB('',{','.join(f'{value:.4f}' for value in colour)})")
            for kind in (
                "FILL_AREA_STYLE_COLOUR('',{})",
                "FILL_AREA_STYLE('',({}))",
                "SURFACE_STYLE_FILL_AREA({})",
                "SURFACE_SIDE_STYLE('',({}))",
                "SURFACE_STYLE_USAGE(.BOTH.,{})",
                "PRESENTATION_STYLE_ASSIGNMENT(({}))",
            ):
                part = add(kind.format(part))
            styles[colour] = part
        parts = [int(part) for part in re.findall(rb"#(\d+)", body[1])]
        items = [add(f"STYLED_ITEM('color',({styles[colour]}),#{part})") for part in parts if part in solids]
        add(
            f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({','.join(items)}),#{int(body[2])})"
        )
    before, end, after = text.rpartition(END)
    return before + "".join(lines).encode("ascii") + end + after
