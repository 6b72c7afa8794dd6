"""What the server gives to those who ask: sizes, counts, times and memory."""

from __future__ import annotations

from attrs import frozen

__all__ = ["Limits"]


@frozen
class Limits:
    """Limits of a server.

    Parameters
    ----------
    upload_bytes : of a file with a part.
    request_bytes : of any other request.
    body_seconds : for a request to arrive.
    uploads : files that may arrive at the same time.
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
    connections : at the same time.
    """

    upload_bytes: int = 20_000_000
    request_bytes: int = 4_000_000
    body_seconds: float = 60.0
    uploads: int = 16
    segments: int = 2_000
    searches: int = 2
    desks: int = 2
    waiting: int = 64
    jobs: int = 64
    seconds: float = 120.0
    desk_seconds: float = 20.0
    memory_bytes: int = 4 << 30
    desk_memory_bytes: int = 2 << 30
    fixtures: int = 300_000
    kept_jobs: int = 1_000
    kept_bytes: int = 1 << 30
    life_seconds: float = 3600.0
    streams: int = 256
    connections: int = 1_024
