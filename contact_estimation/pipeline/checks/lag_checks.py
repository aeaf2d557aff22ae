# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Skew between the stamps of wrench and joint states.

A lag tau of the force turns K x + B v into K x(t - tau) + B v(t - tau), to first order a damping
B - K tau. A line of force over position and rate is fitted with the motion shifted by many lags;
the lag with the least residual is the skew, where no other physics explains the residual as well.
Noise of position and rate would shrink K and B, which looks like a lag: its share of the moments
is subtracted (Fuller, Measurement Error Models, 1987, section 1.2).
"""

from math import log
from typing import Any, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .check import Array, BLOCKS, Check, rate_of, white_noise_of, Window
from ...physics.numeric import SIGN_VELOCITY

_SIGNIFICANT = 40.0  # likelihood ratio
_LEFT = 3.0  # variance that a lag leaves, over the noise's: 1.3 is seen, beside friction 4 or more
_LEAST_S = 0.003  # a shorter lag is that of an ordinary sensor, and part of timing_std
_DEVIATIONS = 3.0  # of timing_std
_OF_PERIOD = 0.5  # of the joint states
_OTHER_PHYSICS = 20.0  # likelihood ratio over the best other explanation
_EXCITED = 8.0  # power of the motion over that of its noise

_LONGEST_S = 0.1
_COARSE = np.linspace(-0.1, 0.1, 21)
_COARSE[10] = 0.0
_NEAREST = _COARSE[9:12]
_FINE = np.linspace(-0.01, 0.01, 21)
_GAP = 1.5  # times the usual duration of a mean: longer ones miss samples
_LEAST_CONTACT = 100  # samples
_LEAST_MEANS = 20
_WHITE = 1.05  # variance of the residual over the white noise's: above, a lag may be in it
_NEIGHBOUR = 20.0  # likelihood ratio of a lag of 10 ms over none, from which one is searched too
_NO_LAG_S = 5e-4  # half of the finest step


class StampSkew(Check):
    """The stamps of wrench and joint states are of one clock and of the same instants."""

    name = 'stamp_skew'
    message = ('the stamps of the wrench are 10 ms late against the joint states; a lag acts as a '
               'damping of -K tau; set synchronisation.offset to +0.01')
    cause = 'The drivers stamp on arrival, or their clocks differ.'
    remedy = ('Set `synchronisation.offset` to the value given (it is added to the stamps of the '
              'joint states), or synchronise the clocks.')
    invalidates = True
    confirmations = 2
    stages = (lambda seen: _noise(seen), lambda seen: _averaged(seen), lambda seen: _nearest(seen))

    def judge(self, seen: Window) -> str | None:
        """
        Search the lag in the last seconds of contact.

        Clocks do not part for one event of a contact, such as a release: after a contact has shown
        no lag, windows that share no sample must show one.
        """
        skew = _skew_of(seen)
        if skew is None:
            return None
        # A shorter lag is that of an ordinary sensor, or of sparse joint states as interpolated.
        sparse = _OF_PERIOD / seen.joint_rate if seen.joint_rate > 0.0 else 0.0  # NaN: not yet
        limit = max(_LEAST_S, _DEVIATIONS * seen.parameters.synchronisation.timing_std, sparse)
        lag = skew.seconds
        if abs(lag) <= limit and skew.sharpness > _SIGNIFICANT:
            seen.memory['more_windows'] = BLOCKS
            return ''
        # A lag that many others would replace is none: it takes the place of what is not modelled.
        if not (abs(lag) > limit and min(skew.gain, skew.sharpness) > _SIGNIFICANT
                and skew.left < _LEFT and skew.over_physics > _OTHER_PHYSICS):
            return None
        seen.memory['more_windows'] = more = seen.memory.get('more_windows', 1) - 1
        if more > 0:
            return None
        return (f'the stamps of the wrench are {1e3 * abs(lag):.2g} ms '
                f'{"late" if lag > 0.0 else "early"} against the joint states; a lag acts as a '
                'damping of -K tau; set synchronisation.offset to '
                f'{seen.parameters.synchronisation.offset + lag:+.3f}')


class _Skew(NamedTuple):
    """The lag at which the force fits the motion best."""

    seconds: float  # positive if the wrench comes late
    sharpness: float  # likelihood ratio over lags of 10 ms more and less
    gain: float = 0.0  # over no lag, N log(r_0 / r), chi-squared of one without a lag
    over_physics: float = 0.0  # over the best other explanation
    left: float = 0.0  # variance that it leaves, over that of the noise


class _Means(NamedTuple):
    """Means over the same short times, so that they obey the same equation."""

    y: Array  # (M,) pressing force less the inertia of a known mass, in contact [N]
    t: Array  # (M,) no two share a sample [s]
    acceleration: Array  # (M,) [m/s^2]
    motion_t: Array  # (N,) around every sample [s]
    motion: NDArray[np.complex128]  # (N,) position and rate, as parts for a single search
    variances: Array  # (3,) of the noise of position, rate and acceleration
    white: float  # variance of the white noise of y [N^2]
    floor: float  # of all of its noise [N^2]

    @property
    def least(self) -> float:
        """Sum of squares that the white noise of y leaves beside any lag, less two deviations."""
        count = len(self.y)
        return max(self.white * max(count - 2.0 * (2.0 * count)**0.5, 0.1 * count), 1e-300)


def _skew_of(seen: Window) -> _Skew | None:
    """Estimate the lag of the force; None where contact or motion are too little."""
    means = _averaged(seen)
    if means is None:
        return None
    count = len(means.y)
    before, none, after = _nearest(seen, means)
    if not none < np.inf:
        return None
    x, v = (np.interp(means.t, means.motion_t, part)
            for part in (means.motion.real, means.motion.imag))
    theta, _ = _solve(means, [x, v], means.variances[:2])
    # Beside any lag and any physics: what noise of position and rate leaves.
    common = count * float(theta**2 @ means.variances[:2])

    def ratio(worse: float, better: float) -> float:
        sizes = (min(max(left + common, 1e-300), 1e300) for left in (worse, better))
        return count * log(next(sizes)) - count * log(next(sizes))

    sharpness = ratio(min(before, after), none)
    best, near = 0.0, np.array([none])
    if none > _WHITE * means.white * count or sharpness < -_NEIGHBOUR:
        best, near = _searched(means)
    if abs(best) < _NO_LAG_S:
        return _Skew(0.0, sharpness)
    least = max(float(near.min()), means.least)
    return _Skew(
        best, ratio(float(near[[0, -1]].min()), least), ratio(none, least),
        ratio(_residual_with_physics(means, x, v), least), least / (count * means.floor))


def _noise(seen: Window) -> tuple[float, ...]:
    """Find the noise of all signals, which the evidence keeps."""
    return seen.noise, seen.position_noise, seen.rate_noise


def _averaged(seen: Window) -> _Means | None:
    """Return the means of contact, found once; None without contact or motion."""
    instant, means = seen.memory.get('means', (None, None))
    if instant != seen.end_s:
        touched = seen.contact.any() and seen.bursts is None
        means = _means(seen) if touched else None
        seen.memory['means'] = seen.end_s, means
    return means  # type: ignore[no-any-return]


def _nearest(seen: Window, means: _Means | None = None) -> Sequence[float]:
    """Return what no lag and the nearest ones leave, found once; nothing without means."""
    means = means or _averaged(seen)
    instant, left = seen.memory.get('nearest', (None, []))
    if means is not None and instant != seen.end_s:
        left = _residuals(means, _NEAREST).tolist()
        seen.memory['nearest'] = seen.end_s, left
    return left  # type: ignore[no-any-return]


def _means(seen: Window) -> _Means | None:
    """Average force, motion and acceleration over the same short times; None without motion."""
    size = seen.mean_size
    if len(seen.t) < _LEAST_MEANS * size:
        return None
    moving = [_moving_mean(values, size) for values in (seen.t, seen.x, seen.rate)]
    starts = np.arange(0, len(seen.t) - size + 1, size)  # no sample twice: independent noise
    acceleration = rate_of(seen.rate, seen.t)
    y = -seen.force - _known_mass(seen) * acceleration
    # In contact by the force alone: the location of the wall may be wrong.
    pressed = seen.contact & (seen.force < -4.0 * seen.noise)
    t = moving[0][starts]
    duration = seen.t[starts + size - 1] - seen.t[starts]
    usable = ((duration <= _GAP * (size - 1) * seen.period) & _of_blocks(pressed, size).all(1)
              & (t > seen.t[0] + _LONGEST_S) & (t < seen.t[-1] - _LONGEST_S))
    if np.count_nonzero(usable) < max(_LEAST_MEANS, _LEAST_CONTACT / size):
        return None
    v = moving[2][starts][usable]
    if not float(np.var(v)) > (1.0 + _EXCITED) * seen.rate_noise**2:
        return None
    independent = max(1.0, size / seen.stride)
    variances = np.array([seen.position_noise**2 / independent, seen.rate_noise**2,
                          2.0 * (seen.rate_noise / (size * seen.period))**2])
    white = white_noise_of(seen.force)**2 / size
    return _Means(
        _of_blocks(y, size).mean(1)[usable], t[usable],
        _of_blocks(acceleration, size).mean(1)[usable], moving[0], moving[1] + 1j * moving[2],
        variances, white, max(seen.state.noise_std, 1e-9)**2 / size)


def _known_mass(seen: Window) -> float:
    """Return the mass of the tool beyond the sensor, whose inertia is compensated [kg]."""
    mass = float(seen.parameters.physics.tool_inertia.mass)
    return mass if mass == mass else 0.0


def _moving_mean(values: Array, size: int) -> Array:
    """Return the mean of every `size` successive values, of shape (N - size + 1,)."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((sums[size:] - sums[:-size]) / size)


