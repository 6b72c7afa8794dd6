"""The rule of words that the glossary replaces, which ``house.py`` counts beside those of ``house_rules.py``."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from house_rules import Finding, Source

__all__ = ["replaced_words"]


def replaced_words(glossary: Path) -> Callable[[Sequence[Source]], Iterator[Finding]]:
    """A rule of the words that a glossary replaces: each use of one, by word.

    The words stand in the first column of the table below "Words replaced". One with a capital letter is the name of a
    class; any other is found in names and texts alike, whatever the case of its first letter. One in backticks is plain
    English too, as "beyond the end" is, so it is found only where the program defines, imports, calls or reads it by name.
    A variable inside a function may have it, since there it says where something lies.
    """
    table = glossary.read_text().partition("## Words replaced")[2].partition("\n## ")[0]
    rows = re.findall(r"(?m)^\| ([\w`][^|]*) \|", table)
    words = [word.strip() for row in rows[1:] for word in row.split(",")]

    def find(sources: Sequence[Source]) -> Iterator[Finding]:
        for word in words:
            if word.startswith("`"):
                yield from uses_as_name(sources, word.strip("`"))
                continue
            first = word[0] if word[0].isupper() else f"[{word[0]}{word[0].upper()}]"
            pattern = re.compile(rf"(?<![A-Za-z]){first}{re.escape(word[1:])}(?![a-z])")
            for source in sources:
                for number, line in enumerate(source.lines, start=1):
                    yield from (Finding(word, f"{source.name}:{number}") for _ in pattern.finditer(line))

    return find


def uses_as_name(sources: Sequence[Source], word: str) -> Iterator[Finding]:
    """Each place where a word names a module, a function, a class or an attribute."""
    for source in sources:
        if Path(source.name).stem == word:
            yield Finding(word, f"{source.name}:1")
        for node in ast.walk(source.tree):
            if word in names_made_or_used(node):
                yield Finding(word, f"{source.name}:{getattr(node, 'lineno', 1)}")


def names_made_or_used(node: ast.AST) -> set[str]:
    """The names that a node of the syntax tree defines, imports, calls or reads from an object."""
    match node:
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
            return {name}
        case ast.ImportFrom(module=module, names=names):
            return {*(module or "").split("."), *(part.name for part in names)}
        case ast.Import(names=names):
            return {word for part in names for word in part.name.split(".")}
        case ast.Call(func=ast.Name(id=name)) | ast.Attribute(attr=name):
            return {name}
    return set()
