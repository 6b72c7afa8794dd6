"""Declarations of a question's fields: each field is declared once, for commands, requests, files and the
page.

A question is an attrs class, such as a query or the contents of a setup sheet. A field that is made by
:func:`declare` says what its values look like, what they must be and what they mean. From that come the
checks of the constructor, the option of the command, the forms of requests, agents and files, their schemas,
and what the page shows.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from math import isfinite
from typing import Any, Literal

from attrs import Attribute, evolve, field, fields, frozen

from workhold.errors import InputError
from workhold.limits import check_count, convert_real, refuse_long, refuse_strong

__all__ = [
    "METAVARS",
    "REQUIRED",
    "Choice",
    "Declaration",
    "Form",
    "Least",
    "PageLabel",
    "check_fields",
    "list_declarations",
    "declare",
    "collect_declared_values",
]

# What a value looks like: a whole number; lengths, one or two for x and y, or the least and the most; a flat's
# distance with or without half its width; the heights between which something touches; a place; a point; a
# force in N; a power in kW; a plain number; a stress in MPa; one of several words; whether something is so; text;
# a day; and lists of names of holes, of directions or pairs of them, of rings about points, of numbers of faces,
# of zones, of ranges of angles, of names, of lengths, and of coefficients and of margins by name.
Form = Literal[
    "count", "length", "pitch", "span", "flat", "heights", "place", "point", "force", "power", "number",
    "stress", "choice", "flag", "text", "day", "holes", "directions", "rings", "faces", "zones", "angles", "names",
    "lengths", "coefficients", "margins",
]  # fmt: skip
# What stands for a value of a form in the help of the command.
METAVARS: Mapping[Form, str] = {
    "count": "N",
    "length": "LENGTH",
    "pitch": "X[,Y]",
    "span": "LEAST,MOST",
    "flat": "DISTANCE[,WIDTH/2]",
    "heights": "LOW,HIGH",
    "place": "X,Y",
    "point": "X,Y,Z",
    "force": "FORCE",
    "power": "KW",
    "number": "NUMBER",
    "stress": "MPA",
    "text": "WORDS",
    "day": "YYYY-MM-DD",
    "holes": "HOLES",
    "directions": "LIST",
    "rings": "X,Y,LEAST,MOST",
    "faces": "FACES",
    "zones": "ZONE",
    "angles": "FROM..TO",
    "names": "NAME",
    "lengths": "LENGTHS",
    "coefficients": "NAME=NUMBER",
    "margins": "side=S,top=T,bottom=B",
}
Least = Literal["above 0", "0", "any"]
# What a number must be, by the least that it may be.
WANTED: Mapping[Least, str] = {"above 0": "more than 0", "0": "0 or more", "any": "a finite number"}
# The default of a field that must be given.
REQUIRED = object()
# Where the declaration stands in the metadata of an attrs field.
KEY = "declaration"


@frozen
class Choice:
    """One of several values of a field, and what the page calls it."""

    value: Any
    words: str


@frozen
class PageLabel:
    """A field as the page shows it.

    Parameters
    ----------
    label : the field's name on the page.
    hint : placeholder while the field is empty, where it may be empty; None where it must be filled in.
    is_usual : whether the page shows the field at once, not among further options.
    several : whether more than one of the choices may be taken.
    choices : the values to choose among; empty where a value is typed.
    when : values of other fields under which the page shows this one.
    """

    label: str
    hint: str | None = None
    is_usual: bool = False
    several: bool = False
    choices: tuple[Choice, ...] = ()
    when: Mapping[str, Any] = {}


@frozen
class Declaration:
    """A field of a question.

    Parameters
    ----------
    name : key in files and requests, and argument of the constructor.
    form : kind of its values; see ``Form``.
    help : meaning of the field, in a sentence or two.
    labels : labels on the page, more than one where they depend on another field; empty where the page asks
        in another way.
    default : default in the constructor, in requests and in files; ``REQUIRED`` where a value must be given.
    least : least number allowed.
    most : largest count that a server accepts; None for no limit of its own.
    choices : words allowed.
    section : section of the command's help.
    called : name in sentences, where it is not the field's name.
    word : name as an option, where it is not the field's name.
    spelled : the whole option as typed, where it does not follow from ``word`` or the name.
    needs : name of the field without which this one has no meaning.
    typed : help of the option, where it is not ``help``.
    typed_default : default of the option as it would be typed, where it does not follow from ``default``; ""
        otherwise.
    metavar : placeholder for the value in the help, where it does not follow from the form.
    """

    name: str
    form: Form
    help: str
    labels: tuple[PageLabel, ...] = ()
    default: Any = field(default=None, kw_only=True)
    least: Least = field(default="above 0", kw_only=True)
    most: int | None = field(default=None, kw_only=True)
    choices: tuple[str, ...] = field(default=(), kw_only=True)
    section: str | None = field(default=None, kw_only=True)
    called: str = field(default="", kw_only=True)
    word: str = field(default="", kw_only=True)
    spelled: str = field(default="", kw_only=True)
    needs: str = field(default="", kw_only=True)
    typed: str = field(default="", kw_only=True)
    typed_default: str = field(default="", kw_only=True)
    metavar: str = field(kw_only=True)

    @metavar.default
    def make_usual_metavar(self) -> str:
        """Return the choices joined by "|", else the usual placeholder of the form, "" where it has none."""
        return "|".join(self.choices) or METAVARS.get(self.form, "")

    @property
    def argument(self) -> str:
        """Name of the option as an identifier: ``word``, else ``name``."""
        return self.word or self.name

    @property
    def option(self) -> str:
        """Option as typed, such as "--jaw-force"."""
        return self.spelled or f"--{self.argument.replace('_', '-')}"

    @property
    def words(self) -> str:
        """Name in sentences: ``called``, else ``name`` with spaces."""
        return self.called or self.name.replace("_", " ")

    @property
    def is_required(self) -> bool:
        """Whether the field has no default."""
        return self.default is REQUIRED

    def check_value(self, value: Any) -> Any:
        """Return a value given to the constructor, converted by the field's form.

        Raises InputError for a value that the field cannot have. None is returned as it is where it is the
        default. Forms without a check return the value unchanged.
        """
        if value is None and self.default is None:
            return None
        match self.form:
            case "length":
                number = self.convert_number(value, "is not a length", ", in mm")
                refuse_long(self.words, number)
                return number
            case "force":
                number = self.convert_number(value, "cannot be used", ", in N")
                refuse_strong(self.words, number)
                return number
            case "number":
                return self.convert_number(value, "cannot be used", "")
            case "count":
                return check_count(self.words, value)
            case "choice" if value not in self.choices:
                few = f"{', '.join(self.choices[:-1])} or {self.choices[-1]}"
                raise InputError(f"the {self.words} cannot be {value!r}: choose {few}.")
        return value

    def convert_number(self, value: Any, wrong: str, unit: str) -> float:
        """Return a finite float of at least ``least``; raise InputError for anything else.

        In the message, ``wrong`` says what is wrong with the number, and ``unit`` names the unit to give it
        in.
        """
        number = convert_real(value, self.words)
        is_low = number <= 0 if self.least == "above 0" else number < 0 and self.least == "0"
        if not isfinite(number) or is_low:
            raise InputError(f"{self.words} {number:g} {wrong}: give {WANTED[self.least]}{unit}.")
        return number


def declare(
    form: Form, help: str, *labels: PageLabel, default: Any = None, converter: Any = None, **more: Any
) -> Any:
    """Return an attrs field that carries a :class:`Declaration`.

    The class of the field needs :func:`check_fields` as its field transformer.

    Parameters
    ----------
    form, help, labels : as in :class:`Declaration`.
    default : default of the field; None where none is given.
    converter : converter of its values, used instead of :meth:`Declaration.check_value`.
    more : further parameters of :class:`Declaration`.
    """
    said = Declaration("", form, help, labels, default=default, **more)
    return field(default=default, converter=converter, metadata={KEY: said})


def check_fields(question: type, those: list[Attribute[Any]]) -> list[Attribute[Any]]:
    """Return the attributes of a question, with :meth:`Declaration.check_value` as the converter of declared
    ones.

    A declared attribute that has a converter keeps it. This is a field transformer of attrs.
    """
    return [
        one.evolve(converter=partial(Declaration.check_value, find_declaration(one)))
        if KEY in one.metadata and one.converter is None
        else one
        for one in those
    ]


def find_declaration(one: Attribute[Any]) -> Declaration:
    """Return the declaration that a declared attrs attribute carries, with the attribute's name."""
    said: Declaration = one.metadata[KEY]
    return evolve(said, name=one.name)


def list_declarations(
    question: type, sections: Iterable[str | None] | None = None
) -> tuple[Declaration, ...]:
    """Return the declarations of a question's fields, in order.

    Only those whose section is in ``sections`` are returned, or all for None.

    Examples
    --------
    >>> from workhold.asking.search import SearchQuestion
    >>> [row.option for row in list_declarations(SearchQuestion, ["Seating"])]
    ['--seating', '--opening', '--foolproof']
    """
    rows = (find_declaration(one) for one in fields(question) if KEY in one.metadata)
    wanted = None if sections is None else set(sections)
    return tuple(row for row in rows if wanted is None or row.section in wanted)


def collect_declared_values(question: Any) -> dict[str, Any]:
    """Return the values of a question's declared fields by name;
    fields that are not declared are left out.
    """
    return {row.name: getattr(question, row.name) for row in list_declarations(type(question))}
