"""SVG files as trees of elements, with guards against hostile XML, and the values declared for each element.

The cascade orders presentation attributes, style sheets and ``style`` by their precedence. tinycss2 and
cssselect2 read the style sheets; they are imported only for drawings that have some.

Glossary
--------
property : a CSS property of an element, such as ``fill``.
declared value : the value that one attribute or rule gives to a property; the first valid one of an element
    counts (CSS Cascade 4).
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from typing import Any
from urllib.parse import unquote
from xml.etree import ElementTree
from xml.etree.ElementTree import Element
from xml.parsers import expat

from attrs import frozen

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.svg.selectors import SelectorMatcher, list_inner_tokens

__all__ = [
    "GEOMETRY",
    "DeclaredValue",
    "SvgDocument",
    "DeclaredStyles",
    "read_link",
    "get_local_name",
    "read_document",
    "shorten_text",
]

SVG_SPACE = "http://www.w3.org/2000/svg"
LINK = "{http://www.w3.org/1999/xlink}href"
ANIMATIONS = {"animate", "animateColor", "animateMotion", "animateTransform", "set"}
# Letters of an attribute or property that is not a list of many, and of a namespace.
LONGEST, LONGEST_NAME = 10_000, 500
# Attributes of one element, those that a document type declares, and of these the ones that all elements get.
MOST_ATTRIBUTES, MOST_DECLARED, MOST_GIVEN = 10_000, 1_000, 20
START_TAG = re.compile(rb"""<[^<!?](?:[^<>"']++|"[^"<]*+"|'[^'<]*+')*+""")
ENTITY = re.compile(rb"&(?!(?:amp|lt|gt|quot|apos);)[A-Za-z_:][\w.:-]*;")


def get_local_name(element: Element) -> str:
    """Return the tag without its namespace."""
    return str(element.tag).rpartition("}")[2]


def shorten_text(text: str, most: int = 60) -> str:
    """Return the beginning of a text from a file, on one line and cut
    to ``most`` characters, for messages.
    """
    return " ".join(text[: 10 * most].split())[:most]


def format_element_name(name: str) -> str:
    """Return the name of an element for messages: without its namespace, shortened."""
    return shorten_text(name.rpartition("}")[2])


def read_link(element: Element) -> str:
    """Return the ``href`` of an element, also under its old name ``xlink:href``; "" where there is none."""
    return element.get("href", element.get(LINK, "")).strip()


@frozen
class SvgDocument:
    """The elements of a file.

    Parameters
    ----------
    root : the <svg>.
    by_id : the first element of each id, as browsers take it.
    places : for each element its number among those of its kind in the file, from 1, and its line.
    parents : the parent of each element but the root.
    """

    root: Element
    by_id: dict[str, Element]
    places: dict[Element, tuple[int, int]]
    parents: dict[Element, Element]

    def name(self, element: Element) -> str:
        """Return an element's name for messages: its tag with its id; without an id
        its tag and its number among elements of that tag.
        """
        tag = get_local_name(element)
        if element.get("id"):
            return f"{tag} '{shorten_text(element.get('id', ''))}'"
        number, _ = self.places[element]
        return "the root <svg>" if element is self.root else f"{tag} number {number} (without id)"

    def find_linked(self, link: str) -> Element | None:
        """Return the element a link such as ``#id`` points to; None when it is not in the file."""
        return self.by_id.get(link[1:], self.by_id.get(unquote(link[1:]))) if link.startswith("#") else None

    def list_ancestors(self, element: Element) -> list[Element]:
        """Return the elements that contain an element, from the root inward."""
        found: list[Element] = []
        while element in self.parents:
            element = self.parents[element]
            found.append(element)
        return found[::-1]

    def is_svg_element(self, element: Element) -> bool:
        """Return whether an element is in the namespace of the root, and not in an editor's own."""
        return str(element.tag).rpartition("}")[0] == str(self.root.tag).rpartition("}")[0]


def read_document(content: bytes, budget: Budget) -> SvgDocument:
    """Return the tree of an SVG file.

    Raises InputError for files that are not SVG, style sheets outside the file, and animations; also for XML
    that is broken (with line and column), nested too deeply, needs more than ``budget`` has, or declares
    entities or attributes, which can expand to any size.
    """
    if content.startswith(b"\x1f\x8b"):
        raise InputError("the SVG file is compressed (svgz): unpack it first.")
    lines: dict[Element, int] = {}
    root = parse_document(content, lines, budget)
    space, _, name = str(root.tag).rpartition("}")
    if name != "svg" or space not in ("", "{" + SVG_SPACE):
        raise InputError(f"this is XML, but not an SVG drawing (its root is <{shorten_text(name)}>).")
    by_id: dict[str, Element] = {}
    counts: Counter[str] = Counter()
    places: dict[Element, tuple[int, int]] = {}
    for element in root.iter():
        tag = get_local_name(element)
        counts[tag] += 1
        places[element] = counts[tag], lines[element]
        by_id.setdefault(element.get("id", ""), element)
    by_id.pop("", None)
    document = SvgDocument(root, by_id, places, {child: parent for parent in root.iter() for child in parent})
    for element in root.iter():
        tag = get_local_name(element)
        if tag in ANIMATIONS and document.is_svg_element(element):
            raise InputError(
                f"{document.name(element)} moves the drawing while it is shown: remove the animation."
            )
        if tag == "link" and "stylesheet" in element.get("rel", ""):
            raise InputError(
                f"{document.name(element)} takes styles from another file: embed them, or remove it."
            )
    return document


def parse_document(content: bytes, lines: dict[Element, int], budget: Budget) -> Element:
    """Return the root element, and fill ``lines`` with the line of each element.

    Raises InputError for XML that is broken, too deep, too large, or refers to content outside the file.
    """
    refuse_many_attributes(content)
    parser = expat.ParserCreate(namespace_separator="}")
    parser.buffer_text = True
    builder = ElementTree.TreeBuilder()
    # The same text for the same name, however often it is there.
    names: dict[str, str] = {}

    def expand_name(name: str) -> str:
        """Return expat's name of a tag or an attribute in ElementTree's form, ``{namespace}name``."""
        if name not in names:
            names[name] = "{" + name if "}" in name else name
        return names[name]

    def handle_start(name: str, attributes: dict[str, str]) -> None:
        """Handle a start tag."""
        budget.enter(lambda: f"<{format_element_name(name)}>")
        # What ten attributes take is what an element takes.
        budget.spend(1 + len(attributes) // 10)
        line = parser.CurrentLineNumber
        for key, value in attributes.items():
            if len(value) > LONGEST and key in SHORT:
                raise InputError(
                    f"<{format_element_name(name)}> on line {line} has {len(value):,} letters in its {key}: correct it."
                )
        element = builder.start(
            expand_name(name), {expand_name(key): value for key, value in attributes.items()}
        )
        lines[element] = line

    def handle_end(name: str) -> None:
        """Handle an end tag."""
        budget.leave()
        builder.end(expand_name(name))

    def refuse_entity(*_: object) -> None:
        """Refuse the declaration of an entity."""
        raise InputError("the SVG file declares XML entities, which are not read: save it as plain SVG.")

    given = count = 0

    def refuse_default_value(_: str, name: str, __: str, default: str | None, ___: int) -> None:
        """Refuse declarations of attributes with a default value, except
        for declarations of a few namespaces.
        """
        # Every element gets what is declared: only namespaces, which drawings do declare, stay harmless.
        nonlocal given, count
        given, count = given + (default is not None), count + 1
        harmless = default is None or (name.startswith("xmlns") and len(default) <= LONGEST_NAME)
        if not harmless or given > MOST_GIVEN or count > MOST_DECLARED:
            raise InputError(
                "the SVG file declares attributes for all its elements (<!ATTLIST), which is not read: save "
                "it as plain SVG."
            )

    def refuse_long_namespace(prefix: str | None, space: str | None) -> None:
        """Refuse the declaration of a namespace with a very long name."""
        if len(space or "") > LONGEST_NAME:
            raise InputError(
                f"the XML namespace '{shorten_text(space or '')}' on line {parser.CurrentLineNumber} is longer than "
                f"{LONGEST_NAME} letters: save the file as plain SVG."
            )

    def refuse_external_type(name: str, system: str | None, public: str | None, subset: object) -> None:
        """Refuse entities of an external document type."""
        # With an external document type, which is not read, expat drops unknown entities in attributes in
        # silence.
        unknown = ENTITY.search(content.replace(b"\0", b""))
        if (system or public) and unknown:
            raise InputError(
                f"the SVG file uses the XML entity {shorten_text(unknown.group().decode())}: save it as plain SVG."
            )

    def refuse_style_sheet(target: str, _: str) -> None:
        """Refuse a style sheet in another file."""
        if target == "xml-stylesheet":
            raise InputError(
                "the SVG file takes styles from another file (<?xml-stylesheet): embed them, or remove it."
            )

    parser.StartElementHandler = handle_start
    parser.EndElementHandler = handle_end
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = refuse_entity
    parser.AttlistDeclHandler = refuse_default_value
    parser.StartNamespaceDeclHandler = refuse_long_namespace
    parser.StartDoctypeDeclHandler = refuse_external_type
    parser.ProcessingInstructionHandler = refuse_style_sheet
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code) or "broken"
        raise InputError(
            f"the file is not valid XML ({reason} at line {error.lineno}, column {error.offset + 1}): export "
            "it again."
        ) from error
    except (ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"the file's text encoding is not usable ({error}): save it as UTF-8.") from error
    return builder.close()


def refuse_many_attributes(content: bytes) -> None:
    """Raise InputError for an element with very many attributes, before expat reads it as a whole."""
    if content.count(b"=") <= MOST_ATTRIBUTES:
        return
    for tag in START_TAG.finditer(content):
        if tag.end() - tag.start() > MOST_ATTRIBUTES and tag.group().count(b"=") > MOST_ATTRIBUTES:
            line = content.count(b"\n", 0, tag.start()) + 1
            raise InputError(
                f"the element on line {line} has more than {MOST_ATTRIBUTES:,} attributes: save the file as "
                "plain SVG."
            )


# Properties and their values, in the order of the file.
Block = list[tuple[str, str]]

GEOMETRY = ("x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "d")
# Properties that say where a shape is or whether it is seen, and that an attribute of their name may set.
ATTRIBUTES = {"display", "visibility", "opacity", "overflow", "color", "clip-path", "clip", "mask", "filter"}
ATTRIBUTES |= {"fill", "fill-opacity", "stroke", "stroke-opacity", "stroke-width", "stroke-dasharray"}
ATTRIBUTES |= {"fill-rule", "marker-start", "marker-mid", "marker-end", "stop-opacity", *GEOMETRY}
ATTRIBUTES |= {"transform", "transform-origin"}
ONLY_STYLES = {"translate", "rotate", "scale", "transform-box", "overflow-x", "overflow-y", "mask-image"}
ONLY_STYLES |= {"mask-border", "marker", "offset", "offset-path", "animation", "animation-name", "zoom"}
ONLY_STYLES |= {"all"}
KNOWN = ATTRIBUTES | ONLY_STYLES
# What may be as long as a drawing is large.
LISTS = {"d", "transform"}
# Attributes that are looked at and hold no list of many.
SHORT = ATTRIBUTES - LISTS | {"x1", "y1", "x2", "y2", "refX", "refY", "viewBox", "preserveAspectRatio"}
SHORT |= {"requiredExtensions", "systemLanguage", "requiredFeatures", "clipPathUnits", "type", "media", "rel"}
HARMLESS_RULES = {"charset", "font-face", "page", "keyframes", "-webkit-keyframes", "counter-style"}
HARMLESS_RULES |= {"property"}
SCREENS = {"", "all", "screen", "only screen"}
# A font or a picture in base64.
EMBEDDED = re.compile(r"[A-Za-z0-9+/=]{1000,}")


@frozen
class DeclaredValue:
    """A declared value; ``css`` says whether it comes from CSS, whose grammar is stricter than that of
    attributes.
    """

    text: str
    css: bool


class DeclaredStyles:
    """The declared values of a document's elements.

    Parameters
    ----------
    budget : work that may still be spent on the drawing.

    Raises
    ------
    InputError
        For rules of a style sheet that are not supported and could change an outline, naming the style and
        its line.
    """

    def __init__(self, document: SvgDocument, budget: Budget) -> None:
        self.document = document
        self.budget = budget
        self.matched: dict[Element, list[tuple[tuple[Any, ...], Block]]] = {}
        # Style attributes by their text: drawings repeat them.
        self.attributes: dict[str, tuple[Block, Block]] = {}
        # Whether gradients and patterns are seen, see ``files.svg.style``.
        self.painted: dict[Element, bool] = {}
        styles = [element for element in document.root.iter() if get_local_name(element) == "style"]
        styles = [one for one in styles if one.get("type", "").strip().lower() in ("", "text/css")]
        if styles:
            self.match(styles)

    def match(self, styles: list[Element]) -> None:
        """Read the style elements, and store in ``matched`` the rules that select each element."""
        sheets = StyleRules(self.budget)
        for style in styles:
            place = f"the style sheet on line {self.document.places[style][1]}"
            refuse_media(style.get("media", ""), place)
            sheets.read("".join(style.itertext()), place)
        if not sheets.rules:
            return
        # Elements that the same rules select share their list.
        shared: dict[tuple[int, ...], list[tuple[tuple[Any, ...], Block]]] = {}
        for element, selected in sheets.selectors.match_elements(self.document.root, self.budget):
            key = tuple(number for *_, number in selected)
            if key not in shared:
                self.budget.spend(len(key))
                shared[key] = [
                    ((important, *rank), values)
                    for rank in selected
                    for important, values in enumerate(sheets.rules[rank[-1]])
                ]
            self.matched[element] = shared[key]

    def list_declared_values(self, element: Element) -> dict[str, list[DeclaredValue]]:
        """Return the declared values of each property of an element, the strongest first."""
        layers: list[tuple[tuple[Any, ...], Block, bool]]
        layers = [((0, -1), [item for item in element.items() if item[0] in ATTRIBUTES], False)]
        layers += [(key, values, True) for key, values in self.matched.get(element, ())]
        if element.get("style"):
            for important, values in enumerate(self.parse_style_attribute(element)):
                layers.append(((important, 1 << 30), values, True))
        found: dict[str, list[DeclaredValue]] = defaultdict(list)
        self.budget.count_steps(sum(1 + len(values) for _, values, _ in layers))
        for _, values, css in sorted(layers, key=lambda layer: layer[0], reverse=True):
            for name, text in reversed(values):
                found[name].append(DeclaredValue(text.strip(), css))
        return found

    def parse_style_attribute(self, element: Element) -> tuple[Block, Block]:
        """Return (plain, important), the declarations of an element's
        ``style`` attribute; cached by its text.
        """
        text = element.get("style", "")
        if text not in self.attributes:
            place = f"the style of {self.document.name(element)}"
            self.attributes[text] = parse_declarations(tokenize_css(text, place, self.budget), place)
        return self.attributes[text]


class StyleRules:
    """The rules of a drawing's style sheets: their selectors, and the declarations of each by its number.

    Parameters
    ----------
    budget : work that may still be spent on the drawing.
    """

    def __init__(self, budget: Budget) -> None:
        self.budget = budget
        self.style = Budget(LIMITS["style"])
        self.selectors = SelectorMatcher(self.style)
        self.rules: list[tuple[Block, Block]] = []

    def read(self, text: str, place: str) -> None:
        """Add the rules of a style sheet; ``place`` names it in messages.

        Raises
        ------
        InputError
            For rules that are not supported and could change an outline, and for very many.
        """
        self.style.count_letters(count_css_letters(text), place)
        self.add(tokenize_css(text, place, self.budget), place)

    def add(self, tokens: list[Any], place: str, counts: bool = True) -> bool:
        """Add the rules in some tokens, and return whether at least one of them could change an outline.

        With ``counts`` False nothing is added: the tokens are inside a rule that does not apply to screens.
        """
        import cssselect2
        import tinycss2

        found = False
        for rule in tinycss2.parse_stylesheet(tokens, skip_comments=True, skip_whitespace=True):
            self.budget.count_steps(16)
            if rule.type == "at-rule":
                keyword, condition = rule.lower_at_keyword, tinycss2.serialize(rule.prelude).strip()
                if keyword == "media" and rule.content is not None:
                    usual = " ".join(condition.lower().split()) in SCREENS
                    if self.add(rule.content, f"@media of {place}", counts and usual):
                        refuse_media(condition, f"@media of {place}")
                        found = True
                elif keyword not in HARMLESS_RULES and (
                    keyword == "import" or rule.content is None or self.add(rule.content, place, False)
                ):
                    raise InputError(
                        f"{place} has @{shorten_text(keyword)} {shorten_text(condition)}, which is not read: write plain "
                        "rules."
                    )
            elif rule.type == "qualified-rule":
                words = tinycss2.serialize(rule.prelude).strip()
                declarations = parse_declarations(rule.content, f"{shorten_text(words)} in {place}")
                if not any(declarations):
                    continue
                found = True
                try:
                    if counts:
                        self.rules += [declarations] * len(self.selectors.add(rule.prelude))
                except cssselect2.SelectorError as error:
                    raise InputError(
                        f"{place} has the selector '{shorten_text(words)}', which is not read: use classes."
                    ) from error
        return found


def refuse_media(media: str, place: str) -> None:
    """Raise InputError for styles that apply to some screens or printers only."""
    if " ".join(media.lower().split()) not in SCREENS:
        raise InputError(
            f"{place} is for '{shorten_text(media)}' only, which is not read: write the styles without it."
        )


def count_css_letters(text: str) -> int:
    """Return the number of characters of CSS, without embedded fonts and pictures of long texts.

    What is embedded takes little time to read.
    """
    return len(text) if len(text) <= LONGEST else len(EMBEDDED.sub("", text))


def tokenize_css(text: str, place: str, budget: Budget) -> list[Any]:
    """Return the tokens of CSS; ``place`` names it in messages.

    Raises InputError for a text that is too long or nested too deeply, and for numbers that cannot be read.
    """
    import tinycss2

    style = Budget(LIMITS["style"])
    style.count_letters(count_css_letters(text), place)
    budget.count_steps(1 + len(text) // 16)
    try:
        tokens: list[Any] = tinycss2.parse_component_value_list(text)
    except ValueError as error:  # whole numbers of thousands of digits
        raise InputError(f"{place} has a number that cannot be read: correct it.") from error
    level = tokens
    while level := [inner for token in level for inner in list_inner_tokens(token)]:
        style.enter(lambda: f"a bracket of {place}")
    return tokens


def parse_declarations(content: Any, place: str) -> tuple[Block, Block]:
    """Return (plain, important): the declarations (name, value) of known properties in a block, in these two
    groups.

    Raises InputError for rules within the block.
    """
    import tinycss2

    plain: Block = []
    important: Block = []
    for item in tinycss2.parse_blocks_contents(content, skip_comments=True, skip_whitespace=True):
        if item.type in ("qualified-rule", "at-rule"):
            raise InputError(f"{place} has a rule within a rule, which is not read: write it apart.")
        if item.type != "declaration":
            continue
        name = item.lower_name.removeprefix("-webkit-")
        if name in KNOWN:
            text = tinycss2.serialize([token for token in item.value if token.type != "comment"]).strip()
            if len(text) > LONGEST and name not in LISTS:
                raise InputError(f"{place} has {len(text):,} letters in its {name}: correct it.")
            (important if item.important else plain).append((name, text))
    return plain, important
