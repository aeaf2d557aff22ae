# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is plotted, once for the live view and for the layouts of other viewers."""

from __future__ import annotations

from typing import NamedTuple

from ..figures import BLUE, MUTED, ORANGE

BAND = '#8cc8e0'
"""Of the bounds of an estimate, on a light and on a dark ground."""


class Curve(NamedTuple):
    """One curve of a plot."""

    key: str  # name in the view's tree
    label: str  # in the legend
    topic: str  # where the value comes from, without the leading slash
    field: str  # of the message, as in 'points[0].positions[0]'
    scale: float = 1.0  # factor of the field
    colour: str = MUTED  # as '#rrggbb'
    width: float = 1.0  # of the line, in points
    # topic of the standard deviation whose multiple `stds` is added; '' for none
    std_topic: str = ''
    stds: float = 0.0  # that multiple


class Plot(NamedTuple):
    """Curves with a common axis."""

    key: str  # name in the view's tree
    # quantity, unit: what is plotted
    quantity: str
    unit: str
    curves: tuple[Curve, ...]  # from the lowest to the uppermost
    unscaled_unit: str = ''  # unit of the fields without the factors of the curves

    @property
    def title(self) -> str:
        """Quantity and unit."""
        return f'{self.quantity} [{self.unit}]'


def _estimate(key: str, unit: str, symbol: str) -> Plot:
    own, std = f'estimator_node/{key}', f'estimator_node/{key}_std'
    return Plot(key, key, unit, (
        Curve('upper', f'{symbol} + 2 std', own, 'vector.x', 1.0, BAND, 0.8, std, 2.0),
        Curve('lower', f'{symbol} - 2 std', own, 'vector.x', 1.0, BAND, 0.8, std, -2.0),
        Curve('estimate', symbol, own, 'vector.x', 1.0, BLUE, 1.8),
    ))


_POSITION = 'points[0].positions[0]'
PLOTS = (
    Plot('force', 'pressing force', 'N', (
        Curve('measured', '-F_e measured', 'wrench', 'wrench.force.x', -1.0, MUTED),
        Curve('desired', 'F_r desired', 'reference_trajectory', 'points[0].effort[0]', 1.0,
              ORANGE, 1.5),
    )),
    Plot('motion', 'position', 'mm', (
        Curve('desired', 'x_d desired', 'desired_trajectory', _POSITION, 1e3, BAND, 2.5),
        Curve('reference', 'x_r reference', 'reference_trajectory', _POSITION, 1e3, ORANGE, 1.5),
        Curve('measured', 'x measured', 'joint_states', 'position[0]', 1e3, MUTED, 1.5),
    ), 'm'),
    _estimate('stiffness', 'N/m', 'K_e'),
    _estimate('damping', 'N s/m', 'B_e'),
    Plot('model_fit', 'residual', 'std of the noise', (
        Curve('ratio', 'model fit', 'estimator_node/model_fit', 'data', 1.0, BLUE, 1.5),
    )),
)
"""All plots, from top to bottom; topics as the loop records them."""
