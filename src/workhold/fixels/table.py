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
    """The limit that a field sets, and the words for lifting it.

    Parameters
    ----------
    rule : the limit in a few words, such as "rows of holes".
    bounds : the limited property: the pegs' bodies, the travel, the extent of a wall, or the holes.
    words : phrase for the toolkit without the limit, such as "with as many rows as needed".
    """

    rule: str
    bounds: Literal["bodies", "travel", "reach", "holes"]
    words: str


@frozen
class ToolkitField(Declaration):
    """A field of a toolkit: a :class:`workhold.asking.declaring.Declaration` with further data.

    Parameters
    ----------
    entry : advice on writing the field in a toolkit's file; empty if the field's form explains itself.
    missing : words for the field in the message that it is missing, such as "distance between holes".
    belongs_to : the part of a toolkit that the field describes; toolkits without this field lack that part.
    figure : name of the field in a list of a toolkit's figures; empty if it is shown elsewhere.
    unset : text in that list for a value of None; empty to leave fields with their default value out.
    follows : name of the field whose value is the default of this one; of a pitch, its x counts. A field with
        this default is left out of the list.
    is_always_shown : whether it is listed even with that default.
    at_least : name of the field whose value is the minimum of this one.
    below : message for a value below that minimum, with "{value}" and "{least}".
    allowed : the counts that are allowed; empty for all.
    lifted : the limit that the field sets, which its default lifts; None where it sets no limit.
    carriers, carrier_noun : for a field of holes, the names of the carriers that have them, and the word for
        such a carrier.
    is_optional_key : whether files leave the field out where its value is None, although its form is none of
        ``SILENT``.
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
    is_optional_key: bool = field(default=False, kw_only=True)

    @property
    def is_silent(self) -> bool:
        """Whether files omit the field if its value is None."""
        return self.form in SILENT or self.is_optional_key

    def relabel(self, *labels: PageLabel, **changes: Any) -> ToolkitField:
        """Return a copy of the field with other labels on the page, and with the attributes in ``changes``
        set to other values.
        """
        return evolve(self, labels=labels, **changes)


@frozen
class FieldTable:
    """The fields of a kind of toolkit, or of several kinds with the same fields.

    Parameters
    ----------
    noun : word for such a toolkit in files and requests.
    summary : what the fields describe, for a schema.
    fields : in the order of the page.
    """

    noun: str
    summary: str
    fields: tuple[ToolkitField, ...]
