"""SVG files as trees: bytes to elements, with the guards against hostile XML, and how messages name an element."""

from __future__ import annotations

import re
from collections import Counter
from urllib.parse import unquote
from xml.etree import ElementTree
from xml.etree.ElementTree import Element
from xml.parsers import expat

from attrs import frozen

from workhold.errors import InputError

__all__ = ["DEEPEST", "Document", "href", "local_name", "read_document", "short"]

DEEPEST = 200
SVG_SPACE = "http://www.w3.org/2000/svg"
LINK = "{http://www.w3.org/1999/xlink}href"
ANIMATIONS = {"animate", "animateColor", "animateMotion", "animateTransform", "set"}
ENTITY = re.compile(rb"&(?!(?:amp|lt|gt|quot|apos);)[A-Za-z_:][\w.:-]*;")


def local_name(element: Element) -> str:
    """Tag without its namespace."""
    return str(element.tag).rpartition("}")[2]


def short(text: str, most: int = 60) -> str:
    """The beginning of what a file says, on one line, for messages."""
    return " ".join(text[: 10 * most].split())[:most]


def href(element: Element) -> str:
    """What an element links to."""
    return element.get("href", element.get(LINK, "")).strip()


@frozen
class Document:
    """A file's elements.

    Parameters
    ----------
    root : the <svg>.
    by_id : the first element of each id, as browsers take it.
    places : the number of each element among those of its kind in the file, from 1, and its line.
    parents : what each element but the root is in.
    """

    root: Element
    by_id: dict[str, Element]
    places: dict[Element, tuple[int, int]]
    parents: dict[Element, Element]

    def name(self, element: Element) -> str:
        """How messages call an element: by its id, or else by its number among the elements of its kind."""
        tag = local_name(element)
        if element.get("id"):
            return f"{tag} '{short(element.get('id', ''))}'"
        return "the root <svg>" if element is self.root else f"{tag} number {self.places[element][0]} (without id)"

    def linked(self, link: str) -> Element | None:
        """The element a link such as ``#id`` points to; None when it is not in the file."""
        return self.by_id.get(link[1:], self.by_id.get(unquote(link[1:]))) if link.startswith("#") else None

    def around(self, element: Element) -> list[Element]:
        """The elements around one, from the root inward."""
        found: list[Element] = []
        while element in self.parents:
            element = self.parents[element]
            found.append(element)
        return found[::-1]

    def line(self, element: Element) -> int:
        """The line an element begins on."""
        return self.places[element][1]

    def drawn(self, element: Element) -> bool:
        """Whether an element is of SVG's namespace, as the root is, and not of an editor's own."""
        return str(element.tag).rpartition("}")[0] == str(self.root.tag).rpartition("}")[0]


def read_document(content: bytes) -> Document:
    """The tree of an SVG file.

    Raises
    ------
    InputError
        For files that are no SVG, style sheets outside the file, and animations. Also for XML that is broken (with line and
        column), nested without end or declares entities, which can blow up to any size.
    """
    if content.startswith(b"\x1f\x8b"):
        raise InputError("the SVG file is compressed (svgz): unpack it first.")
    lines: dict[Element, int] = {}
    root = parsed(content, lines)
    space, _, name = str(root.tag).rpartition("}")
    if name != "svg" or space not in ("", "{" + SVG_SPACE):
        raise InputError(f"this is XML, but not an SVG drawing (its root is <{short(name)}>).")
    by_id: dict[str, Element] = {}
    counts: Counter[str] = Counter()
    places: dict[Element, tuple[int, int]] = {}
    for element in root.iter():
        tag = local_name(element)
        counts[tag] += 1
        places[element] = counts[tag], lines[element]
        by_id.setdefault(element.get("id", ""), element)
    by_id.pop("", None)
    document = Document(root, by_id, places, {child: parent for parent in root.iter() for child in parent})
    for element in root.iter():
        tag = local_name(element)
        if tag in ANIMATIONS and document.drawn(element):
            raise InputError(f"{document.name(element)} moves the drawing while it is shown: remove the animation.")
        if tag == "link" and "stylesheet" in element.get("rel", ""):
            raise InputError(f"{document.name(element)} takes styles from another file: embed them, or remove it.")
    return document


def parsed(content: bytes, lines: dict[Element, int]) -> Element:
    """The root element; the line of each element goes into ``lines``.

    Raises
    ------
    InputError
        For XML that is broken, too deep, or asks for what is not in the file.
    """
    parser = expat.ParserCreate(namespace_separator="}")
    parser.buffer_text = True
    builder = ElementTree.TreeBuilder()
    depth = 0

    def expanded(name: str) -> str:
        return "{" + name if "}" in name else name

    def started(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise InputError(f"<{short(name)}> is nested more than {DEEPEST} levels deep: save a plain SVG.")
        element = builder.start(expanded(name), {expanded(key): value for key, value in attributes.items()})
        lines[element] = parser.CurrentLineNumber

    def ended(name: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(expanded(name))

    def declared(*_: object) -> None:
        raise InputError("the SVG file declares XML entities, which are not read: save it as plain SVG.")

    def typed(name: str, system: str | None, public: str | None, subset: object) -> None:
        # With an external document type, which is not read, expat drops unknown entities in attributes in silence.
        unknown = ENTITY.search(content.replace(b"\0", b""))
        if (system or public) and unknown:
            raise InputError(
                f"the SVG file uses the XML entity {short(unknown.group().decode())}: save it as plain SVG."
            )

    def instructed(target: str, _: str) -> None:
        if target == "xml-stylesheet":
            raise InputError(
                "the SVG file takes styles from another file (<?xml-stylesheet): embed them, or remove it."
            )

    parser.StartElementHandler = started
    parser.EndElementHandler = ended
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = declared
    parser.StartDoctypeDeclHandler = typed
    parser.ProcessingInstructionHandler = instructed
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code) or "broken"
        raise InputError(
            f"the file is not valid XML ({reason} at line {error.lineno}, column {error.offset + 1}): export it again."
        ) from error
    except (ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"the file's text encoding is not usable ({error}): save it as UTF-8.") from error
    return builder.close()
