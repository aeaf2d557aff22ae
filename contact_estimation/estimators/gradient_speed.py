# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Speed of eq. (25): fixed gains adapt with the square of the depth, and starve on stiff walls."""

from math import sqrt

_SLOWEST_S = 2.0
"""Time constant of K_hat above which a contact is over before it has adapted."""

_USUAL_FORCE = 50.0  # [N], for a statement before any contact
_REMEDY = 'choose another estimator'


def stiffest_wall(stiffness_gain: float) -> float:
    """
    Return the stiffness above which eq. (25) adapts too slowly under 50 N.

    With phi = d = F / K, eq. (25) has the time constant 1 / (Gamma^-1 d^2).

    stiffness_gain: entry of Gamma^-1 for K [N/m/(N m s)]
    Returns stiffness: [N/m]
    """
    return _USUAL_FORCE * sqrt(stiffness_gain * _SLOWEST_S)


def limitation_of(stiffness_gain: float, remedy: str = _REMEDY) -> str:
    """
    State the walls for which a gain is too small, for a warning at start-up.

    stiffness_gain: entry of Gamma^-1 for K [N/m/(N m s)]
    """
    return (f'with stiffness_gain {stiffness_gain:g} K_hat needs over {_SLOWEST_S:g} s on walls '
            f'above {stiffest_wall(stiffness_gain):.3g} N/m pressed with {_USUAL_FORCE:g} N; '
            f'{remedy} for stiffer ones')
