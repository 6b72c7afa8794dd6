"""The bound of the location error of two and two pegs on short stretches of faces is below that of any contacts there."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.base.tables import Precision
from workhold.kernels.contact.location_bounds import CONTACT_LENGTH, bound_least_error_of_four

Array = NDArray[np.float64]
PEG, FACE, LENGTH = 0.015, 0.01, 50.0
CORNERS = np.array([(-60.0, -40.0), (60.0, -40.0), (70.0, 10.0), (20.0, 45.0), (-60.0, 40.0)])
APART = max(float(np.hypot(*(one - other))) for one in CORNERS for other in CORNERS)
BORES = np.array([(-35.0, -20.0), (40.0, 5.0), (0.0, 20.0)])


@frozen
class Contact:
    """A peg on a side of the part, or in one of its bores.

    Parameters
    ----------
    face : number of the side, or of the bore after all sides.
    at : place along the side from its middle in mm, or direction in the bore in radians.
    """

    face: int
    at: float

    @property
    def is_in_bore(self) -> bool:
        return self.face >= len(CORNERS)

    def wrench(self) -> Array:
        """Normal, and moment about the origin over L."""
        if self.is_in_bore:
            normal = np.array([np.cos(self.at), np.sin(self.at)])
            place = BORES[self.face - len(CORNERS)] - 5.0 * normal
        else:
            start, end = CORNERS[self.face], CORNERS[(self.face + 1) % len(CORNERS)]
            along = (end - start) / np.hypot(*(end - start))
            normal, place = np.array([along[1], -along[0]]), (start + end) / 2.0 + self.at * along
        return np.array([*normal, (place[0] * normal[1] - place[1] * normal[0]) / LENGTH])

    def moved(self, by: float) -> Contact:
        """A contact of the same face so far away, in mm or radians."""
        return Contact(self.face, self.at + by)


def location_error(contacts: list[Contact], psi: float) -> float:
    """The largest movement in mm of a corner: every sign of every error is tried, and the four equations are solved.

    The last two pegs move with their carrier along psi.
    """
    rows = np.zeros((4, 4))
    for k, contact in enumerate(contacts):
        rows[k, :3] = contact.wrench()
        rows[k, 3] = -(k > 1) * (rows[k, 0] * np.cos(psi) + rows[k, 1] * np.sin(psi))
    faces = sorted({contact.face for contact in contacts})
    signs = np.array(list(product((-1.0, 1.0), repeat=4 + len(faces))))
    off = PEG * signs[:, :4]
    for k, contact in enumerate(contacts):
        off[:, k] += FACE * signs[:, 4 + faces.index(contact.face)]
    if np.linalg.matrix_rank(rows) < 4:
        return np.inf
    x, y, turn, _ = np.linalg.solve(rows, off.T)
    turn = turn / LENGTH
    return float(max(np.hypot(x - turn * at[1], y + turn * at[0]).max() for at in CORNERS))


def bound(contacts: list[Contact], psi: float, half: float, sizes: list[float]) -> float:
    """The bound for contacts within so many mm or radians of these, and psi within ``half``."""
    spots, normals, swings = np.zeros((4, CONTACT_LENGTH)), [], []
    for k, (contact, size) in enumerate(zip(contacts, sizes, strict=True)):
        spots[k, :3] = contact.wrench()
        # Bores lie inside the part, so their centres move no farther than its corners.
        spots[k, 3], spots[k, 4] = size * (1.0 if contact.is_in_bore else 2.0 / APART), contact.face
        normals.append(spots[k, 0] * np.cos(psi) + spots[k, 1] * np.sin(psi))
        swings.append(size * contact.is_in_bore + half)
    larger = max(abs(normals[2]) - swings[2], abs(normals[3]) - swings[3])
    if larger <= 0.0:
        return 0.0
    angles = np.arange(8) * (np.pi / 8)
    probes = np.array(
        [(np.cos(a), np.sin(a), (np.sin(a) * x - np.cos(a) * y) / LENGTH) for a in angles for x, y in CORNERS]
    )
    count = len(CORNERS) + len(BORES)
    given = Precision(np.arange(count), np.ones(count), np.ones(count), probes, PEG, FACE, np.inf, np.inf)
    extra = (2.0 * swings[2] / larger, 2.0 * swings[3] / larger)
    along = (normals[2], normals[3])
    return bound_least_error_of_four(*spots, along, extra, given, np.empty((8, 3)), np.empty(4), np.inf)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(4))
def test_no_contacts_in_the_stretches_have_a_smaller_error(seed: int) -> None:
    """For sides and bores, wide stretches and narrow ones, and turned pegs; narrow ones are bounded sharply."""
    rng, sharp, tried = np.random.default_rng(seed), 0, 0
    while tried < 60:
        faces = rng.integers(0, len(CORNERS) + len(BORES), 4)
        contacts = [
            Contact(
                int(face), float(rng.uniform(-15.0, 15.0) if face < len(CORNERS) else rng.uniform(0, 6.28))
            )
            for face in faces
        ]
        psi, width = float(rng.uniform(0.0, 6.28)), float(10.0 ** rng.uniform(-5.0, 0.0))
        half = 0.1 * width
        sizes = [width * (0.3 if contact.is_in_bore else 5.0) for contact in contacts]
        least = bound(contacts, psi, half, sizes)
        if not 0.0 < least < 1.0:
            continue
        tried += 1
        nearest = np.inf
        for _ in range(12):
            some = [
                one.moved(float(rng.choice([-1, 1, 0.3])) * size)
                for one, size in zip(contacts, sizes, strict=True)
            ]
            turned = psi + float(rng.uniform(-half, half))
            nearest = min(nearest, location_error(some, turned))
        assert least <= nearest * (1.0 + 1e-9)
        sharp += width < 1e-3 and least > 0.9 * nearest
    assert sharp > 5


@pytest.mark.thorough
def test_the_travel_counts_where_moving_pegs_hardly_clamp() -> None:
    """Their normals turn in bores, and a small part of the travel becomes a large movement."""
    rng, sharpest = np.random.default_rng(1), 0.0
    for _ in range(400):
        psi, width = float(rng.uniform(0.0, 6.28)), float(10.0 ** rng.uniform(-2.5, -1.0))
        standing = [Contact(int(rng.integers(len(CORNERS))), float(rng.uniform(-15.0, 15.0))) for _ in "ab"]
        tilts = rng.uniform(0.03, 0.3, 2) * rng.choice([-1.0, 1.0], 2)
        moving = [
            Contact(
                len(CORNERS) + int(rng.integers(len(BORES))), psi + np.pi / 2 * rng.choice([-1, 1]) + tilt
            )
            for tilt in tilts.tolist()
        ]
        least = bound([*standing, *moving], psi, 0.5 * width, [1e-6, 1e-6, width, width])
        if not 0.0 < least < 5.0:
            continue
        nearest = min(
            location_error([*standing, moving[0].moved(one), moving[1].moved(two)], psi + turn)
            for one, two, turn in product((-width, width), (-width, width), (-0.5 * width, 0.5 * width))
        )
        assert least <= nearest * (1.0 + 1e-9)
        sharpest = max(sharpest, least / nearest)
    assert sharpest > 0.9