def _of_blocks(values: NDArray[Any], size: int) -> NDArray[Any]:
    """Return successive values in rows of `size`, without the rest."""
    return values[:len(values) // size * size].reshape(-1, size)


def _searched(means: _Means) -> tuple[float, Array]:
    """Return the best lag [s], and what the lags up to 10 ms from the best coarse one leave."""
    fine = _COARSE[np.argmin(_residuals(means, _COARSE))] + _FINE  # of 4 ms: around none
    near = _residuals(means, fine)
    return float(fine[np.argmin(near)]), near


def _residuals(means: _Means, lags: Array) -> Array:
    """Return the sum of squares that K x + B v + c leaves at each lag, with B >= 0."""
    y, count = means.y, len(means.y)
    moved = np.interp((means.t - lags[:, None]).ravel(), means.motion_t, means.motion)
    x, v = moved.real.reshape(len(lags), -1), moved.imag.reshape(len(lags), -1)  # (lags, N)
    # Without their means no constant is needed.
    x, v, y = x - x.mean(1)[:, None], v - v.mean(1)[:, None], y - y.mean()
    xx, xv, vv = (np.einsum('ln,ln->l', a, b) for a, b in ((x, x), (x, v), (v, v)))
    xy, vy, yy = x @ y, v @ y, float(y @ y)
    noise_x, noise_v = count * means.variances[:2]
    excited = (xx > (1.0 + _EXCITED) * noise_x) & (vv > (1.0 + _EXCITED) * noise_v)
    xx, vv = np.maximum(xx - noise_x, 1e-300), np.maximum(vv - noise_v, 1e-300)
    rest_v, rest_y = vv - xv * xv / xx, vy - xv * xy / xx
    damped = (rest_y > 0.0) & (rest_v > _EXCITED * noise_v)
    left = yy - xy * xy / xx - np.where(damped, rest_y**2 / np.where(damped, rest_v, 1.0), 0.0)
    return np.where(excited, np.maximum(left, 1e-3 * means.least), np.inf)


def _residual_with_physics(means: _Means, x: Array, v: Array) -> float:
    """Return the least sum of squares with one more term of other physics and no lag."""
    depth = x - x.min()
    moves = np.square(v) > _EXCITED * means.variances[1]  # else its sign is that of the noise
    way = np.where(moves, np.tanh(v / SIGN_VELOCITY), 0.0)
    changes = float(np.square(np.gradient(way)).sum())  # when within a mean is not known
    deep = float(np.mean(depth**2))
    noise = means.variances[2], 0.0, 4.0 * deep * means.variances[0], deep * means.variances[1]
    fits = [_solve(means, [x, v, term], np.append(means.variances[:2], own)) for term, own in zip(
        (means.acceleration, way, depth**2, depth * v), noise)]
    (mass, heavy), (F_c, rubbing), *others = ((theta[2], left) for theta, left in fits)
    return min(heavy if mass >= 0.0 else np.inf,
               max(rubbing - F_c**2 * changes, means.least), *(left for _, left in others))


def _solve(means: _Means, columns: list[Array], variances: Array) -> tuple[Array, float]:
    """Fit y by columns of any scale with noise, and a constant; return theta and what is left."""
    y = means.y - means.y.mean()
    table = np.stack(columns, 1)
    table = table - table.mean(0)
    scale = np.sqrt(np.mean(table**2, 0)) + 1e-150
    table, noise = table / scale, np.minimum(variances / scale**2, 0.9)
    square = table.T @ table + len(y) * (1e-12 * np.eye(len(columns)) - np.diag(noise))
    try:
        theta = np.linalg.solve(square, table.T @ y)
    except np.linalg.LinAlgError:
        theta = np.zeros(len(columns))
    left = float(y @ y - theta @ (table.T @ y))
    return theta / scale, max(left, means.least)
