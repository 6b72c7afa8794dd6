"""The command ``workhold`` as a child process, in the environment that was chosen for it."""

import json
import os
import re
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path

import FreeCAD as App

__all__ = ["PREFERENCES", "Refusal", "answer", "command", "forget", "ordered", "run", "use"]

PREFERENCES = "User parameter:BaseApp/Preferences/Mod/Workhold"
# Variables with which FreeCAD points its own Python at its own libraries.
OWN_VARIABLES = ("PYTHONPATH", "PYTHONHOME", "LD_LIBRARY_PATH")
# Seconds between looks at a child, and at whether it was cancelled, and those that it has to end in order then.
NAP, GRACE = 0.05, 5.0
ORDER = "order.json"

# What the panel has instead of options of the command; what it has not is named by what it is.
OPTIONS = (
    (r"--axis\b", "the axis that points up"),
    (r"--avoid\b", "the faces not to touch"),
    (r"--tools\b", "the table of tools"),
    (r"--vise\b", "the toolkit"),
    (r"; see workhold [\w -]+\.$", "."),
    (r" \(see workhold [\w -]+\)", ""),
    (r"--start X,Y,Z", "the place of the tip at its start"),
    (r"(?:the |its )?--([a-z][a-z-]*)", lambda found: "the " + found[1].replace("-", " ")),
)
# What is said of a child that the system or somebody else has ended.
ENDED = "Workhold was ended before it had an answer: choose the command again."
STOPPED = "The search was stopped before it had found anything: design again."


class Refusal(Exception):
    """A sentence that says what cannot be done, and what to do."""


def command():
    """The path of the command that was chosen, or that is found.

    Raises
    ------
    Refusal
        When there is none.
    """
    chosen = App.ParamGet(PREFERENCES).GetString("Command", "")
    found = chosen if chosen and os.access(chosen, os.X_OK) else shutil.which("workhold")
    if not found:
        raise Refusal(
            "The command workhold was not found: choose the environment that has it with Workhold > Environment."
        )
    return found


def use(path):
    """Chooses the command: its path, or the folder of a Python environment that has it.

    Raises
    ------
    Refusal
        When there is none.
    """
    places = [Path(path), Path(path) / "bin" / "workhold", Path(path) / "Scripts" / "workhold.exe"]
    for place in places:
        if place.is_file() and os.access(str(place), os.X_OK):
            App.ParamGet(PREFERENCES).SetString("Command", str(place))
            return str(place)
    raise Refusal("There is no command workhold in {}: choose an environment that has it.".format(path))


def forget():
    """Chooses no command: the one that is found counts again."""
    App.ParamGet(PREFERENCES).RemString("Command")


def run(*words, cancel=None, wait=None):
    """What the command prints on standard output.

    Parameters
    ----------
    words : the command's words.
    cancel : a ``threading.Event`` that ends the search; what it has found by then counts.
    wait : called between looks at the child, so that a window stays alive.

    Raises
    ------
    Refusal
        With what the command says, where it ends with an error.
    """
    environment = {name: value for name, value in os.environ.items() if name not in OWN_VARIABLES}
    child = subprocess.Popen(
        [command(), *map(str, words)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment,
    )
    said = {}
    readers = [
        threading.Thread(
            target=lambda name=name: said.update({name: getattr(child, name).read()}), daemon=True
        )
        for name in ("stdout", "stderr")
    ]
    for reader in readers:
        reader.start()
    last = None
    while any(reader.is_alive() for reader in readers):
        readers[0].join(NAP)
        if wait is not None:
            wait()
        if cancel is not None and cancel.is_set() and not child.stdin.closed:
            # A child whose input has ended stops searching.
            child.stdin.close()
            last = time.monotonic() + GRACE
        if last is not None and time.monotonic() > last:
            child.terminate()
            last = None
    child.wait()
    child.stdin.close()
    error = said["stderr"].decode("utf-8", "replace")
    if child.returncode in (-signal.SIGTERM, 143):
        raise Refusal(STOPPED)
    if child.returncode < 0:
        raise Refusal(ENDED)
    if child.returncode != 0:
        lines = [line for line in error.splitlines() if "error: " in line] or error.splitlines()[-1:]
        raise Refusal(in_words_of_the_panel(lines[-1].split("error: ", 1)[-1].strip() if lines else ENDED))
    for line in error.splitlines():
        App.Console.PrintMessage(in_words_of_the_panel(line.replace("workhold: ", "", 1)) + "\n")
    return said["stdout"].decode("utf-8", "replace")


def in_words_of_the_panel(sentence):
    """A sentence of the command without its options: what the panel calls them instead."""
    for option, words in OPTIONS:
        sentence = re.sub(option, words, sentence)
    return sentence[:1].upper() + sentence[1:]


def answer(*words, cancel=None, wait=None):
    """The object that the command prints with ``--json``.

    Raises
    ------
    Refusal
        As of :func:`run`, and where it ended before it had printed all.
    """
    return parsed(run(*words, "--json", cancel=cancel, wait=wait))


def ordered(folder, cancel=None, wait=None, **order):
    """What the command answers to an order, which it finds in a folder; files go into the folder as well.

    Raises
    ------
    Refusal
        As of :func:`answer`.
    """
    (folder / ORDER).write_text(json.dumps(order), encoding="utf-8")
    return parsed(run("workbench", folder, cancel=cancel, wait=wait))


def parsed(printed):
    """The object that the command has printed.

    Raises
    ------
    Refusal
        Where it ended before it had printed all.
    """
    try:
        return json.loads(printed)
    except ValueError:
        raise Refusal(ENDED) from None
