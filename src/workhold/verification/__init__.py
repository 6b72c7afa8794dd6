"""Proof of results after the fact, in ball arithmetic and without anything of the search.

:func:`verify` and :func:`verify_file` say of every fixture of a result: proven, refuted or undecided.
"""

from workhold.verification.verify import (
    Judge,
    Ruling,
    Unproven,
    Verification,
    verify,
    verify_file,
    verify_fixture,
)

__all__ = ["Judge", "Ruling", "Unproven", "Verification", "verify", "verify_file", "verify_fixture"]
