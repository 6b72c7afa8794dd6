"""Hides the libraries of extras that users can choose, as on a machine that has what the tests need and no more.

``python -m pytest -p without_extras`` finds none that the extra ``dev`` does not bring.
"""

from __future__ import annotations

from importlib import metadata
from importlib.machinery import PathFinder
from typing import Any

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

find_any = PathFinder.find_spec


def brought(name: str, extras: frozenset[str], known: set[tuple[str, frozenset[str]]]) -> None:
    """Adds a distribution with some of its extras to those known, and all that it asks for."""
    if (canonicalize_name(name), extras) in known:
        return
    known.add((canonicalize_name(name), extras))
    try:
        lines = metadata.requires(name) or []
    except metadata.PackageNotFoundError:
        return
    for one in map(Requirement, lines):
        if one.marker is None or any(one.marker.evaluate({"extra": extra}) for extra in ("", *extras)):
            brought(one.name, frozenset(one.extras), known)


def hidden_packages() -> set[str]:
    """What can be imported here and comes with none of the distributions that the extra ``dev`` brings."""
    known: set[tuple[str, frozenset[str]]] = set()
    brought("workhold", frozenset({"dev"}), known)
    names = {name for name, _ in known}
    return {
        package
        for package, distributions in metadata.packages_distributions().items()
        if not names & set(map(canonicalize_name, distributions))
    }


def pytest_load_initial_conftests() -> None:
    """Hides them, before the first conftest asks what is there; only where this is loaded as a plugin."""
    hidden = hidden_packages()

    def find_spec(name: str, path: Any = None, target: Any = None) -> Any:
        return None if name.partition(".")[0] in hidden else find_any(name, path, target)

    PathFinder.find_spec = staticmethod(find_spec)  # type: ignore[method-assign, assignment]
