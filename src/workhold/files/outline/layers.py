"""Outlines of several layers that do not go together, and which layers to read instead."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from shlex import quote

from attrs import evolve

from workhold.errors import InputError
from workhold.files.outline.chain import Drawing
from workhold.files.questions import LAYERS

__all__ = ["with_layers_named"]

# More layers than this are not tried one by one, and no sentence names them.
MOST_LAYERS = 12


def with_layers_named(error: InputError, drawing: Drawing, usable: Callable[[Drawing], bool]) -> InputError:
    """What is wrong with an outline, with the layers whose segments are named in it, and a choice of layers that is usable.

    Parameters
    ----------
    error : what is wrong.
    drawing : with its layers.
    usable : whether a part can be read of a drawing.
    """
    said = str(error)
    meeting = {layer: label for label, layer in drawing.layers.items() if is_named(label, said)}
    every = list(dict.fromkeys(drawing.layers.values()))
    if len(meeting) < 2 or len(every) > MOST_LAYERS:
        return error
    where = " and ".join(f"{label} is on layer '{layer}'" for layer, label in meeting.items())
    # Without one of those that meet, or each of these alone.
    choices = [[other for other in every if other != layer] for layer in reversed(meeting)] + [[one] for one in meeting]
    for chosen in choices:
        if usable(of_layers(drawing, chosen)):
            return InputError(
                f"{said.rstrip('.')}. {where}: give {chosen_words(chosen)} to read an outline without the rest."
            )
    return InputError(f"{said.rstrip('.')}. {where}.")


def is_named(label: str, sentence: str) -> bool:
    """Whether a sentence names a segment, and not only one whose name begins like it."""
    return re.search(rf"{re.escape(label)}(?!\w)", sentence) is not None


def of_layers(drawing: Drawing, layers: Sequence[str]) -> Drawing:
    """The part of a drawing that is on some layers."""
    chains = tuple(chain for chain in drawing.chains if drawing.layers.get(chain.labels[0]) in layers)
    return evolve(drawing, chains=chains)


def chosen_words(layers: Sequence[str]) -> str:
    """A choice of layers as a command takes it, one option after the other."""
    return " ".join(f"{LAYERS} {quote(layer)}" for layer in layers)
