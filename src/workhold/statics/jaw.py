"""How a closed jaw takes a load: locked by its screw, or keeping its force.

A screw vise is closed with a jaw force F and then stands still. All contacts share a load according to their stiffness,
as in a preloaded bolt (VDI 2230), and the push of the jaw changes with it. A hydraulic or pneumatic jaw follows the part and
keeps its push; the load is then taken by the other contacts as if the jaw were not there.

Let contacts be springs of the same stiffness and the jaw one of s times that, A be the contact matrix (see
``kernels.statics.contact_matrix``), B = A^-T, and h its last column, the peg forces per unit of jaw force. A jaw that keeps
its force answers a load g = (g_x, g_y, m / L, 0) with f0 = B g. All forces that balance the load are f0 + k h. A spring of
the jaw takes up k / s, so the forces are those with the least energy sum f^2 + k^2 / s (Castigliano; S. Timoshenko and J. N.
Goodier, *Theory of Elasticity*, 3rd ed. 1970, section 92; for grasps A. Bicchi, *On the problem of decomposing grasp and
manipulation forces in multiple whole-limb manipulation*, Robotics and Autonomous Systems 13, 1994):

    f = f0 - h (h . f0) / (1 / s + h . h),

which is f0 for s = 0, and the part of f0 at right angles to h for a rigid jaw. It holds while every peg stays in contact.
Two clamps have a column each in H, the forces are f0 + H k, and f = f0 - H (1 / s + H'H)^-1 H'f0.
"""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.statics.reactions import HALF, HIGH_X, HIGH_Y, LOW_X, LOW_Y, MIDDLE_X, MIDDLE_Y
from workhold.real import real

__all__ = ["jaw_forces_needed", "jaw_stiffness", "jaw_words", "shared_forces"]

Array = NDArray[np.float64]
STIFFNESS = {"screw": inf, "constant": 0.0}


def jaw_stiffness(jaw: str | float) -> float:
    """How many times as stiff as one contact the closed jaw is.

    Parameters
    ----------
    jaw : "screw" (rigid once it is closed), "constant" (it keeps its force), or the number itself.

    Raises
    ------
    InputError
        For anything else.

    Examples
    --------
    >>> jaw_stiffness("screw"), jaw_stiffness("constant"), jaw_stiffness("2.5")
    (inf, 0.0, 2.5)
    """
    if isinstance(jaw, str):
        word = jaw.strip().lower()
        if word in STIFFNESS:
            return STIFFNESS[word]
    try:
        value = float(jaw) if isinstance(jaw, str) else real(jaw)
    except ValueError:
        value = -1.0
    if not value >= 0:
        raise InputError(
            f"jaw {str(jaw)[:40]!r} is not known: give screw, constant, or how many times as stiff as one contact it is."
        )
    return value


def jaw_words(stiffness: float, toolkit: Toolkit) -> str:
    """What a jaw, or a clamp, is, for people.

    >>> from workhold import Plate, Vise
    >>> jaw_words(0.0, Plate(pitch=20, peg_radius=5)), jaw_words(5.0, Vise(pitch=10, columns=2, peg_radius=3))
    ('a clamp that keeps its force', 'a screw vise, its jaw 5 times as stiff as a contact')
    """
    if stiffness == 0:
        return f"a {toolkit.moving.noun} that keeps its force"
    return f"{toolkit.locked} " + ("locked" if stiffness == inf else f"{stiffness:g} times as stiff as a contact")


def shared_forces(forces: Array, closing: Array, stiffness: float) -> Array:
    """Peg forces per unit of g_x, g_y, moment and jaw force behind a jaw of a stiffness.

    Parameters
    ----------
    forces : (P, 4) the same for a jaw that keeps its force.
    closing : (P, M) peg forces per unit of the force of each jaw or clamp, H.

    Returns
    -------
    (P, 4) array, whose last column is h still: the jaw was closed before the load came.
    """
    if stiffness == 0:
        return forces
    out = forces.copy()
    springs = np.eye(closing.shape[1]) / stiffness + closing.T @ closing
    out[:, :3] -= closing @ np.linalg.solve(springs, closing.T @ forces[:, :3])
    return out


def jaw_forces_needed(inverses: Array, closing: Array, length: float, loads: Array) -> Array:
    """Jaw forces (N,) in N above which no peg of a screw vise lets go under any load; never negative.

    Peg i presses with f0_i - h_i (h . f0) / (h . h) + F h_i, where h_i > 0. Of two clamps F is the sum of their forces, at
    the working ratio, and what is taken from f0 is its part in the plane of both.

    Parameters
    ----------
    inverses : (N, 4, P) of the contact matrices; their last rows are h.
    closing : (N, P, M) peg forces per unit of the force of each jaw or clamp.
    length : L in mm.
    loads : (M, 11) rows, see ``kernels.statics.reactions``.
    """
    held = inverses[:, 3]
    back = np.swapaxes(closing, 1, 2)
    taken = np.linalg.solve(back @ closing, back @ np.swapaxes(inverses[:, :3], 1, 2))
    shares = np.swapaxes(closing @ taken, 1, 2) / held[:, None]
    a, b, c = np.moveaxis(shares - inverses[:, :3] / held[:, None], 1, 0)
    most = np.zeros(len(inverses))
    for load in loads:
        force, px, py, moment = load[0], load[1] / length, load[2] / length, load[3] / length
        x, y = a - py * c, b + px * c
        size = np.hypot(x, y)
        ends = np.maximum(x * load[LOW_X] + y * load[LOW_Y], x * load[HIGH_X] + y * load[HIGH_Y])
        largest = np.where(x * load[MIDDLE_X] + y * load[MIDDLE_Y] >= size * load[HALF], size, ends)
        most = np.maximum(most, (moment * c + force * largest).max(axis=1))
    return most
