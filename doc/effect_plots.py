# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Plot what an effect does: the same simulated experiment with and without it."""

from __future__ import annotations

from pathlib import Path
import runpy
from typing import Any

import contact_estimation as ce
from contact_estimation.parameters import changed
from contact_estimation.plant.simulation import simulate_experiment
from contact_estimation.reference.experiment import Experiment, Multisine, Segment
import matplotlib

matplotlib.use('Agg')
from matplotlib import pyplot  # noqa: E402

_INK, _WITHOUT, _WITH = '#1f2933', '#9aa5b1', '#0b6e99'
_EXAMPLES = Path(__file__).resolve().parent.parent / 'test' / 'effect_examples.py'
example_values = runpy.run_path(str(_EXAMPLES))['example_values']
"""Return parameters of a plausible size for an effect, by its name."""

_TOUCHES = Experiment('two touches', -0.004, tuple(
    segment for depth in (0.010, 0.013) for segment in (
        Segment(0.3, depth), Segment(0.1, depth),
        Segment(0.8, depth, position_excitation=Multisine(0.003, [9.0, 31.0])),
        Segment(0.3, -0.004), Segment(0.1, -0.004))
))
_MODEL = ce.PlantParameters(sample_rate=500.0, integration_rate=2000.0)
_runs: dict[str, Any] = {}


def plot_effect(name: str, folder: Path) -> dict[str, float]:
    """
    Plot the simulated experiment with and without an effect.

    Parameters
    ----------
    name : str
        Key of EFFECTS.
    folder : Path
        Where `name`.png is written; an existing plot is kept.

    Returns
    -------
    values : dict of str to float
        Parameters of the effect in the plot.

    """
    values = dict(zip(ce.EFFECTS[name].neutral(), example_values(name)))
    path = folder / f'{name}.png'
    if not path.exists():
        effect = {f'physics.{name}.{key}': value for key, value in values.items()}
        _plot(ce.EFFECTS[name].port, _run(''), _run(name, **effect), path)
    return values


def _run(name: str, **physics: float) -> Any:
    """Return time [s], pressing force [N] and position [mm] of the experiment."""
    if name not in _runs:
        simulated = simulate_experiment(changed(_MODEL, physics), _TOUCHES)
        force, position, _ = simulated.measured
        _runs[name] = simulated.stamp_ns * 1e-9, -force, 1e3 * position
    return _runs[name]


def _plot(port: str, without: Any, with_effect: Any, path: Path) -> None:
    figure, axes = pyplot.subplots(1, 2, figsize=(7.2, 2.3), layout='constrained')
    for (t, force, position), colour in ((without, _WITHOUT), (with_effect, _WITH)):
        axes[0].plot(t, force, color=colour, linewidth=1.2)
        if port == 'contact':
            axes[1].plot(position, force, color=colour, linewidth=0.8)
        elif port == 'force_sensor':
            axes[1].plot(without[1], force, color=colour, linewidth=0.8)
        else:
            axes[1].plot(t, position - without[2], color=colour, linewidth=1.2)
    axes[0].set(xlabel='time [s]', ylabel='force -F_e [N]')
    axes[1].set(**{
        'contact': {'xlabel': 'position x - x_e [mm]', 'ylabel': 'force -F_e [N]'},
        'force_sensor': {'xlabel': 'true force [N]', 'ylabel': 'measured force [N]'},
        'robot': {'xlabel': 'time [s]', 'ylabel': 'change of position [mm]'},
    }[port])
    for axis in axes:
        axis.spines[['top', 'right']].set_visible(False)
        axis.tick_params(labelsize=8, colors=_INK)
        axis.grid(color='#e4e7eb', linewidth=0.6)
    figure.savefig(path, dpi=75)
    pyplot.close(figure)
