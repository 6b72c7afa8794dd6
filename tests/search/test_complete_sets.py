"""The search lists exactly the fixtures of complete sets found by an independent method."""

from __future__ import annotations

from math import dist

import pytest

from fixture_sets import SETS, Judge, complete_set, listed, near_an_end


@pytest.mark.thorough
@pytest.mark.parametrize("name", SETS)
def test_complete_set_is_reproduced(name: str) -> None:
    """Every fixture that is not marginal is listed once, and nothing else is; every one passes the checker. The search's own
    account adds up, with nothing undecided."""
    truth, result = complete_set(name)
    judge = Judge(result.workpiece, result.toolkit)
    proof = result.proof
    assert proof is not None
    assert proof.undecided == ()
    assert proof.candidates == proof.discarded_by_bound + proof.verified
    assert proof.verified >= sum(result.found.values())
    ours = listed(result)
    assert len(ours) > 0
    identities = {}
    for fixture in ours:
        faults, marginal = judge.check(fixture)
        assert faults == []
        key, theta, place = judge.identity(fixture)
        known = identities.setdefault(key, [])
        # The sets do not say where the part lies; the same holes and orientation in another place is another fixture.
        assert marginal or not any(abs(theta - t) < 1e-5 and dist(place, p) < 1e-5 for t, p, _ in known)
        known.append((theta, place, marginal))
    expected = {}
    for fixture in truth["fixtures"]:
        key, theta, _ = judge.identity(
            fixture | {"pose": {"theta_deg": fixture["theta_deg"], "x": 0.0, "y": 0.0}}
        )
        expected.setdefault(key, []).append((theta, None, fixture["marginal"]))
    for have, want in ((identities, expected), (expected, identities)):
        for key, poses in want.items():
            for theta, _, marginal in poses:
                near = [
                    t for t, *_ in have.get(key, []) if abs((theta - t + 3) % 6.283185307179586 - 3) < 1e-5
                ]
                assert near or marginal, (key, theta)


@pytest.mark.thorough
@pytest.mark.parametrize("name", SETS)
def test_no_listed_contact_is_at_an_end(name: str) -> None:
    """A peg wedged in a corner or standing on one is not listed: only its own face holds it (these sets have no tangent
    joints that a contact falls on)."""
    _, result = complete_set(name)
    judge = Judge(result.workpiece, result.toolkit)
    assert not any(near_an_end(judge, fixture, 1e-10) for fixture in listed(result))
