"""The layers of a DXF drawing and what is on them, so that the ones with the outline can be chosen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.files.dxf.reader import opened, refuse_other_formats, scale_of, unit_code
from workhold.files.dxf.walk import BlockNesting, DxfWalk
from workhold.files.outline.chain import Chain, cleaned
from workhold.files.outline.extent import size_of
from workhold.files.outline.joining import join
from workhold.files.outline.placement import Placement
from workhold.files.part.finding import found, kind_of, read_bytes

__all__ = ["DrawnLayer", "drawn_layers"]


@frozen
class DrawnLayer:
    """A layer of a drawing.

    Parameters
    ----------
    name : as it is drawn.
    kinds : how many entities of each kind are on it, blocks written out.
    hidden : whether it is frozen, switched off or never printed, so that it is read only when it is named.
    loops : how many closed outlines its own lines, arcs and curves make; None where they cannot be told.
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
    """Visits everything, on hidden layers too, whatever is wrong with it."""

    def __init__(self, document: Any) -> None:
        super().__init__(document, None)
        self.kinds: dict[str, Counter[str]] = {}

    def visit(self, entity: Any, nest: BlockNesting) -> None:
        """Count an entity, and collect its chain where it has one."""
        kind = entity.dxftype()
        if kind != "INSERT":
            self.kinds.setdefault(self.effective_layer(entity, nest), Counter())[kind] += 1
        try:
            super().visit(entity, nest)
        except InputError:
            self.level = None

    def is_used(self, entity: Any, layer: str, nest: BlockNesting) -> bool:
        """Everything is looked at."""
        return True


def drawn_layers(path: str | Path, unit: str | None, usual_unit: str | None) -> tuple[tuple[DrawnLayer, ...], bool]:
    """The layers of a DXF file with something on them, by name, and whether their sizes are in mm; else in drawing units.

    Raises
    ------
    InputError
        For a file that is none, or damaged.
    """
    file = found(path)
    content = read_bytes(file)
    if kind_of(file, content) != "dxf":
        raise InputError(f"{file.name}: only DXF files have layers.")
    try:
        refuse_other_formats(content)
        document, _ = opened(file)
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from error
    known = scale_of(unit_code(document, content), unit, usual_unit)
    scale = 1.0 if known is None else known[0]
    walk = LayerWalk(document)
    walk.visit_all(document.modelspace(), BlockNesting(Placement(a=scale, d=scale, height_scale=scale)))
    layers = []
    for name in sorted(walk.kinds, key=str.casefold):
        chains = [chain for chain in walk.chains if walk.layers.get(chain.labels[0]) == name]
        hidden = name.casefold() in walk.hidden_layers
        layers.append(DrawnLayer(name, walk.kinds[name], hidden, loops_of(chains), size_of(chains), tuple(chains)))
    return tuple(layers), known is not None


def loops_of(chains: list[Chain]) -> int | None:
    """How many closed outlines chains make; None where they could go on in more than one way."""
    try:
        return len(join(cleaned(chains).chains, 1e-3).loops)
    except InputError:
        return None
