"""Surveys of a part file: its content and the questions that reading it leaves open.

They are for a user interface that asks the user on the spot instead of refusing the file. The layers of a DXF
drawing are listed with what is on them, so that the ones with the outline can be chosen.

Glossary
--------
question : a choice that a refusal leaves to the user, see ``files.questions``.
gap : the distance from a loose end of a drawing to the nearest other loose end, in mm.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np
from attrs import evolve, frozen

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget, OverBudgetError
from workhold.files.dxf.reader import (
    choose_scale,
    make_damage_error,
    open_document,
    read_unit_code,
    refuse_crowded,
    refuse_other_formats,
)
from workhold.files.dxf.walk import BlockNesting, DxfWalk
from workhold.files.outline.chain import Chain, Drawing, Placement, drop_zero_lengths
from workhold.files.outline.diagnostics import measure_size
from workhold.files.outline.joining import JoinedLoop, join
from workhold.files.outline.nesting import DrawnPart, nest_loops
from workhold.files.part.finding import detect_file_kind, find_part_file, read_bytes
from workhold.files.part.load import LoadedPart, read_workpiece
from workhold.files.questions import MARK, UNIT, name_questions
from workhold.model.solid import FileSolid

__all__ = ["DrawnLayer", "DrawingSurvey", "list_drawn_layers", "survey_part_file"]


@frozen
class DrawnLayer:
    """A layer of a drawing.

    Parameters
    ----------
    name : the layer's name.
    kinds : number of entities of each kind on it, with blocks expanded.
    hidden : whether it is frozen, switched off or never printed; such a layer is read only when it is named.
    loops : how many closed outlines its own lines, arcs and curves make; None where that is unknown.
    size : width and height of these lines, arcs and curves; None where there are none.
    chains : these lines, arcs and curves.
    """

    name: str
    kinds: Mapping[str, int]
    hidden: bool
    loops: int | None
    size: tuple[float, float] | None
    chains: tuple[Chain, ...] = ()


class LayerWalk(DxfWalk):
    """A walk that visits all entities, also on hidden layers, and leaves out entities that cannot be read."""

    def __init__(self, document: Any, budget: Budget) -> None:
        super().__init__(document, None, None, budget)
        self.kinds: dict[str, Counter[str]] = {}

    def visit(self, entity: Any, nest: BlockNesting) -> None:
        """Count an entity by layer and kind, and collect its chain where it has a readable one."""
        kind = entity.dxftype()
        if kind != "INSERT":
            self.kinds.setdefault(self.find_effective_layer(entity, nest), Counter())[kind] += 1
        try:
            super().visit(entity, nest)
        except OverBudgetError:
            raise
        except InputError:
            self.level = None

    def is_used(self, entity: Any, layer: str, nest: BlockNesting) -> bool:
        """Return True, so that entities of all layers are read."""
        return True


def list_drawn_layers(
    path: str | Path, unit: str | None, usual_unit: str | None
) -> tuple[tuple[DrawnLayer, ...], bool]:
    """Return (1) the layers of a DXF file that have something on them, sorted by name, and (2) whether their
    sizes are in mm.

    Sizes are in units of the drawing where neither the file nor an argument gives a unit.

    Parameters
    ----------
    unit, usual_unit : see :func:`workhold.files.part.load.read_workpiece`.

    Raises
    ------
    InputError
        For a file that is not DXF, or is damaged.
    """
    file = find_part_file(path)
    content = read_bytes(file)
    if detect_file_kind(file, content) != "dxf":
        raise InputError(f"{file.name}: only DXF files have layers.")
    try:
        refuse_other_formats(content)
        budget = Budget(LIMITS["dxf"], len(content))
        refuse_crowded(content, budget)
        document, _ = open_document(file)
        with np.errstate(all="ignore"):
            return list_layers_of_document(
                document, read_unit_code(document, content), unit, usual_unit, budget
            )
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from error


def list_layers_of_document(
    document: Any, code: int | str, unit: str | None, usual_unit: str | None, budget: Budget
) -> tuple[tuple[DrawnLayer, ...], bool]:
    """Return the result of :func:`list_drawn_layers` for a document of
    ezdxf; ``code`` is its ``$INSUNITS``.
    """
    known = choose_scale(code, unit, usual_unit)
    scale = 1.0 if known is None else known[0]
    try:
        walk, space = LayerWalk(document, budget), document.modelspace()
    except Exception as error:  # tables and layouts of a damaged file may fail in any way
        raise make_damage_error(error) from error
    walk.visit_all(space, BlockNesting(Placement(a=scale, d=scale, height_scale=scale)))
    layers = []
    on_layer: dict[str | None, list[Chain]] = {}
    for chain in walk.chains:
        on_layer.setdefault(walk.layers.get(chain.labels[0]), []).append(chain)
    for name in sorted(walk.kinds, key=str.casefold):
        budget.check_time()
        chains = drop_unusable_chains(on_layer.get(name, []))
        hidden = name.casefold() in walk.hidden_layers
        layers.append(
            DrawnLayer(
                name,
                walk.kinds[name],
                hidden,
                count_closed_outlines(chains),
                measure_size(chains),
                tuple(chains),
            )
        )
    return tuple(layers), known is not None


def drop_unusable_chains(chains: list[Chain]) -> list[Chain]:
    """Return the chains, or [] if one of their numbers is not finite or far too large."""
    try:
        drop_zero_lengths(chains)
    except InputError:
        return []
    return chains


def count_closed_outlines(chains: list[Chain]) -> int | None:
    """Return the number of closed outlines that chains make;
    None where they could be joined in more than one way.
    """
    try:
        joined = join(drop_zero_lengths(chains).chains, 1e-3)
        return None if joined.junctions else len(joined.loops)
    except InputError:
        return None


# A gap wider than this share of the drawing is none: the end was not meant to meet another.
WIDEST_GAP = 0.1
# The unit in which a drawing is looked at while it is not known.
ANY_UNIT, ONE_PIXEL = "mm", "px25.4"


@frozen
class DrawingSurvey:
    """The content of a file, and the questions that it leaves open.

    Parameters
    ----------
    loaded : the part, or None where it is refused.
    refusal : the error message of a refusal; empty where there is none.
    asked : names of the questions that must be answered first, such as "unit".
    size : width and height in mm of all that is drawn; None for files that hold no drawing, and while it
        cannot be read. If the unit is one of the questions, the size and all following lengths count a unit
        of the drawing as a millimetre.
    chains : all that is drawn.
    parts : the parts that the closed outlines make, by decreasing area.
    gaps : distances in mm from loose ends to the nearest other loose end, without repetition, in increasing
        order.
    layers : for a DXF file, the layers with lines, arcs or curves on them.
    solids : solids of a STEP file, the largest first.
    pixels : width and height in pixels of all that is drawn, where the unit of an SVG drawing is asked.
    """

    loaded: LoadedPart | None
    refusal: str
    asked: tuple[str, ...]
    size: tuple[float, float] | None
    chains: tuple[Chain, ...]
    parts: tuple[DrawnPart, ...]
    gaps: tuple[float, ...]
    layers: tuple[DrawnLayer, ...] = ()
    solids: tuple[FileSolid, ...] = ()
    pixels: tuple[float, float] | None = None


def survey_part_file(path: Path, *, called: Mapping[str, str] | None = None, **options: Any) -> DrawingSurvey:
    """Return a survey of a part file: the part or, if it cannot be read, the
    refusal; in both cases all that is drawn.

    Parameters
    ----------
    called : as in :func:`workhold.files.part.load.read_workpiece`.
    options : the other arguments of that function.

    Raises
    ------
    InputError
        For a file that cannot be opened at all.
    """
    content = read_bytes(path)
    loaded, sentence, is_over = None, "", False
    try:
        # Questions keep their marks, so that they can be found in the sentence.
        loaded = read_workpiece(path, **options, called=MARKS)
    except InputError as error:
        sentence, is_over = str(error), OverBudgetError.is_behind(error)
    asked = tuple(dict.fromkeys(mark[1:-1] for mark in MARK.findall(sentence)))
    if loaded is not None:
        loaded = evolve(loaded, remarks=tuple(name_questions(remark, called) for remark in loaded.remarks))
    told = DrawingSurvey(loaded, name_questions(sentence, called), asked, None, (), (), ())
    if not is_over:
        with suppress(OverBudgetError):
            told = add_drawn_content(told, path, content, ANY_UNIT if UNIT in sentence else None, options)
    return told


def add_drawn_content(
    told: DrawingSurvey, path: Path, content: bytes, unit: str | None, options: Mapping[str, Any]
) -> DrawingSurvey:
    """Return a survey with size, chains, parts, gaps, layers
    and solids filled in; the file is read again for them.

    Parameters
    ----------
    unit : unit in which to read the drawing, if its own unit is not known; None otherwise.
    options : those of :func:`survey_part_file`.

    Raises
    ------
    OverBudgetError
        When the drawing takes too much work.
    """
    kind = ""
    with suppress(InputError):
        kind = detect_file_kind(path, content)
    drawing = read_all_drawn(kind, path, content, options if unit is None else {**options, "unit": unit})
    chains = tuple[Chain, ...]()
    with suppress(InputError):
        chains = drop_zero_lengths(drawing.chains).chains
    size = measure_size(chains)
    gaps, parts = find_gaps_and_parts(chains, options.get("join_tolerance", 1e-3), size)
    layers = tuple[DrawnLayer, ...]()
    with ignore_refusals():
        drawn = list_drawn_layers(path, unit or options.get("unit"), None)[0] if kind == "dxf" else ()
        layers = tuple(layer for layer in drawn if layer.chains)
    if told.loaded is not None:
        parts, solids = told.loaded.parts, told.loaded.solids
    else:
        solids = list_refused_solids(content) if kind == "step" else ()
    pixels = None
    if unit is not None and kind == "svg":
        # A unit in which a pixel is a millimetre, so that the size is a number of them.
        drawn_in_pixels = read_all_drawn(kind, path, content, {**options, "unit": ONE_PIXEL})
        pixels = measure_size(drop_zero_lengths(drawn_in_pixels.chains).chains)
    return evolve(
        told,
        size=size,
        chains=chains,
        parts=parts,
        gaps=gaps,
        layers=layers,
        solids=solids,
        pixels=pixels,
    )


@contextmanager
def ignore_refusals() -> Iterator[None]:
    """Suppress InputError in the block.

    An InputError caused by an OverBudgetError is not suppressed but raised as an OverBudgetError, so that
    work that took too much is not tried once more.
    """
    try:
        yield
    except InputError as error:
        if OverBudgetError.is_behind(error):
            raise OverBudgetError(str(error)) from error


MARKS = {mark[1:-1]: mark for mark in re.findall(r"<\w+>", MARK.pattern)}


def read_all_drawn(kind: str, path: Path, content: bytes, options: Mapping[str, Any]) -> Drawing:
    """Return all that is drawn in a DXF or SVG file; an empty
    drawing for other kinds and where it cannot be read.

    Raises OverBudgetError when reading takes too much work.
    """
    taken = {name: options.get(name) for name in ("unit", "fit")}
    with ignore_refusals():
        if kind == "dxf":
            from workhold.files.dxf.reader import read_dxf

            with np.errstate(all="ignore"):
                return read_dxf(path, content, layers=options.get("layers"), **taken)
        if kind == "svg":
            from workhold.files.svg.reader import read_svg

            with np.errstate(all="ignore"):
                return read_svg(content, **taken)
    return Drawing(())


def list_refused_solids(content: bytes) -> tuple[FileSolid, ...]:
    """Return the solids of a STEP file, given as bytes, whose outline was
    refused; () where the file is damaged.
    """
    with suppress(InputError):
        from workhold.files.step.solids import list_solids

        return list_solids(content)
    return ()


def try_to_nest(loops: Sequence[JoinedLoop]) -> tuple[DrawnPart, ...]:
    """Return the parts that closed loops make; () where that is refused or takes too long."""
    try:
        return nest_loops(loops, Budget(LIMITS["dxf"]))
    except InputError:
        return ()


def find_gaps_and_parts(
    chains: tuple[Chain, ...], tolerance: float, size: tuple[float, float] | None
) -> tuple[tuple[float, ...], tuple[DrawnPart, ...]]:
    """Return (1) the sorted distances from loose ends to the nearest other loose end, and (2) the parts after
    closing gaps up to a tolerance; all in mm.

    Distances above ``WIDEST_GAP`` times the diagonal ``size`` are left out. Both are () where chains could be
    joined in more than one way.
    """
    if size is None:
        return (), ()
    try:
        strays = join(chains, 0.0).strays
        joined = join(chains, tolerance)
    except InputError:
        return (), ()
    if joined.junctions:
        # Ends that could go on in more than one way; the refusal says where.
        return (), ()
    ends = np.array(
        [end for stray in strays for end in (stray.chain.points[0], stray.chain.points[-1])]
    ).reshape(-1, 2)
    found = set()
    # A file with more loose ends than this is not an outline at all.
    for k, (x, y) in enumerate(ends[:2000].tolist()):
        away = np.hypot(ends[:, 0] - x, ends[:, 1] - y)
        away[k] = np.inf
        found.add(float(f"{away.min():.6g}"))
    widest = WIDEST_GAP * hypot(*size)
    return tuple(sorted(gap for gap in found if 0.0 < gap <= widest)), try_to_nest(joined.loops)
