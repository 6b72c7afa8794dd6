"""The cascade: what presentation attributes, style sheets and ``style`` say of an element, in order of precedence.

tinycss2 and cssselect2 read the style sheets; they are imported only for drawings that have some.

Glossary
--------
property : what CSS can say of an element, such as ``fill``.
declared value : what one attribute or rule says of a property; the first valid one of an element counts (CSS Cascade 4).
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any
from xml.etree.ElementTree import Element

from attrs import frozen

from workhold.errors import InputError
from workhold.files.svg.document import Document, local_name, short

__all__ = ["GEOMETRY", "Declared", "Styles"]

# Properties and their values, in the order of the file.
Block = list[tuple[str, str]]

GEOMETRY = ("x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "d")
# Properties that say where a shape is or whether it is seen, and that an attribute of their name may set.
ATTRIBUTES = {"display", "visibility", "opacity", "overflow", "color", "clip-path", "clip", "mask", "filter"}
ATTRIBUTES |= {"fill", "fill-opacity", "stroke", "stroke-opacity", "stroke-width", "stroke-dasharray", "fill-rule"}
ATTRIBUTES |= {"marker-start", "marker-mid", "marker-end", "stop-opacity", "transform", "transform-origin", *GEOMETRY}
ONLY_STYLES = {"translate", "rotate", "scale", "transform-box", "overflow-x", "overflow-y", "mask-image", "mask-border"}
ONLY_STYLES |= {"marker", "offset", "offset-path", "animation", "animation-name", "zoom", "all"}
KNOWN = ATTRIBUTES | ONLY_STYLES
HARMLESS_RULES = {"charset", "font-face", "page", "keyframes", "-webkit-keyframes", "counter-style", "property"}
SCREENS = {"", "all", "screen", "only screen"}


@frozen
class Declared:
    """A declared value, and whether a style sheet or ``style`` gives it (CSS has stricter rules than attributes)."""

    text: str
    css: bool


class Styles:
    """The declared values of a document's elements.

    Raises
    ------
    InputError
        For rules of a style sheet that are not read and could change an outline, naming the style and its line.
    """

    def __init__(self, document: Document) -> None:
        self.document = document
        self.matched: dict[Element, list[tuple[tuple[Any, ...], Block]]] = {}
        styles = [e for e in document.root.iter() if local_name(e) == "style" and read_as_css(e)]
        if styles:
            self.match(styles)

    def match(self, styles: list[Element]) -> None:
        """Note which rules select which elements."""
        import cssselect2

        matcher = cssselect2.Matcher()
        for style in styles:
            place = f"the style sheet on line {self.document.line(style)}"
            refuse_media(style.get("media", ""), place)
            for selectors, declarations in rules("".join(style.itertext()), place):
                for selector in selectors:
                    if selector.pseudo_element is None:
                        matcher.add_selector(selector, declarations)
        for wrapper in cssselect2.ElementWrapper.from_xml_root(self.document.root).iter_subtree():
            found = [
                ((important, *specificity, order), values)
                for specificity, order, _, declarations in matcher.match(wrapper)
                for important, values in enumerate(declarations)
            ]
            self.matched[wrapper.etree_element] = found

    def of(self, element: Element) -> dict[str, list[Declared]]:
        """The declared values of an element's properties, the strongest first."""
        layers: list[tuple[tuple[Any, ...], Block, bool]]
        layers = [((0, -1), [item for item in element.items() if item[0] in ATTRIBUTES], False)]
        layers += [(key, values, True) for key, values in self.matched.get(element, ())]
        if element.get("style"):
            place = f"the style of {self.document.name(element)}"
            for important, values in enumerate(declared(element.get("style", ""), place)):
                layers.append(((important, 1 << 30), values, True))
        found: dict[str, list[Declared]] = defaultdict(list)
        for _, values, css in sorted(layers, key=lambda layer: layer[0], reverse=True):
            for name, text in reversed(values):
                found[name].append(Declared(text.strip(), css))
        return found


def read_as_css(style: Element) -> bool:
    """Whether a <style> holds CSS."""
    return style.get("type", "").strip().lower() in ("", "text/css")


def refuse_media(media: str, place: str) -> None:
    """Refuses styles for some screens or printers only.

    Raises
    ------
    InputError
        Naming the condition.
    """
    if " ".join(media.lower().split()) not in SCREENS:
        raise InputError(f"{place} is for '{short(media)}' only, which is not read: write the styles without it.")


def rules(text: str, place: str) -> list[tuple[Any, tuple[Block, Block]]]:
    """The rules of a style sheet: compiled selectors, and declarations (plain, important).

    Raises
    ------
    InputError
        For rules that are not read and could change an outline.
    """
    import cssselect2
    import tinycss2

    found = []
    for rule in tinycss2.parse_stylesheet(text, skip_comments=True, skip_whitespace=True):
        if rule.type == "at-rule":
            keyword, condition = rule.lower_at_keyword, tinycss2.serialize(rule.prelude).strip()
            if keyword == "media" and rule.content is not None:
                body = tinycss2.serialize(rule.content)
                inner = rules(body, f"@media of {place}")
                if inner:
                    refuse_media(condition, f"@media of {place}")
                found += inner
            elif keyword in HARMLESS_RULES:
                continue
            elif keyword == "import" or rule.content is None or rules(tinycss2.serialize(rule.content), place):
                raise InputError(f"{place} has @{keyword} {short(condition)}, which is not read: write plain rules.")
        elif rule.type == "qualified-rule":
            words = tinycss2.serialize(rule.prelude).strip()
            declarations = declared(rule.content, f"{short(words)} in {place}")
            if not any(declarations):
                continue
            try:
                found.append((cssselect2.compile_selector_list(rule.prelude), declarations))
            except cssselect2.SelectorError as error:
                raise InputError(
                    f"{place} has the selector '{short(words)}', which is not read: use classes."
                ) from error
    return found


def declared(content: Any, place: str) -> tuple[Block, Block]:
    """The known properties of a block of declarations: plain ones, and important ones.

    Raises
    ------
    InputError
        For rules within the block.
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
            (important if item.important else plain).append((name, serialized(item.value)))
    return plain, important


def serialized(tokens: Any) -> str:
    """A value as text, without comments."""
    import tinycss2

    return str(tinycss2.serialize([token for token in tokens if token.type != "comment"])).strip()
