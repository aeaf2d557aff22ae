# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Types and helper functions shared by the laws.

A law is written once and evaluated on single numbers (m is `math`) by the plant and on whole
arrays (m is `numpy`) by the diagnosis.
"""

from __future__ import annotations

import math
from typing import Any, Iterator, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Number = TypeVar('Number', float, Any)

SIGN_VELOCITY = 4e-4
"""Usual width of the smooth sign [m/s]: sgn(v) = tanh(v / SIGN_VELOCITY)."""


def positive(x: Number, m: Any) -> Number:
    """Return max(x, 0)."""
    return max(x, 0.0) if m is math else m.maximum(x, 0.0)


def stretches(flag: Flags) -> Iterator[tuple[int, int]]:
    """
    Split a flag into runs of equal values.

    flag (N,): for example whether there is contact
    """
    edges = [0, *(np.flatnonzero(np.diff(flag)) + 1).tolist(), len(flag)]
    yield from zip(edges[:-1], edges[1:])
