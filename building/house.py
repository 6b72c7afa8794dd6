"""What ``make check`` asks of the sources beyond the layers: ``python building/house.py`` says where it does not hold.

A kind of toolkit is data: only ``fixels`` asks which kind it has. A field of a toolkit is written down in few files, so that
a new one costs few. A class name stands for one class. Exceptions stand here, each with its reason.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from attrs import field, frozen

ROOT = Path(__file__).resolve().parent.parent
# Where kinds of toolkits may be asked for, and where else it is done; a folder ends in a slash.
MAY_ASK_FOR_KINDS = {
    "fixels/": "kinds are described there",
    "verification/": "it derives fixtures anew, and uses nothing of what the search asks",
    "batch/durations.py": "how long searches take was measured kind by kind",
    "files/supports_forms.py": "files of the first form have a vise in place of a toolkit",
    "model/clamps.py": "a pair of clamps is made and measured there",
    "model/fixture.py": "a fixture says whether it has a pair of clamps",
    "seating/clamping.py": "only two clamps are tightened one after the other",
    "statics/effective_error.py": "a part moves along a wall without an error",
    "supports/holes.py": "what stands beside a wall has no holes there",
}
# A name of one of the tables of fields stands in the table, in the class, and in one place that asks for it.
MOST_FILES_OF_A_FIELD = 3
# Classes of one name in two rooms that do not know each other.
NAMED_TWICE = {
    "Curves": "of kernels a named tuple of arrays, of the raw block its outline",
    "Edge": "of a plane map of drawings, and of the verification's own walk",
    "Stretches": "of the cutter's path, and of the verification's own walk",
}
KIND_CLASSES = {"Vise", "OpeningVise", "Plate", "Fence", "FlatJaw", "PlainVise"}
KIND_NAMES = {
    "vise", "opening-vise", "gripper", "translating-clamp", "plate", "edge", "fence", "flat-jaw", "plain-vise",
    "strapped",
}  # fmt: skip
# Attributes by which a toolkit, a peg or a contact is asked for its kind.
KIND_ATTRIBUTES = {"has_a_hole", "is_along_x", "is_on_wall", "is_wall", "needs_pairs", "wall"}
# Fields whose names are words of other things too, and are not counted.
COMMON_WORDS = {"columns", "directions", "rows", "stop"}
# What variables that hold a toolkit are called, and those that hold its fields by name.
HOLDERS, RECORDS = {"toolkit"}, {"fields", "given", "said"}
# What of a row of a table is the name of another field.
REFERRING = {"at_least", "follows", "name"}


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

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "tree", ast.parse(self.text))


def list_sources(root: Path) -> list[Source]:
    """Every file of Python below a folder, in the order of their names, but what is data of the package.

    The checker of the benchmark lies there: it stands alone, in one file, and shares nothing on purpose.
    """
    names = [path for path in sorted(root.rglob("*.py")) if path.relative_to(root).parts[0] != "data"]
    return [Source(path.relative_to(root).as_posix(), path.read_text()) for path in names]


def find_lines_asking_for_kind(sources: Sequence[Source]) -> Iterator[str]:
    """Each line that asks for the kind of a toolkit where nobody may."""
    for source in sources:
        if not source.name.startswith(tuple(MAY_ASK_FOR_KINDS)):
            lines = {getattr(node, "lineno", 1) for node in ast.walk(source.tree) if asks_for_kind(node)}
            yield from (
                f"{source.name}:{line} asks for the kind of a toolkit: ask its data in fixels."
                for line in sorted(lines)
            )


def asks_for_kind(node: ast.AST) -> bool:
    """Whether a node of the syntax tree asks which kind of toolkit something is."""
    match node:
        case ast.Call(func=ast.Name(id="isinstance" | "issubclass"), args=[_, kinds]):
            return bool({find_last_name(one) for one in ast.walk(kinds)} & KIND_CLASSES)
        case ast.Compare(left=left, ops=ops, comparators=others):
            sides = [left, *others]
            if any(is_kind_name(one) for side in sides for one in list_items(side)):
                return True
            if all(isinstance(one, ast.Is | ast.IsNot) for one in ops):
                return any(find_last_name(side) in KIND_CLASSES | {"pair"} for side in sides)
        case ast.Attribute(attr=name, ctx=ast.Load()):
            return name in KIND_ATTRIBUTES or (name == "kind" and find_last_name(node.value) in KIND_CLASSES)
        case ast.Dict(keys=keys):
            return sum(map(is_kind_name, keys)) > 1
        case ast.MatchValue(value=value):
            return is_kind_name(value)
        case ast.MatchClass(cls=kind):
            return find_last_name(kind) in KIND_CLASSES
    return False


def find_last_name(node: ast.AST) -> str:
    """The name of a variable or an attribute, and an empty text for anything else."""
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def list_items(node: ast.expr) -> list[ast.expr]:
    """The entries of a written tuple, list or set, and any other expression alone."""
    return node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]


def is_kind_name(node: ast.AST | None) -> bool:
    """Whether a text in the source is the name of a kind."""
    return isinstance(node, ast.Constant) and node.value in KIND_NAMES


def find_scattered_fields(sources: Sequence[Source], names: Sequence[str] = ()) -> Iterator[str]:
    """Each field of toolkits that too many files name.

    Carriers, lattices and pegs have attributes of the same names, and some forms of values are called like a field. Of
    these a file may speak freely. The name of a toolkit's field is

    - an attribute of ``toolkit``, and of ``self`` in a kind, which is a class that is made from a table;
    - a keyword argument of a kind's constructor, or of ``evolve`` with a toolkit;
    - a text in a call that makes a row of a table, or in ``getattr`` with a toolkit;
    - a text by which ``fields``, ``given``, ``said`` or ``toolkit`` is asked, in brackets, by ``get`` or by ``pop``;
    - a text in a tuple, a list, a set, or among the keys of a mapping, all of which are fields of toolkits;
    - a text that is compared with ``name``.
    """
    wanted = set(names or list_field_names())
    every = COMMON_WORDS | wanted
    places: dict[str, list[str]] = {}
    for source in sources:
        kinds = [
            node
            for node in ast.walk(source.tree)
            if isinstance(node, ast.ClassDef)
            and "make_class_from_table" in map(find_last_name, node.decorator_list)
        ]
        in_kinds = {node for kind in kinds for node in ast.walk(kind)}
        found: set[str] = set()
        for node in ast.walk(source.tree):
            owners = HOLDERS | {"self"} if node in in_kinds else HOLDERS
            found |= wanted & find_fields_named(node, owners, every)
        for name in found:
            places.setdefault(name, []).append(source.name)
    for name, files in sorted(places.items()):
        if len(files) > MOST_FILES_OF_A_FIELD:
            yield f"{len(files)} files name the field {name}: take it from its table ({', '.join(files)})."


def list_field_names() -> tuple[str, ...]:
    """The names of the fields of toolkits that are words of nothing else."""
    from workhold.fixels.kinds import TABLES

    return tuple(sorted({row.name for table in TABLES.values() for row in table.fields} - COMMON_WORDS))


def find_fields_named(node: ast.AST, owners: set[str], every: set[str]) -> set[str]:
    """The names of fields, and other words, by which a node of the syntax tree asks a toolkit or its data.

    Parameters
    ----------
    node : see the list in ``scattered_fields``.
    owners : what variables that hold a toolkit are called.
    every : the names of all fields.
    """
    match node:
        case ast.Attribute(value=value, attr=name) if find_last_name(value) in owners:
            return {name}
        case ast.Subscript(value=value, slice=key) if find_last_name(value) in HOLDERS | RECORDS:
            return collect_texts([key])
        case ast.Call():
            return find_fields_in_call(node, owners)
        case ast.Dict(keys=[_, *_] as keys) if collect_texts(keys) <= every:
            return collect_texts(keys)
        case ast.Tuple(elts=items) | ast.List(elts=items) | ast.Set(elts=items) if len(items) > 1:
            return (
                collect_texts(items)
                if all(collect_texts([one]) and collect_texts([one]) <= every for one in items)
                else set()
            )
        case ast.Compare(left=left, comparators=others) if "name" in map(find_last_name, [left, *others]):
            return collect_texts([left, *others])
    return set()


def find_fields_in_call(call: ast.Call, owners: set[str]) -> set[str]:
    """The names of fields, and other words, by which a call asks a toolkit or its data."""
    keywords = {one.arg or "" for one in call.keywords}
    match find_last_name(call.func), call.args:
        case ("get" | "pop", [key, *_]) if (
            find_last_name(getattr(call.func, "value", call.func)) in HOLDERS | RECORDS
        ):
            return collect_texts([key])
        case "getattr", [owner, key, *_] if find_last_name(owner) in owners:
            return collect_texts([key])
        case (("ToolkitField" | "shown"), _):
            return collect_texts([*call.args, *(one.value for one in call.keywords if one.arg in REFERRING)])
        case (("evolve" | "replace"), [owner, *_]) if find_last_name(owner) in owners:
            return keywords
        case kind, _ if kind in KIND_CLASSES:
            return keywords
    return set()


def collect_texts(nodes: Iterable[ast.AST | None]) -> set[str]:
    """The texts among written expressions."""
    return {one.value for one in nodes if isinstance(one, ast.Constant) and isinstance(one.value, str)}


def find_repeated_classes(sources: Sequence[Source]) -> Iterator[str]:
    """Each definition of a class whose name an earlier one has."""
    seen: dict[str, str] = {}
    for source in sources:
        for node in ast.walk(source.tree):
            if isinstance(node, ast.ClassDef) and node.name not in NAMED_TWICE:
                place = f"{source.name}:{node.lineno}"
                if node.name in seen:
                    yield f"{place} has a class {node.name} like {seen[node.name]}: give it a name of its own."
                seen.setdefault(node.name, place)


def main() -> int:
    """Says what does not hold; 1 where there is anything."""
    sys.path.insert(0, str(ROOT / "src"))
    sources = list_sources(ROOT / "src" / "workhold")
    offences = [
        *find_lines_asking_for_kind(sources),
        *find_scattered_fields(sources),
        *find_repeated_classes(sources),
    ]
    sys.stdout.write("".join(f"{sentence}\n" for sentence in offences))
    return int(bool(offences))


if __name__ == "__main__":
    sys.exit(main())
