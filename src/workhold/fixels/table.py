"""What a field of a toolkit is to all who read, check, ask for and show it: a row of a table.

Glossary
--------
table : the rows of one kind of toolkit, in the order in which the page shows them.
noun : of a table, what its files and requests call a toolkit; kinds that differ in no field share a table.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from attrs import evolve, field, frozen

__all__ = [
    "CLAMPS_SECTION",
    "HEIGHTS_SECTION",
    "REQUIRED",
    "SILENT",
    "TOOLKIT_SECTION",
    "Choice",
    "FieldTable",
    "Form",
    "Lifted",
    "PageLabel",
    "ToolkitField",
]

# What a value looks like: a whole number; lengths, one or two for x and y, or the least and the most; a
# flat's distance with or without half its width; the heights between which something touches; names of holes;
# directions or pairs of them; rings about points; a stress in MPa.
Form = Literal[
    "count", "length", "pitch", "span", "flat", "heights", "holes", "directions", "rings", "stress"
]
# What stands for a value of a form in the help of the command.
METAVARS: Mapping[Form, str] = {
    "count": "N",
    "length": "LENGTH",
    "pitch": "X[,Y]",
    "span": "LEAST,MOST",
    "flat": "DISTANCE[,WIDTH/2]",
    "heights": "LOW,HIGH",
    "holes": "HOLES",
    "directions": "LIST",
    "rings": "X,Y,LEAST,MOST",
    "stress": "MPA",
}
# Forms of which files say nothing where there is none.
SILENT: frozenset[Form] = frozenset({"flat", "heights"})
# Sections of the command's help.
TOOLKIT_SECTION, CLAMPS_SECTION = "The toolkit", "The clamps of a plate or fence"
HEIGHTS_SECTION = "Heights other than those of all pegs"
# The default of a field that must be given.
REQUIRED = object()


@frozen
class Choice:
    """One of several values of a field, and what the page calls it."""

    value: Any
    words: str


@frozen
class PageLabel:
    """What the page shows of a field.

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
class Lifted:
    """How a limit that a field sets is lifted.

    Parameters
    ----------
    rule : what it asks, in a few words, such as "rows of holes".
    bounds : whether it is about the pegs' bodies, the travel, or the holes there are.
    words : the toolkit without it, in words that follow its name.
    """

    rule: str
    bounds: Literal["bodies", "travel", "reach", "holes"]
    words: str


@frozen
class ToolkitField:
    """A field of a toolkit.

    Parameters
    ----------
    name : the key in files and requests, and the constructor's argument.
    form : what its values look like; see ``Form``.
    help : of the command line's option, for which "{option}" stands in it.
    labels : what the page shows of it, more than once where that depends on another field.
    default : in requests and in result files; ``REQUIRED`` where it must be given.
    entry : what to write in a toolkit's file; empty where the form says enough.
    missing : what is not given where it must be, in a sentence.
    belongs_to : the part of a toolkit that it describes, which toolkits without this field have not.
    least : what a length must be: "above 0", "0" or "any".
    most : the largest count that a server takes; None for no limit of its own.
    figure : what it is called among the figures of a toolkit; empty where it is shown in another way.
    unset : what stands there for a value of None; where it is empty, a default is no figure.
    follows : the field whose value is the default of this one, with which it is no figure; of a pitch that in
        x.
    is_always_shown : whether it is a figure also where it has the value that it follows.
    at_least, below : the field whose value is the least of this one, and the sentence for what is below, with
        "{value}" and "{least}".
    allowed : the only counts that there are; empty where all are.
    lifted : how the limit that it sets is lifted, for which its default stands; None where it sets none.
    carriers, carrier_noun : of holes the names of the carriers that have them, and what one of these is
        called.
    section : of the command's help.
    word : its name as an option, where that is not the field's own.
    metavar : what stands for its value in the help, where that does not follow from the form.
    """

    name: str
    form: Form
    help: str
    labels: tuple[PageLabel, ...]
    default: Any = field(default=None, kw_only=True)
    entry: str = field(default="", kw_only=True)
    missing: str = field(default="", kw_only=True)
    belongs_to: str = field(default="", kw_only=True)
    least: Literal["above 0", "0", "any"] = field(default="above 0", kw_only=True)
    most: int | None = field(default=None, kw_only=True)
    figure: str = field(default="", kw_only=True)
    unset: str = field(default="", kw_only=True)
    follows: str = field(default="", kw_only=True)
    is_always_shown: bool = field(default=False, kw_only=True)
    at_least: str = field(default="", kw_only=True)
    below: str = field(default="", kw_only=True)
    allowed: tuple[int, ...] = field(default=(), kw_only=True)
    lifted: Lifted | None = field(default=None, kw_only=True)
    carriers: tuple[str, ...] = field(default=(), kw_only=True)
    carrier_noun: str = field(default="", kw_only=True)
    section: str = field(default=TOOLKIT_SECTION, kw_only=True)
    word: str = field(default="", kw_only=True)
    metavar: str = field(kw_only=True)

    @metavar.default
    def usual_metavar(self) -> str:
        return METAVARS[self.form]

    @property
    def option(self) -> str:
        return f"--{(self.word or self.name).replace('_', '-')}"

    @property
    def words(self) -> str:
        """The name in sentences."""
        return self.name.replace("_", " ")

    @property
    def is_required(self) -> bool:
        return self.default is REQUIRED

    def shown(self, *labels: PageLabel, **changes: Any) -> ToolkitField:
        """Returns the field of another kind of toolkit, with other labels on the page and further changes."""
        return evolve(self, labels=labels, **changes)


@frozen
class FieldTable:
    """The fields of toolkits that share them all.

    Parameters
    ----------
    noun : see the glossary of the module.
    summary : what the fields describe, for a schema.
    fields : in the order of the page.
    """

    noun: str
    summary: str
    fields: tuple[ToolkitField, ...]
