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
    """The result of a check for wrong use."""

    name: str  # as in `CHECKS`
    ok: bool  # false if something is to be corrected
    text: str  # measured, expected and, if not ok, what to change
    fatal: bool = False  # whether nothing can be diagnosed before that
    could_cause: frozenset[str] = frozenset()  # effects that the wrong use would be mistaken for
    tested: bool = True  # false if another check that failed leaves it without meaning


class Finding(NamedTuple):
    """The outcome of a test: `ok`, `text` and, if not ok, `fatal`, as of `Check`."""

    ok: bool
    text: str
    fatal: bool = True


@dataclass(frozen=True)
class Test:
    """A test for one kind of wrong use."""

    find: Callable[[Evidence], Finding]  # from the evidence of a recording to the finding
    after: tuple[str, ...] = ()  # checks that must have passed: else this one has no meaning
    # effects for which a failure that is not fatal would be mistaken
    could_cause: frozenset[str] = frozenset()
    # whether it has a meaning only where nothing else is fitted together with the recording
    alone: bool = False
    # from the signals that fail to those to be fitted, where that is beyond doubt
    put_right: Callable[[Signals], Signals] | None = None


def of_families(*families: str) -> frozenset[str]:
    """Return the names of the effects of some families."""
    return frozenset(name for name, cls in EFFECTS.items() if cls.family in families)
