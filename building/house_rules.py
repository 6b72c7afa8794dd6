"""The rules of the house: what is counted in the sources, where it stands, and what to do about it.

A rule yields findings; ``house.py`` counts them and compares the counts with those that were recorded.
"""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

from attrs import field, frozen

__all__ = ["RULES", "Finding", "Rule", "Source", "long_subjects", "sources_of"]

# Where kinds of toolkits may be asked for.
ROOMS_OF_KINDS = ("fixels/", "verification/rules/")
KIND_CLASSES = {"Vise", "OpeningVise", "Plate", "Fence", "FlatJaw"}
KIND_NAMES = {"vise", "opening-vise", "gripper", "translating-clamp", "plate", "edge", "fence", "flat-jaw"}
# Attributes by which a toolkit, a peg or a contact is asked for its kind.
KIND_ATTRIBUTES = {
    "has_a_hole",
    "is_along_x",
    "is_on_a_wall",
    "is_on_wall",
    "is_wall",
    "needs_pairs",
    "on_a_wall",
    "wall",
}
# Fields whose names are words of other things too, and are not counted.
COMMON_WORDS = {"columns", "directions", "rows"}
# What variables that hold a toolkit are called, and those that hold its fields by name.
HOLDERS, RECORDS = {"toolkit"}, {"fields", "given", "said"}
# What of a row of a table is the name of another field.
REFERRING = {"at_least", "follows", "name"}
KIND_WORDS = {"vise", "vises", "plate", "plates", "fence", "fences", "opening"}
LONGEST_FILE, SHORTEST_FILE, LONGEST_LINE, LONGEST_SENTENCE, LONGEST_SUBJECT = 800, 40, 110, 30, 72
# Openings that lean on something said elsewhere.
ELLIPSIS = re.compile(
    r"(?:The same|The (?:one|ones|other|others|rest) (?:for|from|in|of|that|to|with)|Those|That|These|This|Its?|Their|They"
    r"|Such|And|But|Or|Also|Too|As|At|By|For|From|In|Of|On|To|With)\b"
)
# Verbs that open a docstring in the imperative; words that are nouns as well stand among them only with an article.
IMPERATIVE = re.compile(
    r"(?:Add|Append|Ask|Begin|Bring|Build|Choose|Collect|Compile|Compute|Create|Decide|Derive|Do|Draw|Examine|Explain|Fail"
    r"|Fill|Find|Follow|Forget|Get|Give|Have|Hold|Invert|Join|Keep|Leave|Let|Make|Print|Prove|Put|Read|Refuse|Remove|Return"
    r"|Say|See|Send|Serve|Sort|Store|Take|Tell|Try|Visit|Wait|Widen|Write|Yield"
    r"|(?:Answer|Bound|Check|Close|Count|Cross|Cut|List|Load|Look|Mark|Measure|Move|Name|Note|Open|Order|Place|Run|Set|Show"
    r"|Split|Start|Stop|Turn|Work)(?= (?:a|an|the|it|one|what|how|every|each|all)\b))\b"
)
# The end of a sentence.
STOP = re.compile(r"(?<=[.?!])[\"')`]*\s+(?=[A-Z`\"(])")
SECTION = re.compile(r"(?m)^[A-Z]\w+\n-{3,}\n")
EXAMPLE = re.compile(r"(?ms)^ *>>> .*?(?=\n\s*\n|\Z)")


@frozen
class Source:
    """One file of Python below the root of the sources.

    Parameters
    ----------
    name : its path from the root, with slashes.
    text : what stands in it.
    """

    name: str
    text: str
    tree: ast.Module = field(init=False, repr=False)
    lines: list[str] = field(init=False, repr=False)

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "tree", ast.parse(self.text))
        object.__setattr__(self, "lines", self.text.splitlines())

    @property
    def room(self) -> str:
        """The package directly below the root in which the file stands; the file itself where there is none."""
        return self.name.partition("/")[0]


@frozen
class Finding:
    """One thing that a rule counts.

    Parameters
    ----------
    key : the count to which it belongs, such as a room.
    place : a file with its line.
    """

    key: str
    place: str


