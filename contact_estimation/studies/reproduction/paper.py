# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Values of Erickson, Weber and Sharf (2003), sections 4 and 5; omitted zeros restored."""

from __future__ import annotations

from typing import NamedTuple

K_E, B_E = 4800.0, 200.0
"""True stiffness [N/m] and damping [N s/m] of the wall."""

NOISE_VARIANCE = 1.0 / 3.0
"""Variance of the uniform force noise of +-1 N [N^2]."""


class PaperError(NamedTuple):
    """Printed |error| at the last instant of contact [%]; in places an upper bound."""

    stiffness: float
    damping: float


PAPER: dict[tuple[str, str], PaperError] = {
    ('simulation_sine', 'indirect_adaptive'): PaperError(0.1, 1.0),
    ('simulation_sine', 'mrac'): PaperError(0.1, 1.0),
    ('simulation_sine', 'rls'): PaperError(1.3, 1.0),
    ('simulation_none', 'signal_processing'): PaperError(13.0, 13.0),
    ('simulation_none', 'indirect_adaptive'): PaperError(2.4, 3.0),
    ('simulation_none', 'mrac'): PaperError(0.1, 0.0),
    ('simulation_none', 'rls'): PaperError(1.7, 2.5),
    ('testbed_sine', 'indirect_adaptive'): PaperError(12.6, 15.7),
    ('testbed_sine', 'rls'): PaperError(3.5, 22.0),
    ('testbed_none', 'signal_processing'): PaperError(37.0, 82.0),
    ('testbed_none', 'indirect_adaptive'): PaperError(8.9, 60.0),
    ('testbed_none', 'rls'): PaperError(19.2, 85.0),
}
"""Printed errors by case and estimator."""
