"""Compile the kernels on a first run, with a bar, where the package was built without them."""

from __future__ import annotations

from collections.abc import Sequence
from threading import Event

from workhold.cli.progress import show_progress

__all__ = ["compile_kernels", "compile_seating"]

WORDS = "Compiling the kernels, on the first run only"


def compile_kernels(cancel: Event) -> bool:
    """Compile the kernels of a search if needed on this machine; return whether they were compiled now.

    When ``cancel`` is set, the rest is left to the search.
    """
    from workhold.kernels.base.libraries import SEARCH_ROOMS

    return compile_rooms(SEARCH_ROOMS, cancel)


def compile_seating(cancel: Event) -> bool:
    """Compile the kernels of seating if needed on this machine; return whether they were compiled now.

    For ``cancel`` see :func:`compile_kernels`.
    """
    from workhold.kernels.base.libraries import SEATING_ROOMS

    return compile_rooms(SEATING_ROOMS, cancel)


def compile_rooms(rooms: Sequence[str], cancel: Event) -> bool:
    """Compile the kernels in some packages (``rooms``) if needed, with a progress bar; return whether they
    were compiled now.
    """
    from workhold.kernels.base.libraries import build_libraries, is_built

    if is_built(rooms):
        return False
    with show_progress(WORDS, "% of the kernels", WORDS) as progress:
        build_libraries(rooms, report=lambda done: progress(done, round(100.0 * done)), cancel=cancel)
    return True
