"""The pictures of a design: the best fixtures one by one, and a sheet of thumbnails."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.units import Unit

__all__ = ["BEST_DRAWN", "NEAREST_MISS", "draw_best", "draw_one", "picture_names"]

BEST_DRAWN = 12
ENDINGS = (".svg", ".png")
THUMBNAILS, NEAREST_MISS = "thumbnails", "nearest-miss"


def picture_names() -> list[str]:
    """The files that a design may draw into a folder."""
    ranked = (picture_name(rank) for rank in range(1, BEST_DRAWN + 1))
    return [f"{name}{ending}" for name in (THUMBNAILS, NEAREST_MISS, *ranked) for ending in ENDINGS]


def picture_name(place: int) -> str:
    """The name of the picture of the entry in a place, counted from 1, without its ending."""
    return f"fixture-{place:02d}"


def draw_one(fixture: Fixture, result: Result, folder: Path, name: str, title: str, unit: Unit) -> list[Path]:
    """Draw one fixture of a result's part and vise into a folder, as SVG and PNG; returns the files written.

    Raises
    ------
    InputError
        When the folder cannot be written.
    """
    from workhold.drawing.fixture_picture import draw_fixture

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be written: {error.strerror or error}.") from error
    svg = draw_fixture(fixture, result.workpiece, result.toolkit, title=title, unit=unit)
    return write_pictures({name: svg}, folder)


def write_pictures(pictures: Mapping[str, str], folder: Path) -> list[Path]:
    """Write pictures, by name, as SVG and PNG; returns the files written. Where one cannot be written none is left."""
    from workhold.drawing.render import render
    from workhold.files.atomic import unfinished, write_bytes

    written = []
    try:
        for name, svg in pictures.items():
            for ending in ENDINGS:
                path = folder / f"{name}{ending}"
                write_bytes(path, render(svg, ending))
                written.append(path)
                unfinished.add(path)
    except BaseException:
        for path in written:
            path.unlink(missing_ok=True)
        raise
    finally:
        unfinished.difference_update(written)
    return written


def draw_best(result: Result, folder: Path, unit: Unit) -> list[Path]:
    """Draw the best twelve entries and the thumbnails into a folder, as SVG and PNG; returns the files written.

    The folder is created. Pictures of these names from an earlier design are replaced, or removed where this design has
    fewer fixtures; nothing else in the folder is touched.

    Raises
    ------
    InputError
        When the folder cannot be written.
    """
    from workhold.drawing.fixture_picture import draw_fixture
    from workhold.drawing.thumbnails import best_at_a_glance
    from workhold.listing.near_duplicates import entries

    try:
        folder.mkdir(parents=True, exist_ok=True)
        for old in picture_names():
            (folder / old).unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be written: {error.strerror or error}.") from error
    shown = entries(result)
    indices = shown.index[:BEST_DRAWN].tolist()
    fixtures = [result[index] for index in indices]
    if not fixtures:
        return []
    pictures = {}
    for place, (index, fixture) in enumerate(zip(indices, fixtures, strict=True), 1):
        svg = draw_fixture(fixture, result.workpiece, result.toolkit, title=f"Fixture {index + 1}", unit=unit)
        pictures[picture_name(place)] = svg
    pictures[THUMBNAILS] = best_at_a_glance(result, shown, unit)
    return write_pictures(pictures, folder)
