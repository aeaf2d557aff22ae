# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Whether the poses of a recording determine mass and centre of a tool, and which are missing."""

from __future__ import annotations

import numpy as np

from .tool_load import Array
from ..exceptions import EstimationError

_LEAST_SPREAD = 0.15  # standard deviation of gravity's direction: about 9 degrees


def require_directions(f: Array) -> None:
    """
    Require that gravity has turned about two axes of the sensor.

    The force separates the mass from its bias where gravity's direction d varies at all; the
    torque m c x d separates the centre along u from the torque's bias where d varies across u.
    So the variation must span two directions.

    Parameters
    ----------
    f : ndarray, shape (N, 3)
        Weight per mass in the sensor's frame [m/s^2].

    """
    directions = f / np.linalg.norm(f, axis=1, keepdims=True)
    mean = directions.mean(axis=0)
    _, spreads, axes = np.linalg.svd((directions - mean) / np.sqrt(len(f)), full_matrices=False)
    if spreads[1] >= _LEAST_SPREAD:
        return
    one_turn = spreads[0] >= _LEAST_SPREAD
    missing = axes[2:] if one_turn else _across(mean)
    undetermined = 'the centre of gravity' if one_turn else 'mass and centre of gravity'
    varies = f'varies only along {_text(axes[0])}' if one_turn else 'hardly varies'
    named = ' and '.join(dict.fromkeys(_text(each) for each in missing))
    raise EstimationError(
        f"gravity in the sensor's frame {varies} (mean direction {_text(mean, sign=True)}), which "
        f'does not determine {undetermined}; add poses in which gravity points along {named} of '
        'the sensor, either way: tilt the tool by 60 degrees or more towards each'
    )


def _across(mean: Array) -> Array:
    """Return two axes of the sensor that are most nearly perpendicular to a direction."""
    order = np.argsort(np.abs(mean))
    return np.eye(3)[order[:2]]


def _text(direction: Array, sign: bool = False) -> str:
    """Write a direction by the axis nearest to it, or by its components."""
    unit = direction / max(float(np.linalg.norm(direction)), 1e-12)
    main = int(np.argmax(np.abs(unit)))
    if abs(unit[main]) > 0.95:
        return ('-' if sign and unit[main] < 0.0 else '') + 'xyz'[main]
    return '(' + ', '.join(f'{part:.2f}' for part in unit) + ')'
