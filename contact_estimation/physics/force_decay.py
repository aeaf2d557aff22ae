# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force sensor whose reading decays under load."""

from __future__ import annotations

from dataclasses import dataclass

from .force_creep import ForceCreep, ForceCreepParameters
from ..parameters.specification import optional_parameter


@dataclass(frozen=True)
class ForceDecayParameters(ForceCreepParameters):
    """Parameters of `ForceDecay`."""

    share: float = optional_parameter(
        'Force that vanishes in time, as a share of that at once', '1', minimum=0.0)


class ForceDecay(ForceCreep):
    """
    F - share y, tau y' + y = F: the creep of a load cell with the other sign.

    A specimen that relaxes looks the same: it takes the end of a contact, after which the reading
    is off, or a robot that feels the true force, to tell.
    """

    name = 'force_decay'
    equation = "F_measured = F_e - share y, tau y' + y = F_e"
    description = 'The force sensor creeps: part of a force vanishes with time.'
    Parameters = ForceDecayParameters
    needs_touch = True

    def __init__(self, values: ForceDecayParameters) -> None:
        super().__init__(values)
        self._share = -values.share
