"""The page's files, read once into a table; no name in a request is ever looked up anywhere else."""

from __future__ import annotations

from hashlib import sha256
from importlib.resources import files
from importlib.resources.abc import Traversable

from attrs import frozen

__all__ = ["StaticFile", "static_files"]

TYPES = {
    "html": "text/html; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
    "mjs": "text/javascript; charset=utf-8",
    "svg": "image/svg+xml",
    "png": "image/png",
    "ico": "image/x-icon",
    "json": "application/json",
    "webmanifest": "application/manifest+json",
    "txt": "text/plain; charset=utf-8",
}


@frozen
class StaticFile:
    """A file of the page.

    Parameters
    ----------
    content : its bytes.
    type : of content.
    tag : names this content, for caches.
    """

    content: bytes
    type: str
    tag: str


def static_files() -> dict[str, StaticFile]:
    """The files of the page by their paths below ``static``, such as ``js/list.js``."""
    return dict(found(files("workhold.web") / "static", ""))


def found(folder: Traversable, prefix: str) -> list[tuple[str, StaticFile]]:
    """The files of a known kind in a folder and those below it."""
    out: list[tuple[str, StaticFile]] = []
    if not folder.is_dir():
        return out
    for entry in sorted(folder.iterdir(), key=lambda entry: entry.name):
        if entry.is_dir():
            out += found(entry, f"{prefix}{entry.name}/")
            continue
        kind = TYPES.get(entry.name.rpartition(".")[2].lower())
        if kind is not None:
            content = entry.read_bytes()
            out.append((prefix + entry.name, StaticFile(content, kind, f'"{sha256(content).hexdigest()[:20]}"')))
    return out
