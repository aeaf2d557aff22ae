# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What `studies estimators` compares: all estimators, and filters of other packages."""

from __future__ import annotations

from functools import partial
from typing import Any, Callable

import numpy as np

from .online_row import Array, follow, messages, Trace
from .online_worlds import World
from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import MissingPackageError
from ..signals.synchronisation import SynchronisationParameters, Synchroniser

Update = Callable[[float, Array], tuple[Any, Any]]
"""From a pressing force [N] and (delta, v) to (K_hat, B_hat) and their variances."""

_TOUCH = 6.0  # standard deviations of the force noise above which the peers update
_START = np.array([3000.0, 50.0])
_START_STD = np.array([1e5, 1e4])
_WALK = 0.02  # of filterpy's state relative to its values [1/sqrt(s)]
_MEMORY = 0.998  # forgetting factor of padasip: one second at 500 Hz


def _filterpy(noise: float, rate: float) -> Update:
    """Prepare filterpy's Kalman filter for (K_e, B_e) with a random walk."""
    from filterpy.kalman import KalmanFilter

    kalman = KalmanFilter(dim_x=2, dim_z=1)
    kalman.x, kalman.P = _START[:, None].copy(), np.diag(_START_STD**2)

    def update(y: float, phi: Array) -> tuple[Any, Any]:
        walk = _WALK * np.maximum(np.abs(kalman.x[:, 0]), _START / 10.0)
        kalman.predict(Q=np.diag(walk**2 / rate))
        kalman.update(y, R=noise**2, H=phi[None, :])
        return kalman.x[:, 0], np.diag(kalman.P)

    return update


def _padasip(noise: float, rate: float) -> Update:
    """Prepare padasip's recursive least squares with forgetting."""
    try:
        from padasip.filters import FilterRLS
    except ImportError as error:
        raise MissingPackageError.of('padasip', 'a peer of the estimators study') from error
    rls: Any = FilterRLS(2, mu=_MEMORY, eps=1.0 / _START_STD[0]**2, w=_START.tolist())

    def update(y: float, phi: Array) -> tuple[Any, Any]:
        rls.adapt(y, phi)
        return rls.w, noise**2 * np.diag(rls.R)

    return update


def _bare(prepare: Callable[[float, float], Update], world: World) -> Trace:
    """Run a filter on paired samples, with x_e as told and the true noise, as manuals show it."""
    update = prepare(world.truth.sensor.noise, world.truth.sensor.rate)
    surface = world.parameters['environment.location']
    synchroniser = Synchroniser(SynchronisationParameters())
    times = dict(zip(world.wrenches.stamp_ns.tolist(), world.wrenches.t.tolist()))
    theta, variances, last, rows = _START, _START_STD**2, (0.0, surface), []
    for _, kind, stamp_ns, values in messages(world.wrenches, world.motions):
        add = synchroniser.add_wrench if kind else synchroniser.add_motion
        for (sample, *_) in add(stamp_ns, tuple(values)):
            t, x, v = times[sample.stamp_ns], sample.position, sample.velocity
            if v != v:  # not measured
                v = (x - last[1]) / (t - last[0]) if t > last[0] > 0.0 else 0.0
            last = t, x
            touching = -sample.force > _TOUCH * world.truth.sensor.noise and x > surface
            if touching:
                theta, variances = update(-sample.force, np.array([x - surface, v]))
            rows.append((t, *theta, *np.sqrt(np.maximum(variances, 0.0)), touching))
    t, K, B, K_std, B_std, contact = np.array(rows).T
    return Trace(t, K, B, K_std, B_std, np.full_like(t, surface), contact == 1.0, [], [], '')


CANDIDATES: dict[str, Callable[[World], Trace]] = {
    **{name: partial(follow, more={'estimator': name}) for name in ONLINE_ESTIMATORS},
    'indirect_adaptive, normalised': partial(follow, more={
        'estimator': 'indirect_adaptive', 'tuning.indirect_adaptive.normalised': True}),
    'filterpy Kalman, bare': partial(_bare, _filterpy),
    'padasip RLS, bare': partial(_bare, _padasip),
}
"""By name; each makes a trace of a world."""