@frozen
class Rule:
    """A rule of which findings are counted, and whose counts may only fall.

    Parameters
    ----------
    name : what is counted, in the plural.
    remedy : what to do instead, in words that end a sentence.
    find : yields the findings in all sources.
    """

    name: str
    remedy: str
    find: Callable[[Sequence[Source]], Iterator[Finding]]


def sources_of(root: Path) -> list[Source]:
    """Every file of Python below a folder, in the order of their names, but what is data of the package.

    The checker of the benchmark lies there: it stands alone, in one file, and shares nothing on purpose.
    """
    names = [path for path in sorted(root.rglob("*.py")) if path.relative_to(root).parts[0] != "data"]
    return [Source(path.relative_to(root).as_posix(), path.read_text()) for path in names]


def outside_rooms_of_kinds(sources: Sequence[Source]) -> Iterator[Source]:
    """The sources that may not ask for the kind of a toolkit."""
    return (source for source in sources if not source.name.startswith(ROOMS_OF_KINDS))


def asks_for_kind(node: ast.AST) -> bool:
    """Whether a node of the syntax tree asks which kind of toolkit something is."""
    match node:
        case ast.Call(func=ast.Name(id="isinstance" | "issubclass"), args=[_, kinds]):
            return bool(names_in(kinds) & KIND_CLASSES)
        case ast.Compare(left=left, ops=ops, comparators=others):
            sides = [left, *others]
            if any(is_kind_name(one) for side in sides for one in items_of(side)):
                return True
            if all(isinstance(one, ast.Is | ast.IsNot) for one in ops):
                return any(last_name(side) in KIND_CLASSES | {"pair"} for side in sides)
        case ast.Attribute(attr=name, ctx=ast.Load()):
            return name in KIND_ATTRIBUTES or (name == "kind" and last_name(node.value) in KIND_CLASSES)
        case ast.Dict(keys=keys):
            return any(is_kind_name(key) for key in keys)
        case ast.MatchValue(value=value):
            return is_kind_name(value)
        case ast.MatchClass(cls=kind):
            return last_name(kind) in KIND_CLASSES
    return False


def names_in(node: ast.AST) -> set[str]:
    """The names and the last attributes that stand in an expression."""
    return {last_name(one) for one in ast.walk(node)} - {""}


def last_name(node: ast.AST) -> str:
    """The name of a variable or an attribute, and an empty text for anything else."""
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def items_of(node: ast.expr) -> list[ast.expr]:
    """The entries of a written tuple, list or set, and any other expression alone."""
    return node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]


def is_kind_name(node: ast.AST | None) -> bool:
    """Whether a text in the source is the name of a kind."""
    return isinstance(node, ast.Constant) and node.value in KIND_NAMES


