"""What a field of a question to the program is to all who ask it: declared once, beside its value.

A question is an attrs class, such as a query or what stands on a setup sheet. A field that is made by
:func:`declare` says what its values look like, what they must be and what they mean. From that come the checks
of the constructor, the option of the command, the forms of requests, agents and files, their schemas, and what
the page shows.
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
# of zones, of ranges of angles, of names, of lengths, and of coefficients by name.
Form = Literal[
    "count", "length", "pitch", "span", "flat", "heights", "place", "point", "force", "power", "number",
    "stress", "choice", "flag", "text", "day", "holes", "directions", "rings", "faces", "zones", "angles", "names",
    "lengths", "coefficients",
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
    label : what the page calls it.
    hint : what stands in it while it is empty, which it may be then; None where it must be filled in.
    is_usual : whether it is seen without being asked for.
    several : whether more than one of the choices may be taken.
    choices : the values to choose among; none where a value is typed.
    when : values of other fields with which the page shows it.
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
    name : the key in files and requests, and the constructor's argument.
    form : what its values look like; see ``Form``.
    help : what it means, in a sentence or two.
    labels : what the page shows of it, more than once where that depends on another field; none where the page
        has another way.
    default : of the constructor, in requests and in files; ``REQUIRED`` where it must be given.
    least : what a number must be.
    most : the largest count that a server takes; None for no limit of its own.
    choices : the words that there are.
    section : of the command's help.
    called : its name in sentences, where that is not the field's own.
    word : its name as an option, where that is not the field's own.
    spelled : the whole option, where that is another still.
    needs : the field without which it is not asked.
    typed : the help of the option, where that is another than ``help``.
    typed_default : of the option, as it would be typed, where it follows from no default; "" otherwise.
    metavar : what stands for its value in the help, where that does not follow from the form.
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
        """Return a constructor's value, converted by its form;
        raise InputError for a value that the field cannot have.

        None is returned as it is where it is the default. Forms without a check return the value unchanged.
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

        ``wrong`` says in the message what is wrong with the number, and ``unit`` in what to give it.
        """
        number = convert_real(value, self.words)
        is_low = number <= 0 if self.least == "above 0" else number < 0 and self.least == "0"
        if not isfinite(number) or is_low:
            raise InputError(f"{self.words} {number:g} {wrong}: give {WANTED[self.least]}{unit}.")
        return number


def declare(
    form: Form, help: str, *labels: PageLabel, default: Any = None, converter: Any = None, **more: Any
) -> Any:
    """Return an attrs field that carries a :class:`Declaration`;
    the class needs :func:`check_fields` as its transformer.

    Parameters
    ----------
    form, help, labels : as in :class:`Declaration`.
    default : of the field; None where none is given.
    converter : of its values, in place of :meth:`Declaration.check_value`.
    more : further parameters of :class:`Declaration`.
    """
    said = Declaration("", form, help, labels, default=default, **more)
    return field(default=default, converter=converter, metadata={KEY: said})


def check_fields(question: type, those: list[Attribute[Any]]) -> list[Attribute[Any]]:
    """Return the attributes of a question, each declared one
    without a converter given :meth:`Declaration.check_value`.

    This is a field transformer of attrs.
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
    """Return the declarations of a question's fields in their order,
    those of the named sections, or all for None.

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
