# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The discrepancy: a force that no law of the library explains, a process correlated in time.

A real thing obeys no law to the noise of a good sensor. What a fitted model leaves is described by
a process of its own size and correlation time (Kennedy and O'Hagan 2001) instead of being taken
for white noise, of which every small part would be significant. Each channel has its own, but they
are compared as forces: a trifle that a precise position sensor shows does not count like a gross
error of the force. The model uncertainty is that of parameters which are known within a tolerance
only, and not to be named as physics.
"""

from dataclasses import replace
from math import exp, hypot, log, sqrt

import numpy as np
from scipy import sparse
from scipy.ndimage import median_filter
from scipy.optimize import minimize_scalar

from .constants import CONSTANTS
from .fitting import differentiate_by, Fit, jacobian_at, residual_function
from ..observe.channel import Channel, Discount, LEAST_VARIANCE, ROBUST, sum_blocks
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import residuals, response_to
from ..observe.shares import LITTLE
from ...physics.numeric import Array

UNCERTAINTIES = (
    ('impedance_mismatch', (1.0, 1.0, 1.002), False),
    ('command_delay', (3e-5,), True),
    ('force_delay', (3e-5,), True),
)
"""Effects at one standard deviation, and whether that is a time, which the pace multiplies: M_t is
known to 0.2 %, stamps to 0.03 ms."""

# Of the range of the force: most that a cable or a hose pulls, over the stroke, and dry friction
# that every robot has.
_CABLE, _FRICTION = 0.05, 0.003

_MOST_STEPS = 200
_STANDS_OUT = 10.0  # times the median: else it is not a step
_AROUND = 5  # samples among which it stands out
_FADED = 1e-5  # of a response: from where on it is none
_UNIFORM = 1.0 / sqrt(12.0)  # standard deviation of an instant within a sample
_FAR = 4.0  # times the noise: power of the residuals
_MEAN_S, _BLOCK_S = 0.04, 0.1  # tells ripple, and averages it
_WHITE = 0.3  # power of such a mean, in that of residuals that are all of one sign


def discounted(recording: PreparedRecording, model: Model) -> PreparedRecording:
    """Return a recording whose residuals discount the model uncertainty."""
    # Beside `UNCERTAINTIES` these are a cable that pulls at the tool, dry friction of the robot,
    # the instant, within a sample, at which the reference steps, and whether the robot holds the
    # desired acceleration between samples or interpolates it.
    recording = replace(recording, discount=None)
    if recording.driven_by_force(model):
        return recording
    here = residuals(recording, model, robust=False)
    o = recording.observed
    robot = o.reference is not None
    columns = []
    for name, values, time in UNCERTAINTIES:
        if name not in model.effects and (robot or name == 'force_delay'):
            scaled = tuple(o.pace * value if time else value for value in values)
            varied = model.with_effect(name, scaled)
            columns.append(residuals(recording, varied, robust=False) - here)
    steps = []
    if robot:
        columns.append(_held_acceleration(recording, model))
        steps.append(_steps_of_reference(recording, model))
    if not columns:
        return recording
    uncertain = sparse.hstack((sparse.csc_array(np.array(columns).T), *steps), 'csc')
    nuisances = list[tuple[slice, Array, float]]()
    # Without the motion of a robot the force alone tells the wall, of which a cable may be a part.
    if robot and model.nominal.environment.unilateral and not recording.simulated:
        pull = _CABLE * o.force_range / float(np.ptp(o.x)) * (o.x - o.x[0])
        force = slice(recording.block_count)
        nuisances.append((force, recording.force.average(pull), -1.0))
        if 'robot_friction' not in model.effects:
            rubs = model.with_effect('robot_friction', (_FRICTION * o.force_range,))
            slowed = here - residuals(recording, rubs, robust=False)
            nuisances.append((slice(force.stop, None), slowed[force.stop:], 0.0))
    return replace(recording, discount=Discount.of(uncertain, nuisances))


def _response(recording: PreparedRecording, push: Array, model: Model) -> Array:
    innovations = response_to(recording, push, model)
    assert innovations is not None
    return innovations


def _held_acceleration(recording: PreparedRecording, model: Model) -> Array:
    """Return the residuals if the robot holds the desired acceleration over each sample."""
    reference, mass = recording.observed.reference, model.laws().robot.mass
    assert reference is not None
    innovations = _response(recording, -0.5 * mass * np.gradient(reference[2]), model)
    return np.pad(recording.motion.average(innovations), (recording.block_count, 0))


def _steps_of_reference(recording: PreparedRecording, model: Model) -> sparse.csc_array:
    """Return the residuals if a step of the reference comes a fraction of a sample off."""
    o, robot = recording.observed, model.laws().robot
    assert o.reference is not None
    x_r, v_r, a_r = o.reference[:3]
    pushes = np.diff(robot.mass * a_r + robot.damping * v_r + robot.stiffness * x_r)
    jumps = pushes - median_filter(pushes, _AROUND)
    size = np.abs(jumps) * o.h  # impulse of a whole sample [N s]
    least = max(LITTLE * recording.motion.noise * o.observer_cutoff * robot.mass,
                _STANDS_OUT * float(np.median(size)))
    steps = np.argsort(-size)[:_MOST_STEPS]
    pulse = np.zeros(len(o.t))
    pulse[:2] = _UNIFORM / sqrt(2.0)  # both courses of the step within its sample
    response = _response(recording, pulse, model)
    variance = float(np.sum(recording.motion.average(response) ** 2)) * jumps**2
    steps = steps[(size[steps] > least) & (variance[steps] > LITTLE * LEAST_VARIANCE)]
    lasting = np.flatnonzero(np.abs(response) > _FADED * np.ptp(response))
    response = response[:np.max(lasting, initial=-1) + 1]
    rows = steps[:, np.newaxis] + np.arange(len(response))
    k, _ = there = np.nonzero(rows < len(o.t))
    moved = sparse.csc_array(
        (np.outer(jumps[steps], response)[there], (rows[there], k)), (len(o.t), len(steps)))
    before = sparse.csc_array((recording.block_count, len(steps)))
    return sparse.vstack((before, recording.motion.averaging @ moved), 'csc')


def without_ripple(recording: PreparedRecording, model: Model) -> PreparedRecording:
    """Average the innovations of a driven wall over longer blocks if its positions ripple."""
    one, size = recording, round(_MEAN_S * recording.observed.pace / recording.block_s)
    if not one.driven_by_force(model) or size < 2:
        return one
    left = residuals(one, model, robust=False)
    full = sum_blocks(one.motion.filled.astype(float), size) == size
    power = float(np.mean(sum_blocks(left**2, size)[full])) / size if full.any() else 0.0
    if power < _FAR or float(np.mean(sum_blocks(left, size)[full] ** 2)) > (
            _WHITE * power * size**2):
        return one
    return one.in_blocks(round(_BLOCK_S * one.observed.pace / one.observed.h), model)


CHANNELS = 2
"""Force, which contact and sensor decide, and motion, which the robot does; a wall driven by a
force has its motion only, which then comes first."""

_REWEIGHTED = 5  # times; the discrepancy and its weights depend on each other
_MOST_LAGS = 200
_WIDENED = 0.75  # with 1 the innovations would be little but the noise of the position
_MATCHED = 0.05  # relative, of the size of an unknown force
_CLUSTER_S = 0.5


def with_discrepancy(recording: PreparedRecording, model: Model) -> PreparedRecording:
    """Return the recording with the discrepancy that a fitted model leaves."""
    # As if the laws of the library were exact.
    plain = replace(recording, force_discrepancy=0.0, motion_discrepancy=0.0, discount=None)
    unknown = 0.0
    if plain.driven_by_force(model):
        plain, unknown = _widened(plain, model)
    left = plain.split(residuals(plain, model, robust=False))
    stds = [std_beyond_noise(part, channel) for part, channel in zip(left, plain.channels(model))]
    if plain.driven_by_force(model):
        return replace(plain, motion_discrepancy=stds[0], force_discrepancy=unknown)
    return replace(plain, force_discrepancy=stds[0], motion_discrepancy=sum(stds[1:]))


def _widened(plain: PreparedRecording, model: Model) -> tuple[PreparedRecording, float]:
    """Let the filter expect forces nearly as large as the model leaves; return their size [N]."""
    plain = plain.widened(1.0, model)
    size, unknown = _rms(plain, model), _unknown_force(plain, model)
    if unknown < least_material(plain):
        return plain, unknown  # the slow forces, which decide a free run, still count most
    return plain.widened(max(1.0, size**_WIDENED), model), unknown


def _rms(recording: PreparedRecording, model: Model) -> float:
    left = residuals(recording, model, robust=False)
    return float(np.sqrt(left @ left / recording.residual_count))


def _unknown_force(plain: PreparedRecording, model: Model) -> float:
    """Return the size of the unknown force that the innovations of a driven wall show [N]."""
    # Of all filters, the one that predicts best weighs force and position by the ratio of their
    # true noise, and its innovations tell the size of both (Ljung 1999, section 7.4). What the
    # position lacks, which no force explains, is so told from a force.
    def filtered(logarithm: float) -> tuple[float, float]:
        noisier = replace(plain, block=1, force_noise=plain.force_noise * exp(logarithm))
        noisier = noisier.widened(1.0, model)  # not averaged: only white innovations are least
        size = _rms(noisier, model)
        return size * noisier.motion_noise, size * noisier.force_noise

    most = log(max(plain.observed.force_range / plain.force_noise, 1.0))
    if not most:
        return 0.0
    best = minimize_scalar(
        lambda logarithm: log(filtered(logarithm)[0]), bounds=(0.0, most), method='bounded',
        options={'xatol': _MATCHED}).x
    total = filtered(float(best))[1]
    return max(total**2 - plain.force_noise**2, 0.0) ** 0.5


def material(recordings: Recordings, model: Model) -> set[int]:
    """Return in which channels a discrepancy is worth a name beside the force."""
    channels = set[int]()
    for recording in recordings:
        sizes = [recording.force_discrepancy]
        if recording.observed.reference is not None:
            sizes.append(force_of_motion(recording, model) * recording.motion_discrepancy)
        least = least_material(recording)
        channels |= {k for k, size in enumerate(sizes) if size >= least}
    return channels


def least_material(recording: PreparedRecording) -> float:
    """Return the least force that is worth a name: more than errors of its sensor."""
    return hypot(CONSTANTS.instrument * recording.observed.force_range, recording.sensor_error)


def force_of_motion(recording: PreparedRecording, model: Model) -> float:
    """Return the force that changes innovations by a metre [N/m]; see `forces`."""
    return model.laws().robot.mass * recording.observed.observer_cutoff**2


def weighed(recordings: Recordings, model: Model) -> Recordings:
    """Return recordings with the discrepancy and the discount of a fitted model."""
    return [discounted(with_discrepancy(one, model), model) for one in recordings]


def std_beyond_noise(left: Array, channel: Channel) -> float:
    """Estimate the standard deviation of block means beyond the noise, robust to outliers."""
    # Where the noise differs from block to block, those count most that tell most (DerSimonian and
    # Laird 1986).
    there = channel.filled
    if not there.any():
        return 0.0
    noise = channel.noise_of_means[there] ** 2
    squares = left[there] ** 2 * noise
    unknown = max(float(np.mean(squares - noise)), 0.0)
    squares = np.minimum(squares, ROBUST**2 * (noise + unknown))
    for _ in range(_REWEIGHTED):
        weights = (noise + unknown) ** -2.0
        unknown = max(float(weights @ (squares - noise) / weights.sum()), 0.0)
    return float(np.sqrt(unknown))


def correlation_time(left: Array) -> float:
    """Measure for how many neighbours residuals are correlated."""
    power, total = float(left @ left), 1.0
    if power == 0.0:
        return 1.0
    for lag in range(1, min(_MOST_LAGS, len(left) // 4)):
        correlation = float(left[lag:] @ left[:-lag]) / power
        if correlation < 0.05:
            break
        total += 2.0 * correlation
    return total


def standard_deviations(recordings: Recordings, found: Fit) -> Array:
    """Estimate standard deviations of fitted values, clustered in time (Liang and Zeger 1986)."""
    # Residuals may be correlated in any way within half a second and are independent across; the
    # result is never below that for residuals of the correlation time that each channel shows.
    model = found.model
    function = residual_function(recordings, model)
    values, size = model.coordinates, model.steps
    here = function(values)
    jacobian = jacobian_at(model, function, here)
    inverse = np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-13)
    told = differentiate_by(values, size, lambda these: _free_values(model.with_free(these)),
                            _free_values(model), most=model.ranges[1])
    span = max(1, round(_CLUSTER_S * recordings[0].observed.pace / recordings[0].block_s))
    scores = np.add.reduceat(jacobian * here[:, None], np.arange(0, len(here), span), axis=0)
    inverse = told @ inverse
    clustered = np.diag(inverse @ (scores.T @ scores) @ inverse.T)
    times = _correlation_times(recordings, model, here)
    correlated = np.diag(inverse @ (jacobian.T * times) @ jacobian @ inverse.T)
    correlated = correlated * max(1.0, float(np.mean(here**2)))
    std = np.full(len(model.values), np.nan)
    std[model.free] = np.sqrt(np.maximum(clustered, correlated))
    std[model.at_end] = np.nan
    return std


def _free_values(model: Model) -> Array:
    return np.array(model.values)[model.free]


def _correlation_times(recordings: Recordings, model: Model, stacked: Array) -> Array:
    """Return the correlation time of the channel of each residual [blocks], shape (R,)."""
    times, begin = np.ones(len(stacked)), 0
    for one in recordings:
        for _ in one.channels(model):
            here = slice(begin, begin + one.block_count)
            times[here] = correlation_time(stacked[here])
            begin = here.stop
    return times
