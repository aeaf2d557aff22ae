# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a check is, the evidence from which it decides, and robust statistics of it."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil, inf, sqrt
from typing import Any, Callable, ClassVar, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from ..parameters import EstimationParameters
from ...estimators.multiple_model import NEITHER
from ...signals.stream_faults import Bursts, bursts_of


Array = NDArray[np.float64]

LOADED = 4.0  # standard deviations
_BELOW_95_PERCENT = 0.759  # mean of the lower 95 % of the squares of a normal variable


def loaded_correlation(x: Array, force: Array, noise: float) -> float:
    """Correlate force and position where there is a force: free flight before would hide it."""
    if not len(force):
        return 0.0
    away = np.abs(force - np.mean(force[:max(1, len(force) // 10)]))
    loaded = away > LOADED * noise
    if not loaded.any():
        return 0.0
    near = (x >= x[loaded].min()) & (x <= x[loaded].max())
    return correlation(x[near], force[near])


def median_of(values: Array) -> float:
    """Return the middle value, the upper one of two; several times as fast as np.median."""
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])


def extremes(values: Array) -> tuple[float, float]:
    """Return the least and the greatest value without the outermost 2 %."""
    out = int(0.02 * len(values))
    ordered = np.sort(values)  # several times as fast as np.quantile
    return float(ordered[out]), float(ordered[len(values) - 1 - out])


def spread_of(values: Array) -> float:
    """Return the range of values without their outermost 2 %."""
    low, high = extremes(values)
    return high - low


def correlation(a: Array, b: Array) -> float:
    """Return the correlation of two signals; 0 where one is constant."""
    a, b = (_unit(one - np.mean(one)) for one in (a, b))
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else 0.0


def _unit(values: Array) -> Array:
    """Scale to at most 1, so that squares are finite and not all zero."""
    most = float(np.max(np.abs(values), initial=0.0))
    return values / most if most > 0.0 else values


def white_noise_of(values: Array, stride: int = 1) -> float:
    """
    Return the deviation of white noise by second differences, in which motion hardly shows.

    The largest are left out: an impact is no noise. Infinite where there are too few values.
    """
    if len(values) < 2 * stride + 1:
        return inf
    middle = values[stride:-stride]
    squares = np.square(values[2 * stride:] - 2.0 * middle + values[:-2 * stride])
    most = max(1, int(0.95 * len(squares)))
    lower = np.partition(squares, most - 1)[:most]
    return sqrt(float(np.mean(lower)) / (6.0 * _BELOW_95_PERCENT))


BLOCKS = 4
"""Judgements, half a second apart, whose evidence shares samples."""

MEAN_S = 0.01
"""Time over which signals are averaged [s]."""

_MEDIAN = 0.6745  # of the size of a normal variable of variance 1
_STAMP_S = 1e-9  # resolution of a stamp
_LATE = 3.0  # variance of the difference of two rates, over that of their noises: 1 to 2
_NOTHING = np.zeros(0)


def millimetres(metres: float) -> str:
    """Return a length for a text, such as 9.9 mm, 400 mm or 2100 mm."""
    length = 1e3 * metres
    return f'{length:.0f} mm' if abs(length) >= 100.0 else f'{length:.3g} mm'


class Warned(NamedTuple):
    """An active warning."""

    name: str  # of the check
    axis: str  # 'x', 'y' or 'z'; '' where the warning concerns all
    text: str  # what is wrong and what to do
    invalidates: bool  # whether estimates are withheld because of it


class Forces(NamedTuple):
    """A component of the wrench that no axis estimates [N], and x of the contact axis then [m]."""

    axis: str
    force: Array
    x: Array


class AxisState(NamedTuple):
    """What checks read of a pipeline, which has gone on before the last of them judges."""

    location: float  # of the surface [m]; NaN before it is known
    margin: float  # how far from its location the surface may be [m]
    # shift, surface_std: where it was found less where it is configured, with deviation [m]
    shift: float
    surface_std: float
    surface_text: str  # where it is, if it is not where it is configured
    is_shown: bool  # whether contact has shown the surface
    contact: bool
    neither: bool  # whether the force is neither that of free flight nor that of the wall
    valid: bool  # whether the stiffness is known
    bias: float  # force that a tare subtracts [N]
    noise_std: float  # of the force in free flight [N]
    period_s: float  # of the samples, 0 before it is known [s]
    has_rows: bool  # whether an estimator runs that is built for a sample rate
    misfit: str  # why no law fits

    @classmethod
    def of(cls, pipeline: Any) -> 'AxisState':
        """Return the state now."""
        surface, posterior = pipeline.surface, pipeline.posterior
        return cls(
            surface.location, surface.margin, surface.shift, surface.std, surface.text,
            surface.is_shown, pipeline.contact, posterior.contact.state == NEITHER,
            posterior.known.valid, pipeline.bias, posterior.contact.measured_std,
            posterior.period_s, pipeline.estimator is not None, pipeline.model_fit.now.text)


@dataclass(frozen=True)
class Window:
    """The last seconds of one axis."""

    axis: str  # its name
    parameters: EstimationParameters  # all parameters
    state: AxisState  # at the end of the samples
    # t, x, v, force (N,): time [s], position [m], rate [m/s] (NaN where not measured) and F_e less
    # the bias [N], that of a tare and that of `physics.force_bias`
    t: Array
    x: Array
    v: Array
    force: Array
    contact: NDArray[np.bool_]  # (N,) whether contact was detected
    others: tuple[Forces, ...] = ()  # components of the wrench that are not estimated
    joint_rate: float = float('nan')  # rate of the joint states [Hz]; NaN while unknown
    travel: float = 0.0  # range of all positions since the start [m]
    # (M,) stamps of all wrenches, also of those that became no sample [s]; empty where not known
    wrench_t: Array = field(default_factory=lambda: _NOTHING)
    start_s: float = 0.0  # stamp at t = 0 [s]
    # joints, limits: positions of the joints of an arm; by place, name and limits of those that
    # turn [rad]
    joints: Sequence[float] = ()
    limits: Mapping[int, tuple[str, float, float]] = field(default_factory=dict)
    loads: Sequence[Array] = ()  # as of `Loads.kept`
    # what a check has found, until the checks are reset
    memory: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of_state(cls, axis: str, parameters: EstimationParameters, state: AxisState) -> 'Window':
        """Return evidence without samples, for checks of the state of a pipeline."""
        return cls(axis, parameters, state, _NOTHING, _NOTHING, _NOTHING, _NOTHING,
                   np.zeros(0, dtype=np.bool_))

    # -- the pipeline -----------------------------------------------------------------------

    @property
    def location(self) -> float:
        """Return the location of the surface [m]; NaN before it is known."""
        return self.state.location

    @property
    def bias(self) -> float:
        """Return the force that a tare and the parameters subtract [N]."""
        return bias_of(self.axis, self.parameters, self.state)

    # -- the samples ------------------------------------------------------------------------

    @property
    def end_s(self) -> float:
        """Return the stamp of the last sample [s]."""
        return self.start_s + (float(self.t[-1]) if len(self.t) else 0.0)

    @property
    def is_arm(self) -> bool:
        """Return whether x and the force follow from the joints and the wrench of an arm."""
        return bool(self.parameters.kinematics.tip)

    @property
    def may_be_weight(self) -> bool:
        """Return whether the weight of a tool is in the force, which turns with an arm."""
        return self.is_arm and not self.parameters.tool.mass

    @property
    def free(self) -> NDArray[np.bool_]:
        """Return the samples that touch nothing, as far as the location of the wall is known."""
        return np.asarray(~self.contact & ~(self.x > self.location))

    @property
    def configured_noise(self) -> float:
        """Return the configured standard deviation of the force [N]."""
        return self.parameters.contact.force_noise

    @cached_property
    def noise(self) -> float:
        """
        Return the white noise of the force by its differences, at least as configured [N].

        What the detector learns in free flight may be a contact that it does not recognise.
        """
        if len(self.force) < 2:
            return self.configured_noise
        white = median_of(np.abs(self.force[1:] - self.force[:-1])) / (_MEDIAN * 2.0**0.5)
        return max(self.configured_noise, white)

    @cached_property
    def period(self) -> float:
        """Return the usual time between samples, at least the resolution of stamps [s]."""
        steps = self.t[1:] - self.t[:-1]
        return max(median_of(steps) if len(steps) else 0.0, _STAMP_S)

    @cached_property
    def stride(self) -> int:
        """Return the samples from one joint state to the next, between which x is a line."""
        apart = 0.99 / (self.joint_rate * self.period) if self.joint_rate > 0.0 else 1.0
        return max(1, ceil(min(apart, len(self.t) + 1.0)))

    @cached_property
    def position_noise(self) -> float:
        """Return the white noise of the position [m]; infinite where there are too few samples."""
        return white_noise_of(self.x, self.stride)

    @cached_property
    def velocity_noise(self) -> float:
        """Return the white noise of the measured rate [m/s]; infinite where it is not measured."""
        return white_noise_of(self.v, self.stride) if np.isfinite(self.v).all() else inf

    @property
    def mean_size(self) -> int:
        """Return the samples over which signals are averaged."""
        return max(1, round(min(MEAN_S / self.period, float(len(self.t)))))

    @cached_property
    def _rates(self) -> tuple[Array, float]:
        """Return the rate of x whose mean is known better, and the noise of that mean."""
        independent, size = max(1.0, self.mean_size / self.stride), self.mean_size
        measured = self.velocity_noise / independent**0.5
        by_steps = self.position_noise / (independent * self.stride * self.period)
        rate = rate_of(self.x, self.t)
        if measured <= by_steps < inf:
            # A rate that drivers filter is late: means of both differ by more than noise.
            off = (self.v - rate)[:len(rate) // size * size].reshape(-1, size).mean(axis=1)
            if float(np.mean(off * off)) < _LATE * by_steps**2:
                return self.v, measured
        return rate, by_steps

    @property
    def rate(self) -> Array:
        """Return the rate of x, measured or by differences [m/s]."""
        return self._rates[0]

    @property
    def rate_noise(self) -> float:
        """Return the standard deviation of its mean over `mean_size` samples [m/s]."""
        return self._rates[1]

    @cached_property
    def spread(self) -> float:
        """Return the range of the force without its extremes [N]."""
        return spread_of(self.force) if len(self.force) else 0.0

    @cached_property
    def slope_sign(self) -> float:
        """Return the correlation of force and position where there is a force."""
        return loaded_correlation(self.x, self.force, self.noise)

    @cached_property
    def bursts(self) -> Bursts | None:
        """Return stamps in bursts: no rate and no lag has a meaning beside them."""
        return bursts_of(self.wrench_t if len(self.wrench_t) else self.t)


def bias_of(axis: str, parameters: EstimationParameters, state: AxisState) -> float:
    """Return the force that a tare and `physics.force_bias` subtract [N]."""
    declared = float(parameters.of_axis(axis).physics.force_bias.bias)
    return state.bias + (declared if declared == declared else 0.0)


def rate_of(values: Array, t: Array) -> Array:
    """Return central differences, finite also between samples of one stamp."""
    if len(t) < 2:
        return np.zeros(len(t))
    after, before = np.append(t[1:], t[-1]), np.append(t[:1], t[:-1])
    later, earlier = np.append(values[1:], values[-1]), np.append(values[:1], values[:-1])
    return np.asarray((later - earlier) / np.maximum(after - before, _STAMP_S))


class Check(ABC):
    """
    One thing that is commonly wrong with the inputs.

    Stateless: all memory is in the evidence.
    """

    name: ClassVar[str]  # in diagnostics, summaries and the documentation
    # message, cause, remedy: for the table of warnings: the text with typical numbers, what it
    # comes from, what to do
    message: ClassVar[str]
    cause: ClassVar[str]
    remedy: ClassVar[str]
    # whether estimates are withheld while the warning is active
    invalidates: ClassVar[bool] = False
    # whether the state of the pipeline alone decides, at any time
    of_state: ClassVar[bool] = False
    # whether it judges the force along the normal, which has no meaning in foreign axes
    needs_axes: ClassVar[bool] = False
    confirmations: ClassVar[int] = 1  # judgements in a row that find it before it is reported
    # what takes long of a judgement, each done after a sample of its own, before `judge`; they
    # keep what they find in the evidence
    stages: ClassVar[tuple[Callable[[Window], object], ...]] = ()

    @abstractmethod
    def judge(self, seen: Window) -> str | None:
        """
        Return the text of the warning.

        Never raises, whatever the evidence.
        """
