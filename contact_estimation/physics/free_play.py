# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, ContactEffect, dataclass, Need, Number, optional_parameter, positive, Prior, Scales, Seen)


@dataclass(frozen=True)
class FreePlay(ContactEffect):
    """
    The spring acts only beyond a gap that is free on both sides.

    s = u - min(max(u, -gap / 2), gap / 2), u = d - centre. The two push away from the gap. A
    damper beside the play acts at all times; one behind it is met at either end, and holds back
    from neither. On a wall that only pushes it is a dead zone. Nordin and Gutman, Controlling
    mechanical systems with backlash: a survey, Automatica 2002, section 3.1.
    """

    gap: float = optional_parameter('Width of the play', 'm', minimum=0.0)
    centre: float = optional_parameter('Middle of the play, from x_e', 'm')
    beside: float = optional_parameter(
        'Part of the damper that acts within the gap too', '1', minimum=0.0, maximum=1.0)

    equation = ('F_e = -(beside B_e v + K_e s + (1 - beside) B_e v), s = u - sat(u, gap / 2), '
                'u = d - centre; the latter two not within the gap')
    family = 'clearance'
    needs = frozenset({Need.ATTACHMENT, Need.SPRING})

    def deflection(self, t: Number, d: Number, m: Any) -> Number:
        u, half = d - self.centre, 0.5 * self.gap
        return positive(u - half, m) - positive(-u - half, m)

    def carried(self, d: Number, spring: Number, damper: Number, m: Any) -> Number:
        u, half = d - self.centre, 0.5 * self.gap
        behind = spring + (1.0 - self.beside) * damper
        pushed: Any = positive(behind, m) * (u > half) - positive(-behind, m) * (u < -half)
        return self.beside * damper + pushed

    def may_show(self, seen: Seen) -> bool:
        """Need a motion that reaches the play: else it is an offset."""
        return abs(self.centre) - 0.5 * self.gap <= seen.depth

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(share * scales.depth, 0.0, 1.0) for share in (0.02, 0.1, 0.3, 0.8, 1.4)],
                     largest=scales.depth)
