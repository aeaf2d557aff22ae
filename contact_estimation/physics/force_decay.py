# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .force_creep import ForceCreep
from .law import dataclass, Need, optional_parameter


@dataclass(frozen=True)
class ForceDecay(ForceCreep):
    """
    The force sensor creeps: part of a force vanishes with time.

    A specimen that relaxes looks the same: it takes the end of a contact, after which the reading
    is off, or a robot that feels the true force, to tell.
    """

    share: float = optional_parameter(
        'Force that vanishes in time, as a share of that at once', '1', minimum=0.0)

    equation = "F_measured = F_e - share y, tau y' + y = F_e"
    needs = frozenset({Need.TOUCH})
    sign = -1.0
