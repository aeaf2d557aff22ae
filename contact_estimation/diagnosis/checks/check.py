# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a check is, and its result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, NamedTuple

from .evidence import Evidence
from ..observe.signals import Signals
from ...physics import EFFECTS


@dataclass(frozen=True)
class Check:
    """
    The result of a check for wrong use.

    Attributes
    ----------
    name : str
        As in `CHECKS`.
    ok : bool
        False if something is to be corrected.
    text : str
        Measured, expected and, if not ok, what to change.
    fatal : bool
        Whether nothing can be diagnosed before that.
    could_cause : frozenset of str
        Effects that the wrong use would be mistaken for.
    tested : bool
        False if another check that failed leaves it without meaning.

    """

    name: str
    ok: bool
    text: str
    fatal: bool = False
    could_cause: frozenset[str] = frozenset()
    tested: bool = True


class Finding(NamedTuple):
    """The outcome of a test: `ok`, `text` and, if not ok, `fatal`, as of `Check`."""

    ok: bool
    text: str
    fatal: bool = True


@dataclass(frozen=True)
class Test:
    """
    A test for one kind of wrong use.

    Attributes
    ----------
    find : callable
        From the evidence of a recording to the finding.
    after : tuple of str
        Checks that must have passed: else this one has no meaning.
    could_cause : frozenset of str
        Effects for which a failure that is not fatal would be mistaken.
    alone : bool
        Whether it has a meaning only where nothing else is fitted together with the recording.
    put_right : callable, optional
        From the signals that fail to those to be fitted, where that is beyond doubt.

    """

    find: Callable[[Evidence], Finding]
    after: tuple[str, ...] = ()
    could_cause: frozenset[str] = frozenset()
    alone: bool = False
    put_right: Callable[[Signals], Signals] | None = None


def of_families(*families: str) -> frozenset[str]:
    """Return the names of the effects of some families."""
    return frozenset(name for name, cls in EFFECTS.items() if cls.family in families)