def lines_asking_for_kind(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each line that asks for the kind of a toolkit, by room."""
    for source in outside_rooms_of_kinds(sources):
        lines = {
            node.lineno for node in ast.walk(source.tree) if asks_for_kind(node) and hasattr(node, "lineno")
        }
        yield from (Finding(source.room, f"{source.name}:{line}") for line in sorted(lines))


def modules_named_after_kind(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each module whose name has a kind of toolkit in it."""
    for source in outside_rooms_of_kinds(sources):
        if KIND_WORDS & set(Path(source.name).stem.split("_")):
            yield Finding(source.name.removesuffix(".py"), source.name)


def field_names() -> tuple[str, ...]:
    """The names of the fields of toolkits that are words of nothing else."""
    from workhold.fixels.kinds import TABLES

    return tuple(sorted({row.name for table in TABLES.values() for row in table.fields} - COMMON_WORDS))


def files_naming_fields(sources: Sequence[Source], names: Sequence[str] = ()) -> Iterator[Finding]:
    """Each file that names the field of a toolkit, by field.

    Carriers, lattices and pegs have attributes of the same names, and some forms of values are called like a field. Of
    these a file may speak freely. The name of a toolkit's field is

    - an attribute of ``toolkit``, and of ``self`` in a kind, which is a class that is made from a table;
    - a keyword argument of a kind's constructor, or of ``evolve`` with a toolkit;
    - a text in a call that makes a row of a table, or in ``getattr`` with a toolkit;
    - a text by which ``fields``, ``given``, ``said`` or ``toolkit`` is asked, in brackets, by ``get`` or by ``pop``;
    - a text in a tuple, a list, a set, or among the keys of a mapping, all of which are fields of toolkits;
    - a text that is compared with ``name``.
    """
    wanted, every = set(names or field_names()), COMMON_WORDS | set(names or field_names())
    for source in sources:
        found: dict[str, int] = {}
        in_kinds = {
            node
            for kind in ast.walk(source.tree)
            if isinstance(kind, ast.ClassDef) and "made_from_table" in map(last_name, kind.decorator_list)
            for node in ast.walk(kind)
        }
        for node in ast.walk(source.tree):
            owners = HOLDERS | {"self"} if node in in_kinds else HOLDERS
            for name in wanted & fields_named(node, owners, every):
                found.setdefault(name, getattr(node, "lineno", 1))
        yield from (Finding(name, f"{source.name}:{found[name]}") for name in sorted(found))


def fields_named(node: ast.AST, owners: set[str], every: set[str]) -> set[str]:
    """The names of fields, and other words, by which a node of the syntax tree asks a toolkit or its data.

    Parameters
    ----------
    node : see the list in ``files_naming_fields``.
    owners : what variables that hold a toolkit are called.
    every : the names of all fields.
    """
    match node:
        case ast.Attribute(value=value, attr=name) if last_name(value) in owners:
            return {name}
        case ast.Subscript(value=value, slice=key) if last_name(value) in HOLDERS | RECORDS:
            return texts([key])
        case ast.Call(func=func, args=args, keywords=keywords):
            match last_name(func), args:
                case ("get" | "pop", [key, *_]) if (
                    last_name(getattr(func, "value", func)) in HOLDERS | RECORDS
                ):
                    return texts([key])
                case "getattr", [owner, key, *_] if last_name(owner) in owners:
                    return texts([key])
                case (("ToolkitField" | "shown"), _):
                    return texts([*args, *(one.value for one in keywords if one.arg in REFERRING)])
                case (("evolve" | "replace"), [owner, *_]) if last_name(owner) in owners:
                    return {one.arg or "" for one in keywords}
                case kind, _ if kind in KIND_CLASSES:
                    return {one.arg or "" for one in keywords}
        case ast.Dict(keys=[_, *_] as keys) if texts(keys) <= every:
            return texts(keys)
        case ast.Tuple(elts=items) | ast.List(elts=items) | ast.Set(elts=items) if len(items) > 1:
            return texts(items) if all(texts([one]) and texts([one]) <= every for one in items) else set()
        case ast.Compare(left=left, comparators=others) if "name" in map(last_name, [left, *others]):
            return texts([left, *others])
    return set()


def texts(nodes: Iterable[ast.AST | None]) -> set[str]:
    """The texts among written expressions."""
    return {one.value for one in nodes if isinstance(one, ast.Constant) and isinstance(one.value, str)}


def long_files(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each file that is too long to hold one idea, by room."""
    return (Finding(one.room, one.name) for one in sources if len(one.lines) > LONGEST_FILE)


def short_files(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each file that is too short to stand alone, by room; heads of packages are none."""
    modules = (one for one in sources if Path(one.name).stem not in ("__init__", "__main__"))
    return (Finding(one.room, one.name) for one in modules if len(one.lines) < SHORTEST_FILE)


def sizes(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each file, and each line of it."""
    for source in sources:
        yield Finding("files", source.name)
        yield from (Finding("lines", source.name) for _ in source.lines)


def repeated_classes(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each definition of a class whose name an earlier one has."""
    seen: set[str] = set()
    for source in sources:
        for node in ast.walk(source.tree):
            if isinstance(node, ast.ClassDef):
                if node.name in seen:
                    yield Finding(node.name, f"{source.name}:{node.lineno}")
                seen.add(node.name)


def docstrings(source: Source) -> Iterator[tuple[int, str]]:
    """The line at which each docstring begins, and its text without indentation."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    for node in ast.walk(source.tree):
        if isinstance(node, documented) and (text := ast.get_docstring(node)):
            yield node.body[0].lineno, text


def is_help(text: str) -> bool:
    """Whether a docstring is the help of a command, which ends in an example of it.

    A command's help is in the imperative, as that of other programs is: it is what its user asks for.
    """
    return "\n\nExample: workhold " in text


def poor_openings(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each docstring that opens with an ellipsis or in the imperative, by room; the help of commands may."""
    for source in sources:
        for line, text in docstrings(source):
            if source.room == "cli" and is_help(text):
                continue
            if ELLIPSIS.match(text) or IMPERATIVE.match(text):
                yield Finding(source.room, f"{source.name}:{line}")


def sentences(text: str) -> Iterator[str]:
    """The sentences of a docstring, without its examples and the heads of its sections.

    An entry of a section and an item of a list are sentences of their own, as is what stands before a blank line.
    """
    prose = SECTION.sub("\n\n", EXAMPLE.sub("\n\n", text))
    units = re.split(r"\n\s*\n|\n(?=[\w*, ]+ : )|\n(?=- |\d+\. )", prose)
    return (sentence for unit in units for sentence in STOP.split(" ".join(unit.split())))


def long_sentences(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each sentence of a docstring that has too many words, by room."""
    for source in sources:
        for line, text in docstrings(source):
            for sentence in sentences(text):
                if len(re.findall(r"\w[^\s]*", sentence)) > LONGEST_SENTENCE:
                    yield Finding(source.room, f"{source.name}:{line}")


def long_lines(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each line that is too long, by room."""
    for source in sources:
        for number, line in enumerate(source.lines, start=1):
            if len(line) > LONGEST_LINE:
                yield Finding(source.room, f"{source.name}:{number}")


def imports_by_name(sources: Sequence[Source]) -> Iterator[Finding]:
    """Each import of a module whose name is a text, by file."""
    for source in sources:
        for node in ast.walk(source.tree):
            if isinstance(node, ast.Call) and last_name(node.func) in (
                "import_module",
                "__import__",
                "beyond",
            ):
                yield Finding(source.name, f"{source.name}:{node.lineno}")


RULES = (
    Rule("lines asking for the kind", "ask its data or its contact kinds in fixels", lines_asking_for_kind),
    Rule("modules named after a kind", "name it by what it does", modules_named_after_kind),
    Rule("files naming a field", "take the field from the table in fixels.fields", files_naming_fields),
    Rule("files over 800 lines", "split it by ideas", long_files),
    Rule("files under 40 lines", "put it where it is used", short_files),
    Rule("size", "take away what is no longer needed", sizes),
    Rule("class names used again", "give each class a name of its own", repeated_classes),
    Rule("docstrings opening poorly", "open with a verb in the third person or a noun phrase", poor_openings),
    Rule("sentences over 30 words", "say it in two sentences", long_sentences),
    Rule("lines over 110 characters", "break them", long_lines),
    Rule("imports by name", "import it at the head of the file, or hand it in", imports_by_name),
)


def long_subjects(root: Path, record: Path) -> Iterator[str]:
    """Each commit since the record was begun whose subject is too long; none where there is no history."""

    def git(*words: str) -> list[str]:
        try:
            done = subprocess.run(["git", "-C", root, *words], capture_output=True, text=True, check=False)
        except OSError:
            return []
        return done.stdout.splitlines()

    added = git("log", "--diff-filter=A", "--format=%H", "--", str(record))
    for line in git("log", "--no-merges", "--format=%h %s", f"{added[-1]}..HEAD") if added else ():
        commit, _, subject = line.partition(" ")
        if len(subject) > LONGEST_SUBJECT:
            yield f"commit {commit}: its subject has {len(subject)} characters: {LONGEST_SUBJECT} are the most."
