"""The kinds of toolkits as the page shows them: their names, and the fields of their forms.

The page draws its fields from this data alone, which is made from the data of the kinds.

Glossary
--------
said : fields whose values follow from the name of a kind, such as the one column of a gripper.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from attrs import asdict, frozen

from workhold.asking.declaring import Choice, Declaration, list_declarations
from workhold.asking.search import RestrictionQuestion, SearchQuestion
from workhold.asking.sheet import SheetQuestion
from workhold.drawing.panel import describe_arrangement
from workhold.files.result.writer import make_toolkit_fields
from workhold.files.toolkit_file import LoadedToolkit
from workhold.fixels.kinds import PAGES, find_table, make_toolkit, resolve_kind
from workhold.fixels.setup_words import PageWords
from workhold.fixels.support_hardware import HARDWARE

__all__ = [
    "DESCRIBED",
    "DescribedToolkit",
    "describe_kinds",
    "choose_page_kind",
    "describe_questions",
    "describe_toolkit",
]


# How the page reads a form of field where it has no form of its own for it; choices are taken by "one" or
# "several".
PAGE_FORMS: Mapping[str, str] = {"flat": "length", "heights": "span"}


@frozen
class PageField:
    """A field of the page. :class:`workhold.asking.declaring.PageLabel` explains the attributes that the
    declaration does not have.

    A field of hardware is in a ``table`` of the toolkit, a field of a question in one named after the
    question.
    """

    name: str
    label: str
    form: str
    hint: str | None
    is_usual: bool
    least: str
    choices: tuple[Choice, ...]
    when: Mapping[str, Any]
    table: str | None = None


def list_page_fields(row: Declaration, table: str | None = None) -> Iterator[PageField]:
    """Yield a field of the page for each label of a declared field.

    ``table`` is the name of the field's table.
    """
    for one in row.labels:
        choosing = "several" if one.several else "one"
        form = choosing if one.choices else PAGE_FORMS.get(row.form, row.form)
        yield PageField(
            row.name, one.label, form, one.hint, one.is_usual, row.least, one.choices, one.when, table
        )


@frozen
class DescribedToolkit:
    """A kind of toolkit as the page shows it.

    Parameters
    ----------
    name : name of the kind, or an alias of one in ``fixels.kinds``.
    words : the page's name of the kind, and the values that its fields begin with.
    """

    name: str
    words: PageWords

    @property
    def said(self) -> Mapping[str, Any]:
        """Fields with values that follow from the kind's name."""
        return resolve_kind(self.name)[1]

    @property
    def fields(self) -> tuple[PageField, ...]:
        """Fields of the page: those of the kind, except fields whose values follow from the kind's name."""
        rows = (row for row in find_table(resolve_kind(self.name)[0]).fields if row.name not in self.said)
        return tuple(one for row in rows for one in list_page_fields(row))

    @property
    def roles(self) -> dict[str, str]:
        """By name of a field that gives heights, the role of the carriers that have these heights."""
        any_heights = (1.0, 2.0)
        return {
            row.name: role
            for row in find_table(resolve_kind(self.name)[0]).fields
            if row.form == "heights"
            for role in make_toolkit(self.name, {**self.words.start, row.name: any_heights}).heights
        }

    def answer(self) -> dict[str, Any]:
        """Return the kind as plain data: names, usual values, arrangements and fields."""
        toolkit = make_toolkit(self.name, self.words.start)
        types = {one.name: describe_arrangement(one, toolkit) for one in toolkit.arrangements}
        return {
            "name": self.name,
            "kind": toolkit.kind,
            "title": self.words.title,
            "noun": self.name if self.said else toolkit.noun,
            "mover": toolkit.moving.noun,
            "locked": toolkit.locked,
            "closes": self.words.closes,
            "by_friction": toolkit.holds_by_friction,
            "said": dict(self.said),
            "start": dict(self.words.start),
            "types": [{"name": name, "words": words} for name, words in types.items()],
            "fields": [asdict(one) for one in self.fields],
            "hardware": describe_hardware(),
            "roles": self.roles,
        }


def describe_questions() -> dict[str, list[dict[str, Any]]]:
    """Return the page's fields of restrictions, search and sheet as plain data, each with section and help."""
    questions = {"restrictions": RestrictionQuestion, "search": SearchQuestion, "sheet": SheetQuestion}
    return {
        name: [
            asdict(one) | {"section": row.section, "help": row.help, "needs": row.needs}
            for row in list_declarations(question)
            for one in list_page_fields(row, name)
        ]
        for name, question in questions.items()
    }


def describe_hardware() -> list[dict[str, Any]]:
    """Return the page's fields of supports, clamp and other hardware, as plain data."""
    return [
        {
            "name": name,
            "title": kind.table.summary,
            "fields": [asdict(one) for row in kind.table.fields for one in list_page_fields(row, name)],
        }
        for name, kind in HARDWARE.items()
    ]


DESCRIBED = tuple(DescribedToolkit(name, words) for name, words in PAGES.items())


def describe_kinds() -> list[dict[str, Any]]:
    """Return all kinds of toolkits as plain data."""
    return [one.answer() for one in DESCRIBED]


def choose_page_kind(loaded: LoadedToolkit) -> str:
    """Return the name of the kind under which the page shows a toolkit.

    Of the kinds that fit, it is the one whose name determines the most fields.
    """
    fits = [
        one
        for one in DESCRIBED
        if resolve_kind(one.name)[0] == loaded.kind and one.said.items() <= loaded.fields.items()
    ]
    return max(fits, key=lambda one: len(one.said)).name


def describe_toolkit(loaded: LoadedToolkit) -> dict[str, Any]:
    """Return a preset as plain data; its kind is one that the page has fields for."""
    given = make_toolkit_fields(loaded.toolkit)
    return {
        "name": loaded.name,
        "kind": choose_page_kind(loaded),
        "title": loaded.title,
        "source": loaded.source,
        "unit": loaded.unit.name,
        "assumed": list(loaded.assumed),
        "fields": {key: value for key, value in given.items() if key in loaded.fields},
        "tolerance": asdict(loaded.tolerance),
    }
