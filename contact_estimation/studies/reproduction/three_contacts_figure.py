# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Figure of the simulation and estimates of the three contacts."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np

from .three_contacts_world import B_E, Instant, K_E, MU, POINTS
from ...estimators.contact_points_estimator import ContactPointsEstimate
from ...figures import require_matplotlib

_INK, _TRUE = '#1f2933', '#c2410c'
_COLOURS = ('#0b6e99', '#6b8e23', '#8e5aa8')
_LIMITS = {'stiffness': (0.7 * K_E, 1.3 * K_E), 'damping': (0.0, 2.2 * B_E),
           'friction': (-0.05, 0.5)}


def plot_three_contacts(
    instants: Sequence[Instant],
    runs: Mapping[str, Sequence[ContactPointsEstimate]],
    path: Path,
) -> None:
    """Plot the force at each point, the measured force and the estimates of each variant."""
    pyplot = require_matplotlib()
    figure, axes = pyplot.subplots(5, 1, figsize=(9.0, 11.0), sharex=True, layout='constrained')
    figure.suptitle('Three contact points, eq. (6)', color=_INK, x=0.01, ha='left', fontsize=12)
    t = np.array([i.t for i in instants])
    _plot_points(axes[0], t, instants)
    _plot_force(axes[1], t, instants)
    for axis, name, true, label in (
        (axes[2], 'stiffness', K_E, 'K_e [N/m]'),
        (axes[3], 'damping', B_E, 'B_e [N s/m]'),
        (axes[4], 'friction', MU, 'mu'),
    ):
        _plot_estimates(axis, t, runs, name, true)
        axis.set_ylabel(label)
    axes[4].set_xlabel('time [s]')
    for axis in axes:
        axis.spines[['top', 'right']].set_visible(False)
        axis.grid(color='#e4e7eb', linewidth=0.6)
        axis.legend(frameon=False, fontsize=8, loc='upper left', ncols=4)
    figure.savefig(path, dpi=130)
    pyplot.close(figure)


def _plot_points(axis: Any, t: np.ndarray, instants: Sequence[Instant]) -> None:
    forces = np.array([np.linalg.norm(i.forces, axis=1) for i in instants])  # (T, 3) [N]
    for column, (name, colour) in enumerate(zip(POINTS, _COLOURS)):
        axis.plot(t, forces[:, column], color=colour, linewidth=1.0, label=name)
    axis.set_ylabel('force at a point [N]')


def _plot_force(axis: Any, t: np.ndarray, instants: Sequence[Instant]) -> None:
    felt = np.array([i.sample.force for i in instants])  # (T, 3) [N]
    for column, (name, colour) in enumerate(zip('xyz', _COLOURS)):
        axis.plot(t, felt[:, column], color=colour, linewidth=0.6, label=f'F_{name} measured')
    axis.set_ylabel('sum, with noise [N]')


def _plot_estimates(
    axis: Any, t: np.ndarray, runs: Mapping[str, Sequence[ContactPointsEstimate]], name: str,
    true: float,
) -> None:
    axis.axhline(true, color=_TRUE, linewidth=1.0, label=f'true {true:g}')
    for (variant, estimates), colour in zip(runs.items(), _COLOURS):
        value = np.array([getattr(e, name) for e in estimates])
        axis.plot(t, value, color=colour, linewidth=1.2, label=variant)
    axis.set_ylim(*_LIMITS[name])
