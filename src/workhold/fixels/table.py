"""The declaration of a toolkit's field, a row of a table, for all that read, check, ask for or show it.

Glossary
--------
table : the rows of one kind of toolkit, in the order in which the page shows them.
noun : of a table, what its files and requests call a toolkit; kinds that differ in no field share a table.
"""

from __future__ import annotations

from typing import Any, Literal

from attrs import evolve, field, frozen

from workhold.asking.declaring import REQUIRED, Choice, Declaration, Form, PageLabel

__all__ = [
    "CLAMPS_SECTION",
    "HEIGHTS_SECTION",
    "REQUIRED",
    "SILENT",
    "TOOLKIT_SECTION",
    "Choice",
    "FieldTable",
    "Form",
    "LiftedLimit",
    "PageLabel",
    "ToolkitField",
]

# Forms of which files say nothing where there is none.
SILENT: frozenset[Form] = frozenset({"flat", "heights"})
# Sections of the command's help.
TOOLKIT_SECTION, CLAMPS_SECTION = "The toolkit", "The clamps of a plate or fence"
HEIGHTS_SECTION = "Heights other than the heights of all pegs"


@frozen
class LiftedLimit:
    """How to lift a limit that a field sets.

    Parameters
    ----------
    rule : what the limit requires, in a few words, such as "rows of holes".
    bounds : what it limits: the pegs' bodies, the travel, how far a wall reaches, or the holes.
    words : phrase for the toolkit without the limit.
    """

    rule: str
    bounds: Literal["bodies", "travel", "reach", "holes"]
    words: str


@frozen
class ToolkitField(Declaration):
    """A field of a toolkit; what any field has, :class:`workhold.asking.declaring.Declaration` says.

    Parameters
    ----------
    entry : what to write in a toolkit's file; empty where the form says enough.
    missing : what is not given where it must be, in a sentence.
    belongs_to : the part of a toolkit that it describes, which toolkits without this field have not.
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
    """

    entry: str = field(default="", kw_only=True)
    missing: str = field(default="", kw_only=True)
    belongs_to: str = field(default="", kw_only=True)
    figure: str = field(default="", kw_only=True)
    unset: str = field(default="", kw_only=True)
    follows: str = field(default="", kw_only=True)
    is_always_shown: bool = field(default=False, kw_only=True)
    at_least: str = field(default="", kw_only=True)
    below: str = field(default="", kw_only=True)
    allowed: tuple[int, ...] = field(default=(), kw_only=True)
    lifted: LiftedLimit | None = field(default=None, kw_only=True)
    carriers: tuple[str, ...] = field(default=(), kw_only=True)
    carrier_noun: str = field(default="", kw_only=True)
    section: str | None = field(default=TOOLKIT_SECTION, kw_only=True)

    def relabel(self, *labels: PageLabel, **changes: Any) -> ToolkitField:
        """Return a copy of the field with other labels on the
        page and further changes, for another kind of toolkit.
        """
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
