"""What the server gives to those who ask: sizes, counts, times and memory."""

from __future__ import annotations

import os

from attrs import frozen

__all__ = ["Limits", "usual_memory"]

# Memory of a search in bytes; the least with which one can work; and the share of the machine's that all searches may take.
MEMORY, LEAST_MEMORY, SHARE = 4 << 30, 1 << 30, 0.7


@frozen
class Limits:
    """Limits of a server.

    Parameters
    ----------
    upload_bytes : of a file with a part.
    request_bytes : of any other request.
    body_seconds : for a request to arrive.
    uploads, client_uploads : files that may arrive at the same time, in all and from one address.
    segments : of a part.
    searches : searches at the same time, each in a process of its own.
    desks : processes for everything that is quick: reading files, pictures, loads.
    waiting : searches, or quick things, that may wait for a process.
    jobs : searches of one address that are not over.
    seconds : for one search; what was found by then is its result.
    desk_seconds : for reading a file, a picture and the like.
    memory_bytes, desk_memory_bytes : address space of a process that searches, and of one that does the rest.
    fixtures : kept of one search, the best ones.
    kept_jobs, kept_bytes : searches and bytes of their fixtures kept; the longest unused go first.
    life_seconds : after the last use of a search until it is forgotten.
    streams : streams of events at the same time.
    connections, client_connections : at the same time, in all and from one address.
    """

    upload_bytes: int = 20_000_000
    request_bytes: int = 4_000_000
    body_seconds: float = 60.0
    uploads: int = 16
    client_uploads: int = 4
    segments: int = 2_000
    searches: int = 2
    desks: int = 2
    waiting: int = 64
    jobs: int = 64
    seconds: float = 120.0
    desk_seconds: float = 20.0
    memory_bytes: int = MEMORY
    desk_memory_bytes: int = 2 << 30
    fixtures: int = 300_000
    kept_jobs: int = 1_000
    kept_bytes: int = 1 << 30
    life_seconds: float = 3600.0
    streams: int = 256
    connections: int = 1_024
    client_connections: int = 128


def usual_memory(searches: int) -> int:
    """Bytes of address space for each of so many searches at the same time: 4 GiB, or less where the machine has less."""
    try:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return MEMORY
    return min(MEMORY, max(int(SHARE * memory / searches), LEAST_MEMORY))
