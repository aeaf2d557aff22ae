# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Peers of the estimators study: filters of other packages, used as their manuals show."""

from __future__ import annotations

from typing import Any, Callable, Iterator

import numpy as np

from .study_worlds import Array, RATE, World
from ...exceptions import MissingPackageError

Trace = tuple[Array, Array, Array, Array]
"""K_hat, B_hat and their standard deviations at each sample, shape (N,) each."""

_TOUCH = 6.0  # standard deviations of the force noise above which the peers update
_START = np.array([3000.0, 50.0])
_START_STD = np.array([1e5, 1e4])
_WALK = 0.02  # of filterpy's state relative to its values [1/sqrt(s)]
_MEMORY = 0.998  # forgetting factor of padasip: one second


def filterpy_kalman(world: World) -> Trace:
    """Estimate by filterpy's Kalman filter for (K_e, B_e) with a random walk."""
    from filterpy.kalman import KalmanFilter

    variance = _noise_variance(world)
    kalman = KalmanFilter(dim_x=2, dim_z=1)
    kalman.x, kalman.P = _START[:, None].copy(), np.diag(_START_STD**2)

    def update(y: float, phi: Array) -> None:
        walk = _WALK * np.maximum(np.abs(kalman.x[:, 0]), _START / 10.0)
        kalman.predict(Q=np.diag(walk**2 / RATE))
        kalman.update(y, R=variance, H=phi[None, :])

    return _traced(world, update, lambda: (kalman.x[:, 0], np.diag(kalman.P)))


def padasip_rls(world: World) -> Trace:
    """Estimate by padasip's recursive least squares with forgetting."""
    try:
        from padasip.filters import FilterRLS
    except ImportError as error:
        raise MissingPackageError.of('padasip', 'a peer of the estimators study') from error

    variance = _noise_variance(world)
    rls: Any = FilterRLS(2, mu=_MEMORY, eps=1.0 / _START_STD[0]**2, w=_START.tolist())

    def update(y: float, phi: Array) -> None:
        rls.adapt(y, phi)

    return _traced(world, update, lambda: (rls.w, variance * np.diag(rls.R)))


PEERS: dict[str, Callable[[World], Trace]] = {
    'filterpy Kalman, bare': filterpy_kalman,
    'padasip RLS, bare': padasip_rls,
}


def _noise_variance(world: World) -> float:
    free = world.t < 0.9 * world.contacts[0][0]
    forces = np.array([sample.force for sample in world.samples])
    return float(np.var(forces[free]))


def _rows(world: World) -> Iterator[tuple[float, float, Array]]:
    """Yield pressing force and (delta, v); v from differences where it is not measured."""
    last = world.samples[0]
    for now in world.samples:
        v = now.velocity
        if v != v:
            dt = (now.stamp_ns - last.stamp_ns) * 1e-9
            v = (now.position - last.position) / dt if dt > 0.0 else 0.0
        last = now
        yield -now.force, now.position, np.array([now.position, v])


def _traced(
    world: World, update: Callable[[float, Array], None],
    state: Callable[[], tuple[Array, Array]],
) -> Trace:
    touch = _TOUCH * np.sqrt(_noise_variance(world))
    values = []
    for pressing, position, phi in _rows(world):
        if pressing > touch and position > 0.0:
            update(pressing, phi)
        theta, variances = state()
        values.append((*theta, *np.sqrt(np.maximum(variances, 0.0))))
    columns = np.array(values).T
    return columns[0], columns[1], columns[2], columns[3]
