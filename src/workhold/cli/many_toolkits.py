"""Many toolkits at once, as the commands that try them all take them: names, files, kinds, and lists of figures."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from attrs import frozen

from workhold.cli.search_options import with_fit_of
from workhold.cli.values import length, whole_number
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.query import Query
    from workhold.model.tolerance import Tolerance
    from workhold.model.workpiece import Workpiece

__all__ = ["MOST_TOOLKITS", "Named", "toolkits_to_try", "query_of", "words_of"]

# More toolkits than this are more likely a slip than a wish.
MOST_TOOLKITS = 1000


@frozen
class Named:
    """A toolkit to try: what it is called, its kind and keyword arguments, and its tolerance where it has one."""

    name: str
    kind: str
    fields: dict[str, Any]
    tolerance: Tolerance | None = None

    def changed(self, changes: list[tuple[str, dict[str, Any]]]) -> Named:
        """The toolkit after changes, each of which has a name."""
        name = ", ".join(filter(None, (self.name, *(words for words, _ in changes))))
        fields = {key: value for _, change in changes for key, value in change.items()}
        return Named(name, self.kind, self.fields | fields, self.tolerance)


def query_of(workpiece: Workpiece, named: Named, asked: dict[str, Any]) -> Query | InputError:
    """The query for a toolkit, or why there is no such toolkit."""
    from workhold.fixels.kinds import toolkit_of
    from workhold.model.query import Query

    try:
        return Query(
            workpiece,
            toolkit_of(named.kind, named.fields),
            **asked | {"tolerance": with_fit_of(asked["tolerance"], named.tolerance)},
        )
    except InputError as error:
        return error


def toolkits_to_try(
    names: list[str] | None,
    toolkit: str | None,
    pitch: str | None,
    columns: str | None,
    peg_radius: str | None,
    unit: Unit,
) -> list[Named]:
    """The toolkits to try.

    Raises
    ------
    InputError
        For words that mean nothing, lists that do not make a toolkit, and more than a thousand toolkits.
    """
    from workhold.files.toolkit.presets import load_toolkit, preset_names
    from workhold.fixels.kinds import ALIASES, KINDS, USUAL, kind_of, table_of

    is_kind = toolkit is not None and toolkit.lower() in (*KINDS, *ALIASES)
    kind, said = kind_of(toolkit.lower()) if toolkit is not None and is_kind else (None, {})
    if toolkit is not None and not is_kind:
        names = [*(names or ()), toolkit]
    lists: list[list[tuple[str, dict[str, Any]]]] = []
    if pitch is not None:
        lists.append([(f"pitch {word}", {"pitch": pitch_of(word, unit)}) for word in words_of("--pitch", pitch)])
    if columns is not None:
        numbers = [whole_number("--columns", word) for word in words_of("--columns", columns)]
        lists.append([(f"{number} column{'s' if number != 1 else ''}", {"columns": number}) for number in numbers])
    if peg_radius is not None:
        radii = [(word, length("--peg-radius", word, unit)) for word in words_of("--peg-radius", peg_radius)]
        lists.append([(f"radius {word}", {"peg_radius": radius}) for word, radius in radii])
    if names is None and pitch is not None:
        listed = {"columns": columns, "peg_radius": peg_radius}
        needed = {row.name for row in table_of(kind or USUAL).fields if row.is_required}
        if any(name in needed and name not in said and text is None for name, text in listed.items()):
            raise InputError("a list of pitches alone makes no vise: give --columns and --peg-radius too, or --vise.")
        bases = [Named("", kind or USUAL, dict(said))]
    else:
        asked = preset_names() if names is None else [name for words in names for name in words_of("--vise", words)]
        # A kind picks those of the kind, and makes one sort of toolkit of another.
        bases = [
            Named(one.name, kind or one.kind, {**one.fields, **said}, one.tolerance)
            for one in map(load_toolkit, asked)
            if kind is None or table_of(kind) is table_of(one.kind)
        ]
    toolkits = [base.changed(list(changes)) for base in bases for changes in product(*lists)]
    if len(toolkits) > MOST_TOOLKITS:
        raise InputError(
            f"the lists combine to {len(toolkits)} toolkits: give lists that combine to {MOST_TOOLKITS} or fewer."
        )
    return toolkits


def words_of(option: str, text: str) -> list[str]:
    """The entries of a list.

    Raises
    ------
    InputError
        When one is missing.
    """
    words = [word.strip() for word in text.split(",")]
    if not all(words):
        raise InputError(f"{option} {text!r} has an empty entry: give a list such as 1,2,4.")
    return words


def pitch_of(word: str, unit: Unit) -> tuple[float, float]:
    """A pitch for both directions, or ``XxY``."""
    x, cross, y = word.partition("x")
    return length("--pitch", x, unit), length("--pitch", y if cross else x, unit)
