"""Reads pictures back: elements by class, the map to millimetres, areas of paths."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import numpy as np
from svgelements import Arc, Line, Path
from svgelements import Move as Start

NAMESPACE = "{http://www.w3.org/2000/svg}"


def by_class(svg: str, name: str) -> list[ET.Element]:
    """All elements of a class."""
    return [element for element in ET.fromstring(svg.encode()).iter() if element.get("class") == name]


def texts(svg: str) -> list[str]:
    """All written words, in order."""
    return [element.text or "" for element in ET.fromstring(svg.encode()).iter(f"{NAMESPACE}text")]


def matrix(group: ET.Element) -> tuple[float, ...]:
    """The six numbers of ``data-model-to-page``."""
    found = re.fullmatch(r"matrix\((.*)\)", group.attrib["data-model-to-page"])
    assert found
    return tuple(float(word) for word in found[1].split())


def to_model(group: ET.Element, x: float, y: float) -> tuple[float, float]:
    """A page point back in millimetres."""
    a, b, c, d, e, f = matrix(group)
    assert b == c == 0 and d == -a
    return (x - e) / a, (y - f) / d


def scale_bar_of(svg: str) -> tuple[float, str]:
    """Length of the scale bar's four pieces in millimetres of the model, and the words beside it."""
    part, (bar,) = by_class(svg, "part")[0], by_class(svg, "scale")
    *pieces, label = list(bar)
    first, last = (piece.attrib["d"].strip("MZ").split("L") for piece in (pieces[0], pieces[-1]))
    return (float(last[1].split()[0]) - float(first[0].split()[0])) / matrix(part)[0], label.text or ""


def area(path: str) -> float:
    """Area between the loops of a path on the page: the integral of x dy - y dx over 2, arcs in closed form."""
    total = 0.0
    for piece in Path(path):
        if isinstance(piece, Start):
            continue
        (x0, y0), (x1, y1) = piece.start, piece.end
        total += (x0 * y1 - x1 * y0) / 2
        if isinstance(piece, Arc):
            assert np.isclose(piece.rx, piece.ry)
            total += piece.rx**2 / 2 * (piece.sweep - np.sin(piece.sweep))
        else:
            assert isinstance(piece, Line) or type(piece).__name__ == "Close"
    return abs(total)
