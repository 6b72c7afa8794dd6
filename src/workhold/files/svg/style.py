"""Which SVG elements are not shown: ``display`` and ``visibility`` as attribute, style, or simple style-sheet rule."""

from __future__ import annotations

import re
from xml.etree.ElementTree import Element

__all__ = ["hidden_selectors", "is_hidden", "is_invisible"]

RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
DISPLAY_NONE = re.compile(r"(?:^|;)\s*display\s*:\s*none\b")
VISIBILITY = re.compile(r"(?:^|;)\s*visibility\s*:\s*(\w+)")


def hidden_selectors(root: Element) -> frozenset[str]:
    """Simple selectors (``.class``, ``#id``, ``tag``) whose style-sheet rule says ``display: none``."""
    found: set[str] = set()
    for style in root.iter("{http://www.w3.org/2000/svg}style"):
        for selectors, rules in RULE.findall(COMMENT.sub("", "".join(style.itertext()))):
            if DISPLAY_NONE.search(rules):
                found.update(selector.strip() for selector in selectors.split(","))
    return frozenset(found)


def is_hidden(element: Element, selectors: frozenset[str], tag: str) -> bool:
    """Whether an element, with all that is in it, is not displayed."""
    if DISPLAY_NONE.search(element.get("style", "")) or element.get("display", "").strip() == "none":
        return True
    names = [tag, f"#{element.get('id')}", *(f".{name}" for name in element.get("class", "").split())]
    return any(name in selectors for name in names)


def is_invisible(element: Element, inherited: bool) -> bool:
    """Whether an element is invisible (``visibility`` is inherited, and a child may turn it on again)."""
    match = VISIBILITY.search(element.get("style", ""))
    value = match.group(1) if match else element.get("visibility", "").strip()
    return value in ("hidden", "collapse") if value and value != "inherit" else inherited
