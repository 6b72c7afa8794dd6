"""The report read back: numbers with their keys, from the page and from the PDF, as a program of its own would."""

from __future__ import annotations

import ctypes
import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pypdfium2
from attrs import define, field, frozen
from pypdfium2 import raw

# Elements whose digits are not results: commands, quotations, labels, references, formulas and pictures.
MARKED = {"code", "q", "b", "cite", "var", "svg", "style", "title", "h1", "small"}
VOID = {"meta", "br", "rect", "circle", "path", "img"}


@frozen
class Printed:
    """A number as it is printed, with its key and what it counts in."""

    key: str
    text: str
    scale: float = 1.0

    @property
    def value(self) -> float:
        """What the text says."""
        plain = self.text.replace("−", "-").replace(",", "").replace("%", "").strip()
        return float(plain) * self.scale

    @property
    def half_unit(self) -> float:
        """Half of what the last digit counts."""
        plain = self.text.replace("−", "-").replace(",", "").replace("%", "").strip()
        mantissa, _, exponent = plain.partition("e")
        decimals = len(mantissa.partition(".")[2])
        return 0.5 * 10.0 ** (int(exponent or 0) - decimals) * self.scale


@define
class Page(HTMLParser):
    """The numbers of the page, and the digits that stand outside of any."""

    numbers: list[Printed] = field(factory=list)
    loose: list[str] = field(factory=list)
    inside: list[str] = field(factory=list)
    number: dict[str, str] | None = None

    def __attrs_pre_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = {key: value or "" for key, value in attrs}
        if found.get("class") == "n":
            self.number = found
        if tag in MARKED:
            self.inside.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in MARKED:
            self.inside.remove(tag)
        if tag == "a":
            self.number = None

    def handle_data(self, data: str) -> None:
        if self.number is not None:
            self.numbers.append(Printed(self.number["data-key"], data, float(self.number["data-scale"])))
        elif not self.inside and re.search(r"\d", data):
            self.loose.append(data)


def page_of(path: Path) -> Page:
    """The page read."""
    page = Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def at_key(folder: Path, key: str) -> Any:
    """What the data file says at a key."""
    section, *names = key.split("/")
    found = json.loads((folder / "data" / f"{section}.json").read_text(encoding="utf-8"))["data"]
    for name in names:
        found = found[int(name)] if isinstance(found, list) else found[name]
    return found


def pdf_numbers(path: Path) -> list[Printed]:
    """The numbers of the PDF: the text below each link that leads into a data file."""
    found = []
    document = pypdfium2.PdfDocument(path)
    for page in document:
        text = page.get_textpage()
        for number in range(raw.FPDFPage_GetAnnotCount(page)):
            annotation = raw.FPDFPage_GetAnnot(page, number)
            uri, box = uri_of(document, annotation), raw.FS_RECTF()
            raw.FPDFAnnot_GetRect(annotation, ctypes.byref(box))
            if uri.startswith("data/"):
                # Letters reach a little beyond the line that the link covers.
                words = text.get_text_bounded(box.left, box.bottom - 1.0, box.right, box.top + 1.0)
                section, _, place = uri.removeprefix("data/").partition(".json#")
                found.append(Printed(f"{section}/{place}", words.strip()))
            raw.FPDFPage_CloseAnnot(annotation)
    return found


def uri_of(document: Any, annotation: Any) -> str:
    """Where a link leads."""
    action = raw.FPDFLink_GetAction(raw.FPDFAnnot_GetLink(annotation))
    length = raw.FPDFAction_GetURIPath(document, action, None, 0)
    buffer = ctypes.create_string_buffer(length)
    raw.FPDFAction_GetURIPath(document, action, buffer, length)
    return buffer.value.decode()
