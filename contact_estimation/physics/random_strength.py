# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Random effects of open magnitude, and the distributions from which they are drawn."""

from __future__ import annotations

from math import exp, log
from typing import Callable, Mapping

from numpy.random import Generator

Values = Mapping[str, float]
"""Parameters of an effect by name."""

Strength = Callable[[float], Values]
"""From a magnitude, 0 (absent) to 1 (largest plausible), to the parameters of an effect."""


def log_uniform(rng: Generator, low: float, high: float) -> float:
    """Draw a positive number whose logarithm is uniformly distributed."""
    return exp(rng.uniform(log(low), log(high)))


def random_sign(rng: Generator) -> float:
    """Draw -1 or 1 with equal probability."""
    return float(rng.choice([-1.0, 1.0]))
