# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import dataclass, optional_parameter, Prior, RobotEffect, Scales


@dataclass(frozen=True)
class CommandDelay(RobotEffect):
    """The robot follows its reference with a delay."""

    delay: float = optional_parameter('Delay of the reference', 's', minimum=0.0)

    equation = 'x_r(t - delay) in eq. (1)'
    family = 'timing'

    @property
    def reference_delay(self) -> float:
        return self.delay

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(delay,) for delay in scales.delays()[::2]], largest=0.1)
