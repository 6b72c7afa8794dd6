"""Matching of style sheets' selectors with elements, in time proportional to rules times elements.

cssselect2 decides about compound selectors, for one element alone. Combinators are followed from the root
inward, so that nothing is tried twice: matching from the inside outward tries every choice of ancestors,
whose number grows exponentially with the depth.

Glossary
--------
compound selector : conditions on one element, such as ``rect.a:not(.b)`` (Selectors 4, 3.1).
combinator : the relation between two compound selectors: a blank, ``>``, ``+`` or ``~``.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Any
from xml.etree.ElementTree import Element

from attrs import define

from workhold.files.budget import Budget

__all__ = ["SelectorMatcher", "list_inner_tokens"]

CHILD, NEXT, LATER, WITHIN = ">", "+", "~", " "
LOGICAL = ("is", "where", "not", "has")
# Parts of one compound selector: each is asked of every element.
MOST_PARTS = 200
Tokens = Sequence[Any]


def list_inner_tokens(token: Any) -> Tokens:
    """Return the tokens of tinycss2 inside a block or a function; [] for other tokens."""
    if token.type == "function":
        return list(token.arguments)
    return list(token.content) if token.type.endswith(" block") else []


@define
class OpenElement:
    """An element whose children are being visited.

    Sets of compound selectors are bit sets in ints; those of one selector have consecutive bits.

    Parameters
    ----------
    element : None around the root.
    reached : compound selectors that the element matches, if all compound selectors before them in the same
        selector are matched, too.
    around : the union of ``reached`` for this element and those around it.
    last, before : ``reached`` of the child visited last, and the union of ``reached`` for all children
        visited so far.
    """

    element: Element | None
    reached: int = 0
    around: int = 0
    last: int = 0
    before: int = 0


class SelectorMatcher:
    """A set of selectors that finds the elements each of them selects.

    Parameters
    ----------
    sheets : budget of the drawing's style sheets; each compound selector counts as an element.
    """

    def __init__(self, sheets: Budget) -> None:
        import cssselect2

        self.sheets = sheets
        # The names of elements, their classes and ids are looked up; all else is asked one by one.
        self.simple = cssselect2.Matcher()
        self.asked: list[tuple[Any, bool]] = []
        # Compound selectors by what stands before them; the first ones of selectors have nothing.
        self.after: defaultdict[str, int] = defaultdict(int)
        self.compounds = 0
        # By the compound selector that is its last: number and specificity of a selector.
        self.selectors: dict[int, tuple[int, tuple[int, ...]]] = {}
        self.count = 0

    def add(self, prelude: Tokens) -> list[int]:
        """Add a list of selectors separated by commas, and return their numbers; selectors of pseudo-elements
        have none.

        Raises
        ------
        cssselect2.SelectorError
            For selectors that are not of CSS, or would take too long.
        InputError
            For very many.
        """
        return [number for tokens in split_at_commas(prelude) for number in self.add_selector(tokens)]

    def add_selector(self, tokens: Tokens) -> list[int]:
        """Add one selector, and return a list with its number; [] for a selector of a pseudo-element."""
        import cssselect2

        chain = split_compound_selectors(tokens)
        compiled = []
        for _, compound in chain:
            refuse_slow(compound)
            self.sheets.spend(1 + count_tokens(compound) // 10)
            try:
                compiled += cssselect2.compile_selector_list(compound)
            except cssselect2.SelectorError:
                raise
            except Exception as error:  # cssselect2 raises many kinds for what it does not know
                raise cssselect2.SelectorError(None, "not known") from error
        if len(compiled) != len(chain):
            raise cssselect2.SelectorError(None, "an empty selector")
        pseudo = [one.pseudo_element is not None for one in compiled]
        if any(pseudo[:-1]):
            raise cssselect2.SelectorError(None, "something in a pseudo-element")
        if pseudo[-1]:
            return []
        for (combinator, compound), one in zip(chain, compiled, strict=True):
            slow = any(token.type in ("[] block", "function") or token == ":" for token in compound)
            matcher = cssselect2.Matcher() if slow else self.simple
            matcher.add_selector(one, self.compounds)
            if slow:
                self.asked.append((matcher, has_descendants(compound)))
            self.after[combinator] |= 1 << self.compounds
            self.compounds += 1
        weights = tuple(map(sum, zip(*(one.specificity for one in compiled), strict=True)))
        self.selectors[self.compounds - 1] = self.count, weights
        self.count += 1
        return [self.count - 1]

    def match_elements(
        self, root: Element, budget: Budget
    ) -> Iterator[tuple[Element, list[tuple[Any, ...]]]]:
        """Yield (element, rows) for every element of a tree.

        ``rows`` has one tuple (*specificity, number) for each selector that selects the element. Rows are
        sorted, from the weakest selector to the strongest.
        """
        import cssselect2

        after, open_elements = self.after, [OpenElement(None)]
        for wrapper in cssselect2.ElementWrapper.from_xml_root(root).iter_subtree():
            parent = None if wrapper.parent is None else wrapper.parent.etree_element
            while open_elements[-1].element is not parent:
                open_elements.pop()
            around = open_elements[-1]
            fulfilled = self.find_fulfilled(wrapper, budget)
            possible = (
                after[""]
                | after[WITHIN] & around.around << 1
                | after[CHILD] & around.reached << 1
                | after[NEXT] & around.last << 1
                | after[LATER] & around.before << 1
            )
            found = [compound for compound in fulfilled if possible >> compound & 1]
            reached = sum(1 << compound for compound in found)
            around.last, around.before = reached, around.before | reached
            open_elements.append(OpenElement(wrapper.etree_element, reached, around.around | reached))
            selected = [self.selectors[compound] for compound in found if compound in self.selectors]
            yield wrapper.etree_element, sorted((*weights, number) for number, weights in selected)

    def find_fulfilled(self, wrapper: Any, budget: Budget) -> list[int]:
        """Return the numbers of the compound selectors that an element matches by itself."""
        budget.count_steps(1 + self.compounds // 32)
        found = [compound for *_, compound in self.simple.match(wrapper)]
        for matcher, descends in self.asked:
            # Some look at all the children around, or at all that is inside.
            below = sum(1 for _ in wrapper.etree_element.iter()) if descends else 0
            budget.count_steps(1 + len(wrapper.etree_siblings) + below)
            found += [compound for *_, compound in matcher.match(wrapper)]
        return found


def split_at_commas(tokens: Tokens) -> list[list[Any]]:
    """Return the tokens of each selector of a list, without comments."""
    parts: list[list[Any]] = [[]]
    for token in tokens:
        if token == ",":
            parts.append([])
        elif token.type != "comment":
            parts[-1].append(token)
    return parts


def split_compound_selectors(tokens: Tokens) -> list[tuple[str, list[Any]]]:
    """Return (combinator, tokens) for each compound selector of one selector; the combinator is the one in
    front of it, "" for the first.

    Raises cssselect2.SelectorError for combinators with nothing before or after them.
    """
    import cssselect2

    chain: list[tuple[str, list[Any]]] = []
    combinator = ""
    for token in trim_blanks(tokens):
        if token.type == "whitespace":
            combinator = combinator or WITHIN
        elif token in (CHILD, NEXT, LATER):
            if combinator not in ("", WITHIN) or not chain:
                raise cssselect2.SelectorError(token, "a combinator without a selector")
            combinator = token.value
        elif combinator or not chain:
            chain.append((combinator, [token]))
            combinator = ""
        else:
            chain[-1][1].append(token)
    if combinator or not chain:
        raise cssselect2.SelectorError(None, "a selector without an end")
    return chain


def trim_blanks(tokens: Tokens) -> list[Any]:
    """Return the tokens without blanks at both ends."""
    blank = [token.type == "whitespace" for token in tokens]
    if all(blank):
        return []
    return list(tokens[blank.index(False) : len(blank) - blank[::-1].index(False)])


def refuse_slow(compound: Tokens, relational: bool = False) -> None:
    """Raise cssselect2.SelectorError for a compound selector that cssselect2 would match too slowly.

    Such a selector has many parts, combinators within a part, ``:has`` inside ``:has``, or "of" inside
    ``:nth-child``. ``relational`` says whether the tokens are inside a ``:has``.
    """
    import cssselect2

    error = cssselect2.SelectorError(None, "too much to ask of every element")
    if count_tokens(compound) > MOST_PARTS:
        raise error
    for token in compound:
        if token.type != "function":
            continue
        if token.lower_name not in LOGICAL:
            if any(one.type == "ident" and one.value == "of" for one in token.arguments):
                raise error
            continue
        has = token.lower_name == "has"
        for tokens in map(trim_blanks, split_at_commas(token.arguments)):
            if has and tokens and tokens[0] in (CHILD, NEXT, LATER):
                tokens = trim_blanks(tokens[1:])
            if tokens and (len(split_compound_selectors(tokens)) > 1 or (has and relational)):
                raise error
            refuse_slow(tokens, relational or has)


def count_tokens(tokens: Tokens) -> int:
    """Return the number of tokens, including those in blocks and functions."""
    return sum(1 + count_tokens(list_inner_tokens(token)) for token in tokens)


def has_descendants(tokens: Tokens) -> bool:
    """Return whether a compound selector has conditions on what is inside an element."""
    return any(
        (token.type == "function" and token.lower_name == "has") or has_descendants(list_inner_tokens(token))
        for token in tokens
    )
