"""The walk through a DXF layout and the blocks inserted in it, which collects chains.

Glossary
--------
effective layer : an entity's layer, or the INSERT's when the entity stands on layer 0 of a block.
nest : position of the walk: the placement, layer and names of the INSERTs around it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

from attrs import evolve, frozen

from workhold.conventions import LEVEL
from workhold.errors import InputError, make_printable, shorten_middle
from workhold.files.budget import Budget, OverBudgetError
from workhold.files.dxf.entities import REFUSED, SHAPES, RawChain, is_seen_from_below
from workhold.files.outline.chain import Chain, Placement, format_count, list_first_items
from workhold.files.outline.curves import CurveReader
from workhold.files.questions import LAYERS

__all__ = ["BlockNesting", "DxfWalk"]

T = TypeVar("T")
# The colour of what has that of its layer.
BY_LAYER = 256


@frozen
class BlockNesting:
    """The INSERTs around the entity that the walk visits.

    Parameters
    ----------
    placement : transformation of block or model space coordinates to mm.
    layer : effective layer of the innermost INSERT; None in model space.
    frozen : whether a surrounding INSERT is on a hidden layer.
    suffix : `` of INSERT 41`` and so on, for labels.
    blocks : names of the blocks around, in small letters, the outermost first.
    """

    placement: Placement
    layer: str | None = None
    frozen: bool = False
    suffix: str = ""
    blocks: tuple[str, ...] = ()


class DxfWalk:
    """A walk that collects the chains of a document's entities, and counts what was left out.

    Parameters
    ----------
    layers : names of the layers to read, in any mixture of capitals; all visible ones when None.
    fit : largest distance in mm of lines and arcs from true curves; with None such curves are replaced
        provisionally.
    budget : spent for every entity and vertex.
    """

    def __init__(
        self, document: Any, layers: Sequence[str] | None, fit: float | None, budget: Budget
    ) -> None:
        self.budget = budget
        self.document = document
        self.curves = CurveReader(fit, budget)
        self.wanted = None if layers is None else {name.strip().casefold(): name for name in layers}
        self.chains: list[Chain] = []
        self.names: dict[str, str] = {}
        self.layers: dict[str, str] = {}
        self.looks: dict[str, str] = {}
        # Splines of fit points alone.
        self.interpolated = 0
        self.hidden: Counter[str] = Counter()
        self.ignored: Counter[str] = Counter()
        self.missing_blocks: Counter[str] = Counter()
        # How many entities a block is, those of blocks in it written out, once that was asked.
        self.sizes: dict[str, int] = {}
        self.level: tuple[float, str] | None = None
        self.hidden_layers = {
            layer.dxf.name.casefold()
            for layer in document.layers
            if layer.is_frozen() or layer.is_off() or layer.dxf.name.casefold() == "defpoints"
        }

    def visit_all(self, entities: Iterable[Any], nest: BlockNesting) -> None:
        """Visit all entities in turn."""
        for entity in entities:
            self.visit(entity, nest)

    def visit(self, entity: Any, nest: BlockNesting) -> None:
        """Collect the chain of one entity, or visit the
        block that it inserts, or count why it was left out.
        """
        self.budget.spend()
        kind = entity.dxftype()
        label = f"{kind} {label_entity(entity)}{nest.suffix}"
        try:
            layer = self.find_effective_layer(entity, nest)
            if kind == "INSERT":
                self.visit_insert(entity, nest, layer, label)
            elif kind in SHAPES or kind in REFUSED:
                if self.is_used(entity, layer, nest):
                    self.add(entity, kind, nest.placement, label)
                    labels = self.chains[-1].labels
                    self.layers.update(dict.fromkeys(labels, layer))
                    if look := get_look(entity):
                        self.looks.update(dict.fromkeys(labels, look))
            elif self.wanted is None or layer.casefold() in self.wanted:
                self.ignored[kind] += 1
        except InputError:
            raise
        except Exception as error:  # ezdxf checks few values; a damaged one may fail in any way
            raise InputError(f"{label} is damaged ({error}): delete it or draw it again.") from error

    def find_effective_layer(self, entity: Any, nest: BlockNesting) -> str:
        """Return the entity's layer, or the INSERT's around it for layer 0."""
        # Entities of kinds that the library does not know have no layer it could tell.
        layer = str(entity.dxf.get("layer", "0")) if entity.dxf.is_supported("layer") else "0"
        return nest.layer if layer == "0" and nest.layer is not None else layer

    def is_used(self, entity: Any, layer: str, nest: BlockNesting) -> bool:
        """Return whether an entity is to be read: it is on a chosen layer or,
        if none were chosen, on a visible one.

        Hidden entities are counted.
        """
        key = layer.casefold()
        self.names.setdefault(key, layer)
        if self.wanted is not None and key not in self.wanted:
            return False
        invisible = bool(entity.dxf.get("invisible", 0))
        if invisible or (self.wanted is None and (key in self.hidden_layers or nest.frozen)):
            self.hidden["made invisible" if invisible else f"on layer {layer}"] += 1
            return False
        return True

    def add(self, entity: Any, kind: str, placement: Placement, label: str) -> None:
        """Append the chain of an entity in mm to ``chains``; ``placement``
        maps the entity's coordinates to mm.

        Raises
        ------
        InputError
            For kinds that are refused, and entities out of the plane.
        """
        if kind in REFUSED:
            x, y = placement(find_entity_point(entity))
            raise InputError(
                f"{label} at ({x:.6g}, {y:.6g}) is {REFUSED[kind]}, which is not made of lines and arcs: "
                f"convert it to lines and arcs in the CAD program, or leave its layer out with {LAYERS}."
            )
        self.budget.spend(count_vertices(entity))
        raw = apply_with_label(label, SHAPES[kind], entity)
        self.interpolated += kind == "SPLINE" and not len(entity.control_points)
        if not raw.bulges:
            raw = RawChain([*raw.points, *raw.points][:2] or [(0.0, 0.0, 0.0)] * 2, [0.0])
        self.check_level(raw, placement, label)
        count = len(raw.bulges)
        labels = (label,) * count
        if raw.numbered and count > 1:
            labels = tuple(label_segment(label, k) for k in range(count))
        chain = self.curves.make_chain(raw.points, raw.bulges, labels, raw.curved, placement)
        if chain is None:
            chain = Chain((placement(raw.points[0]),) * 2, (0.0,), (label,))
        self.chains.append(chain)

    def check_level(self, raw: RawChain, placement: Placement, label: str) -> None:
        """Raise InputError unless all z of an entity are equal, and equal to those of the entities visited
        before.
        """
        for z in (*(z for _, _, z in raw.points), *raw.heights):
            height = placement.height_scale * z + placement.height
            if self.level is None:
                self.level = (height, label)
            elif not abs(height - self.level[0]) <= LEVEL * max(1.0, abs(self.level[0])):
                other = "itself" if label == self.level[1] else self.level[1]
                raise InputError(
                    f"{label} reaches the height z = {height:.6g} mm, but {other} lies at z = "
                    f"{self.level[0]:.6g} mm: draw the part flat, in the XY plane."
                )

    def visit_insert(self, insert: Any, nest: BlockNesting, layer: str, label: str) -> None:
        """Visit the entities of an inserted block, once for every place of an array.

        Raises InputError for tilted blocks, a scale of zero, and blocks that contain themselves.
        """
        key = layer.casefold()
        name = str(insert.dxf.name)
        block = self.document.blocks.get(name)
        if block is None:
            self.missing_blocks[name] += 1
            return
        if name.casefold() in nest.blocks:
            raise InputError(f"{label} inserts block '{name}', which contains itself: repair the drawing.")
        apply_with_label(label, is_seen_from_below, insert)
        if insert.dxf.get("invisible", 0):
            self.hidden["made invisible"] += 1
            return
        rows, columns = max(insert.dxf.row_count, 1), max(insert.dxf.column_count, 1)
        try:
            # An empty block costs something too.
            self.budget.spend(rows * columns)
            self.budget.refuse_too_many_ahead(rows * columns * self.count_inserted_entities(name, block))
        except OverBudgetError as error:
            if rows * columns == 1:
                raise
            raise OverBudgetError(f"{label} repeats its block {rows * columns:,} times: {error}") from error
        inner = evolve(
            nest,
            layer=layer,
            frozen=nest.frozen or key in self.hidden_layers,
            suffix=f" of INSERT {label_entity(insert)}{nest.suffix}",
            blocks=(*nest.blocks, name.casefold()),
        )
        for single in insert.multi_insert() if rows * columns > 1 else [insert]:
            placement = nest.placement.compose_after(make_block_placement(single))
            if placement.flat:
                raise InputError(f"{label} has a scale of zero: correct it.")
            with self.budget.count_nesting(label):
                self.visit_all(block, evolve(inner, placement=placement))

    def count_inserted_entities(self, name: str, block: Any, depth: int = 0) -> int:
        """Return a lower bound of the number of entities that are visited for one insertion of a block.

        Entities of blocks inserted inside it are included.
        """
        key = name.casefold()
        if key in self.sizes or depth > (self.budget.limits.deepest or 0):
            return self.sizes.get(key, 1)
        # What contains itself is refused when it is visited.
        self.sizes[key] = 1
        size = 0
        for entity in block:
            size += 1
            if entity.dxftype() == "INSERT" and not entity.dxf.get("invisible", 0):
                inner = self.document.blocks.get(str(entity.dxf.get("name", "")))
                size += (
                    0
                    if inner is None
                    else self.count_inserted_entities(str(entity.dxf.name), inner, depth + 1)
                )
        self.sizes[key] = size
        return size

    def refuse_missing_layers(self) -> None:
        """Raise InputError for a chosen layer without outline entities, and for an empty choice."""
        missing = [name for key, name in (self.wanted or {}).items() if key not in self.names]
        if missing:
            have = list_first_items(sorted(self.names.values())) or "none"
            raise InputError(f"no line or arc is on layer '{missing[0]}': layers with some are {have}.")
        if self.wanted is not None and not self.wanted:
            raise InputError(f"no layer was chosen: name one, or leave {LAYERS} out.")

    def list_remarks(self) -> list[str]:
        """Return sentences on what was left out, one for each reason."""
        remarks = []
        if self.ignored:
            kinds = [f"{count} {shorten_name(kind)}" for kind, count in sorted(self.ignored.items())]
            remarks.append(f"Ignored entities that are not an outline: {list_first_words(kinds)}.")
        if self.interpolated:
            splines = format_count(self.interpolated, "spline", "splines")
            remarks.append(
                f"Read {splines} of fit points alone as the cubic through them that CAD programs draw; some "
                "draw another one, so check the outline."
            )
        if self.hidden:
            total = sum(self.hidden.values())
            places = [f"{count} {shorten_name(where)}" for where, count in sorted(self.hidden.items())]
            remarks.append(
                f"Left out {format_count(total, 'hidden entity', 'hidden entities')} "
                f"({list_first_words(places)}); name a layer "
                f"with {LAYERS} to read it anyway."
            )
        if self.missing_blocks:
            names = list_first_items([shorten_name(name) for name in sorted(self.missing_blocks)])
            remarks.append(
                f"Left out blocks that the file does not contain: {names}; bind external references to read "
                "them."
            )
        return remarks


# Letters of a name that a file gives, and how many things a remark names before it only counts.
LONGEST_NAME, MOST_NAMED = 80, 10


def shorten_name(name: str) -> str:
    """Return a name from a file, shortened and without unprintable characters."""
    return shorten_middle(make_printable(name), LONGEST_NAME)


def list_first_words(words: Sequence[str]) -> str:
    """Return the first ``MOST_NAMED`` words joined by commas, with "and N more" for the rest."""
    more = len(words) - MOST_NAMED
    return ", ".join(words[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def label_entity(entity: Any) -> str:
    """Return the handle of an entity, shortened in the middle, because labels repeat it for every segment."""
    return shorten_middle(str(entity.dxf.handle), 20)


def get_look(entity: Any) -> str:
    """Return the colour and the line type of an entity as one text; ""
    where both are taken from its layer.
    """
    color = entity.dxf.get("true_color", entity.dxf.get("color", BY_LAYER))
    kind = str(entity.dxf.get("linetype", "BYLAYER")).casefold()
    return "" if color == BY_LAYER and kind == "bylayer" else f"{color} {kind}"


def count_vertices(entity: Any) -> int:
    """Return the number of vertices of a polyline, or of control
    points and fit points of a spline; 0 for other kinds.
    """
    kind = entity.dxftype()
    if kind == "LWPOLYLINE":
        return len(entity)
    if kind == "POLYLINE":
        return len(entity.vertices)
    return len(entity.control_points) + len(entity.fit_points) if kind == "SPLINE" else 0


def apply_with_label(label: str, function: Callable[[Any], T], entity: Any) -> T:
    """Return ``function(entity)``; the message of its InputError gets the label in front."""
    try:
        return function(entity)
    except InputError as error:
        raise InputError(f"{label} {error}") from error


def label_segment(label: str, k: int) -> str:
    """Return the label of segment k (from 0) of a polyline, made from the polyline's label by putting the
    number right after the handle.
    """
    kind, handle, *rest = label.split(" ", 2)
    return " ".join([kind, handle, f"segment {k}", *rest])


def make_block_placement(insert: Any) -> Placement:
    """Return the transformation from a block's coordinates to those around its INSERT."""
    matrix = insert.matrix44()
    ax, ay, _ = matrix.transform_direction((1, 0, 0))
    cx, cy, _ = matrix.transform_direction((0, 1, 0))
    _, _, zz = matrix.transform_direction((0, 0, 1))
    ex, ey, ez = matrix.transform((0, 0, 0))
    return Placement(ax, ay, cx, cy, ex, ey, zz, ez)


def find_entity_point(entity: Any) -> tuple[float, float]:
    """Return (x, y) of an arbitrary point of an entity, in the entity's own coordinates; (0, 0) where it has
    none.
    """
    for name in ("center", "start", "vtx0", "start_location"):
        if entity.dxf.is_supported(name) and entity.dxf.hasattr(name):
            point = entity.dxf.get(name)
            return float(point[0]), float(point[1])
    for points in ("control_points", "fit_points"):
        found = getattr(entity, points, None)
        if found is not None and len(found):
            return float(found[0][0]), float(found[0][1])
    return 0.0, 0.0
