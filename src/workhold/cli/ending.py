"""How the command ends on Ctrl-C or SIGTERM, whatever it is doing.

Python acts on a signal between two of its own steps, and then waits for its threads: a long step in compiled
code would delay the end. So a separate thread receives the signal at once. It gives the program a moment to
end in order. Then it removes unfinished files and ends the process. A second signal ends it at once.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from types import FrameType
from typing import NoReturn

__all__ = [
    "INTERRUPTED",
    "Interrupted",
    "set_event_on_interrupt",
    "end_on_signals",
    "note_results_to_keep",
    "exit_with_code",
    "report_interrupted_once",
]

INTERRUPTED, TERMINATED = 130, 143
CODES = {int(signal.SIGINT): INTERRUPTED, int(signal.SIGTERM): TERMINATED}
# Seconds for an orderly end, and within which signals are one: some programs signal a process and its
# whole group.
GRACE, AT_ONCE = 1.5, 0.05
# What clears a progress bar off its line and shows the cursor again.
PLAIN_LINE = b"\r\x1b[2K\x1b[?25h"


class Interrupted(KeyboardInterrupt):
    """The exception that Ctrl-C raises.

    A plain KeyboardInterrupt will not do: if it passes through code run by ``exec``, Python ends by the
    signal even if the exception is caught.
    """


class Terminated(SystemExit):
    """The exception that SIGTERM raises."""


class SignalState:
    """The signals that this process has received, and whether it has results to keep."""

    def __init__(self) -> None:
        self.watched = False
        self.noted_at: float | None = None
        self.timer: threading.Timer | None = None
        self.keeping = False
        self.said = False
        # Whether the main thread has acted on a signal, and the exit code that was decided.
        self.heard = False
        self.code: int | None = None

    def note(self, number: int) -> None:
        """Note a signal: the first one starts a timer that ends the process, a second one ends it at once."""
        now = monotonic()
        if self.noted_at is None:
            self.noted_at = now
            self.timer = threading.Timer(GRACE, self.end_unless_storing, (number,))
            self.timer.daemon = True
            self.timer.start()
        elif now - self.noted_at > AT_ONCE:
            end_now(number)

    def end_unless_storing(self, number: int) -> None:
        """End a process that has not ended by itself, unless it is storing its results after a Ctrl-C."""
        if not (number == signal.SIGINT and self.keeping):
            end_now(number)


ending = SignalState()


def end_on_signals() -> None:
    """Install handlers so that Ctrl-C and SIGTERM end this process within two seconds.

    Call it in the main thread.
    """
    if ending.watched or threading.current_thread() is not threading.main_thread():
        return
    ending.watched = True
    reader, writer = os.pipe()
    if sys.platform != "win32":
        os.set_blocking(writer, False)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, raise_interrupted)
    signal.signal(signal.SIGTERM, terminate)
    sys.unraisablehook = end_on_swallowed_signal
    atexit.register(ignore_signals_at_exit)
    threading.Thread(target=watch, args=(reader,), daemon=True).start()


def watch(reader: int) -> None:
    """Note every signal read from a pipe, as a byte each, until it closes; runs in a thread of its own."""
    while numbers := os.read(reader, 1):
        if numbers[0] in CODES:
            ending.note(numbers[0])


def raise_interrupted(number: int, frame: FrameType | None) -> None:
    """Raise :class:`Interrupted`; the handler of Ctrl-C."""
    ending.heard = True
    raise Interrupted


def terminate(number: int, frame: FrameType | None) -> None:
    """Raise :class:`Terminated`, so that the interpreter ends and removes temporary files;
    the handler of SIGTERM.
    """
    ending.heard, ending.code = True, TERMINATED
    raise Terminated(TERMINATED)


def end_on_swallowed_signal(lost: sys.UnraisableHookArgs) -> None:
    """End the process at once when the exception of a signal was swallowed, as in a callback of a compiled
    library.

    Installed as ``sys.unraisablehook``.
    """
    for kind, number in ((Interrupted, signal.SIGINT), (Terminated, signal.SIGTERM)):
        if issubclass(lost.exc_type, kind):
            end_now(number)
    sys.__unraisablehook__(lost)


def exit_with_code(code: int) -> NoReturn:
    """Raise SystemExit with a code, and remember the code for :func:`ignore_signals_at_exit`."""
    ending.code = code
    sys.exit(code)


def ignore_signals_at_exit() -> None:
    """Ignore signals while Python shuts down, so that they do not change the exit code; called at exit.

    Output is written and threads have ended by then. A process that has received a signal exits here at once.
    """
    for number in CODES:
        signal.signal(number, signal.SIG_IGN)
    if ending.heard and ending.code is not None:
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):
                stream.flush()
        os._exit(ending.code)


def end_now(number: int) -> None:
    """Remove unfinished files and end this process at once,
    from any thread, with the exit code of a signal.
    """
    atomic = sys.modules.get("workhold.files.atomic")
    if atomic is not None:
        atomic.remove_unfinished()
    if number == signal.SIGINT:
        report_interrupted_once()
    # Threads may be deep in compiled code: no orderly end waits for them.
    os._exit(CODES[number])


def report_interrupted_once() -> None:
    """Print on stderr, once, that the command was interrupted."""
    if not ending.said:
        ending.said = True
        line = PLAIN_LINE if os.isatty(2) else b""
        with suppress(OSError):
            os.write(2, line + b"workhold: interrupted; no unfinished file was left behind.\n")


def note_results_to_keep() -> None:
    """Note that there are results to keep. An interrupted search then has time to return them."""
    ending.keeping = True


@contextmanager
def set_event_on_interrupt(then: str) -> Iterator[threading.Event]:
    """Yield an event that Ctrl-C sets within the block; ``then`` is printed on stderr to say what happens
    next.

    The program ends on a second Ctrl-C, or shortly after the first if there are no results to keep (see
    :func:`note_results_to_keep`).
    """
    event = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield event
        return

    def stop(number: int, frame: FrameType | None) -> None:
        """Set the event at the first Ctrl-C, and say so."""
        ending.heard = True
        if not event.is_set():
            event.set()
            os.write(2, f"\nworkhold: stopping; {then} (Ctrl-C again ends at once).\n".encode())

    before = signal.signal(signal.SIGINT, stop)
    try:
        yield event
    finally:
        # What was found is written next, in any time; a Ctrl-C that comes later has nothing to keep.
        ending.keeping = event.is_set()
        signal.signal(signal.SIGINT, before)
