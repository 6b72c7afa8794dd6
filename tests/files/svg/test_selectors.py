"""Which elements selectors select: what cssselect2 says where it has time to say it, and in time where it has not."""

from __future__ import annotations

import random
from xml.etree import ElementTree

import cssselect2
import pytest
import tinycss2

from workhold.files.budget import LIMITS, UNLIMITED, Budget
from workhold.files.svg.selectors import SelectorMatcher

TAGS, CLASSES = ("g", "rect", "path"), ("a", "b")
COMPOUNDS = (
    "*",
    "g",
    "rect",
    ".a",
    ".b",
    "#i3",
    "rect.a",
    "g:first-child",
    ":not(.a)",
    ":is(g, .b)",
    "[class]",
)
COMPOUNDS += (":has(> rect)", ":has(.a)", ":nth-child(2n+1)", "path:last-of-type", ":root", ":where(rect)")


def random_tree(chance: random.Random, count: int) -> ElementTree.Element:
    """A tree of so many elements."""
    root = ElementTree.Element("g")
    known = [root]
    for number in range(count):
        attributes = {"id": f"i{number}"}
        if chance.random() < 0.6:
            attributes["class"] = " ".join(chance.sample(CLASSES, chance.randint(1, 2)))
        known.append(ElementTree.SubElement(chance.choice(known[-9:]), chance.choice(TAGS), attributes))
    return root


def random_selector(chance: random.Random) -> str:
    """Up to four compound selectors with combinators between them."""
    words = chance.choice(COMPOUNDS)
    for _ in range(chance.randrange(4)):
        words += chance.choice((" ", " ", ">", " > ", "+", "  ~ ", "/**/ ")) + chance.choice(COMPOUNDS)
    return words


def ours(sheet: str, root: ElementTree.Element) -> dict[str, list[tuple[int, ...]]]:
    """By the id of an element, specificity and number of the selectors that select it."""
    matcher = SelectorMatcher(Budget(LIMITS["style"]))
    for rule in tinycss2.parse_stylesheet(sheet, skip_whitespace=True):
        matcher.add(rule.prelude)
    found = matcher.match_elements(root, Budget(UNLIMITED))
    return {element.get("id", ""): selected for element, selected in found}


def theirs(sheet: str, root: ElementTree.Element) -> dict[str, list[tuple[int, ...]]]:
    """The same by cssselect2's own matcher."""
    matcher = cssselect2.Matcher()
    numbers = iter(range(1000))
    for rule in tinycss2.parse_stylesheet(sheet, skip_whitespace=True):
        for selector in cssselect2.compile_selector_list(rule.prelude):
            number = next(numbers)
            if selector.pseudo_element is None:
                matcher.add_selector(selector, number)
    return {
        wrapper.etree_element.get("id", ""): [
            (*weights, number) for weights, _, _, number in matcher.match(wrapper)
        ]
        for wrapper in cssselect2.ElementWrapper.from_xml_root(root).iter_subtree()
    }


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(40))
def test_selectors_select_what_they_say(seed: int) -> None:
    """Random selectors of random trees, by both ways of matching."""
    chance = random.Random(seed)
    root = random_tree(chance, 40)
    sheet = "".join(
        ",".join(random_selector(chance) for _ in range(chance.randint(1, 3))) + "{}" for _ in range(8)
    )
    assert ours(sheet, root) == theirs(sheet, root)


def test_ways_through_ancestors_and_siblings_are_not_tried_one_by_one() -> None:
    """Thirty choices among a hundred ancestors, and as many among siblings, are as quick as one."""
    root = ElementTree.Element("x")
    inner = root
    for _ in range(100):
        inner = ElementTree.SubElement(inner, "g")
    for number in range(3000):
        ElementTree.SubElement(inner, "rect", {"id": f"r{number}"})
    found = ours("y" + " g" * 30 + " rect{} x" + " g" * 30 + " rect{} y ~" + "rect~" * 30 + "rect{}", root)
    assert found["r0"] == found["r2999"] == [(0, 0, 32, 1)]


@pytest.mark.thorough
def test_thousands_of_combinators_are_as_good_as_one() -> None:
    """No recursion is as deep as a selector is long."""
    root = ElementTree.Element("g")
    ElementTree.SubElement(root, "rect", {"id": "r"})
    assert ours("g>" * 5000 + "rect{} g>rect{}", root)["r"] == [(0, 0, 2, 1)]


@pytest.mark.parametrize(
    "selector",
    [
        "", ">g", "g>", "g>>g", "g,,g", ":not(g rect)", ":is(g>rect)", ":has(:has(a))", ":has(:is(:has(a)))",
        ":nth-child(2 of rect)", "[*|a]", "svg|", "::before g", "a:x", ":nth-child(x)", "a" + ".b" * 200,
    ],
)  # fmt: skip
def test_what_is_no_selector_or_asks_too_much_is_refused(selector: str) -> None:
    """As cssselect2's own error, whatever it would raise, and before it asks anything of an element."""
    tokens = tinycss2.parse_component_value_list(selector)
    with pytest.raises(cssselect2.SelectorError):
        SelectorMatcher(Budget(LIMITS["style"])).add(tokens)


def test_pseudo_elements_select_no_element() -> None:
    """They are passed over, and others of their list are not."""
    root = ElementTree.Element("g", {"id": "r"})
    assert ours("g::before, g{}", root)["r"] == [(0, 0, 1, 0)]
