"""Arrays of kernels while they are compiled: views of memory that somebody else owns.

A view is an address and a shape; its elements lie one after the other. Numba's own arrays also know who owns
their memory, and every copy of such an array is counted. Kernels hand arrays on thousands of times and own
none, so they are compiled for views, which makes them shorter, and faster to compile and to run. A view can
do what kernels do: ``view[i, j]``, ``view[i]``, ``view[i:j]``, ``view.shape``, ``len(view)``. Indices are not
negative.
"""

# Numba declares no types.
# mypy: disable-error-code="no-untyped-call, misc, attr-defined, untyped-decorator"
from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import (
    intrinsic,
    lower_builtin,
    make_attribute_wrapper,
    models,
    register_model,
    type_callable,
)


class ArrayView(types.Type):
    """Numba's type of a view of elements of one type, of one to four dimensions."""

    def __init__(self, element: Any, ndim: int) -> None:
        self.element, self.ndim = element, ndim
        super().__init__(name=f"ArrayView({element}, {ndim})")


@register_model(ArrayView)
class ArrayViewModel(models.StructModel):
    """The layout of a view in memory: the address of the data, then the shape."""

    def __init__(self, manager: Any, view: ArrayView) -> None:
        members = [("data", types.CPointer(view.element)), ("shape", types.UniTuple(types.int64, view.ndim))]
        super().__init__(manager, view, members)


make_attribute_wrapper(ArrayView, "shape", "shape")


@type_callable(operator.getitem)
def type_getitem(context: Any) -> Any:
    """Return numba's typing of ``view[index]``: an element, or a view with fewer dimensions."""

    def typer(view: Any, index: Any) -> Any:
        """Return the type of ``view[index]``, None where ``view`` is no view."""
        if not isinstance(view, ArrayView):
            return None
        if isinstance(index, types.SliceType):
            return view
        taken = len(index.types) if isinstance(index, types.BaseTuple) else 1
        return view.element if taken == view.ndim else ArrayView(view.element, view.ndim - taken)

    return typer


@type_callable(operator.setitem)
def type_setitem(context: Any) -> Any:
    """Return numba's typing of ``view[index] = number``."""

    def typer(view: Any, index: Any, value: Any) -> Any:
        """Return the type none for an assignment to a view, None where ``view`` is no view."""
        return types.none if isinstance(view, ArrayView) else None

    return typer


@type_callable(len)
def type_len(context: Any) -> Any:
    """Return numba's typing of ``len(view)``."""

    def typer(view: Any) -> Any:
        """Return the type of ``len(view)``, None where ``view`` is no view."""
        return types.int64 if isinstance(view, ArrayView) else None

    return typer


@lower_builtin(len, ArrayView)
def lower_len(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """Emit code that reads the length of a view's first dimension."""
    return builder.extract_value(values[0], (1, 0))


def make_view(context: Any, builder: Any, kind: ArrayView, data: Any, sizes: list[Any]) -> Any:
    """Emit code for a view of the type ``kind``, and return its
    value; ``data`` is its pointer, ``sizes`` its shape.
    """
    value = ir.Constant(context.get_value_type(kind), ir.Undefined)
    value = builder.insert_value(value, data, 0)
    for axis, size in enumerate(sizes):
        value = builder.insert_value(value, size, (1, axis))
    return value


def find_place(context: Any, builder: Any, kinds: Any, values: Any) -> tuple[Any, list[Any]]:
    """Emit code for the pointer to ``view[index]``; return it and the
    sizes of the dimensions that are not indexed.
    """
    (kind, index_kind, *_), (view, index, *_) = kinds, values
    if isinstance(index_kind, types.BaseTuple):
        parts = [(part, builder.extract_value(index, number)) for number, part in enumerate(index_kind.types)]
    else:
        parts = [(index_kind, index)]
    sizes = [builder.extract_value(view, (1, axis)) for axis in range(kind.ndim)]
    offset = None
    for axis in range(kind.ndim):
        if offset is not None:
            offset = builder.mul(offset, sizes[axis], flags=("nsw",))
        if axis < len(parts):
            number = context.cast(builder, parts[axis][1], parts[axis][0], types.int64)
            offset = number if offset is None else builder.add(offset, number, flags=("nsw",))
    return builder.gep(builder.extract_value(view, 0), [offset]), sizes[len(parts) :]


@lower_builtin(operator.getitem, ArrayView, types.Integer)
@lower_builtin(operator.getitem, ArrayView, types.BaseTuple)
def lower_getitem(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """Emit code for ``view[index]``: read an element, or make a view of the dimensions that are not
    indexed.
    """
    place, sizes = find_place(context, builder, signature.args, values)
    if sizes:
        return make_view(context, builder, signature.return_type, place, sizes)
    return builder.load(place)


@lower_builtin(operator.getitem, ArrayView, types.SliceType)
def lower_slice(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """Emit code for ``view[first:end]``, a view of these rows; an end past the last row is cut to it."""
    view, rows = values
    kind = signature.args[0]
    sizes = [builder.extract_value(view, (1, axis)) for axis in range(kind.ndim)]
    first, end = builder.extract_value(rows, 0), builder.extract_value(rows, 1)
    end = builder.select(builder.icmp_signed("<", end, sizes[0]), end, sizes[0])
    offset = first
    for size in sizes[1:]:
        offset = builder.mul(offset, size)
    place = builder.gep(builder.extract_value(view, 0), [offset])
    return make_view(context, builder, kind, place, [builder.sub(end, first), *sizes[1:]])


@lower_builtin(operator.setitem, ArrayView, types.Integer, types.Any)
@lower_builtin(operator.setitem, ArrayView, types.BaseTuple, types.Any)
def lower_setitem(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """Emit code that writes a number to ``view[index]``, all dimensions indexed."""
    place, _ = find_place(context, builder, signature.args, values)
    kind = signature.args[0].element
    builder.store(context.cast(builder, values[2], signature.args[2], kind), place)
    return context.get_dummy_value()


@intrinsic
def make_view_at(context: Any, address: Any, shape: Any, element: Any) -> Any:
    """Return a view with ``shape`` of the memory at ``address``;
    ``element`` is numba's type of its elements.
    """
    kind = ArrayView(element.dtype, shape.count)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        """Emit code for the view; return its value."""
        pointer = context.get_value_type(types.CPointer(kind.element))
        sizes = [builder.extract_value(values[1], axis) for axis in range(kind.ndim)]
        return make_view(context, builder, kind, builder.inttoptr(values[0], pointer), sizes)

    return kind(types.int64, shape, element), generate
