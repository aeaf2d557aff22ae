# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rows of the on-line study: what worlds are drawn from, and how right the session is."""

from math import isfinite, nan
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .online_worlds import Sensor, Stream, Wall, World
from .paths import Array, Piece, ramp, sines, start
from ..estimators import MULTIPLE_MODEL
from ..estimators.estimate import EstimateStatus
from ..estimators.multiple_model import LAWS
from ..parameters import changed
from ..physics.prior import log_uniform
from ..pipeline.axes import Result
from ..pipeline.parameters import EstimationParameters
from ..pipeline.session import ContactSession

_LOOK_S = 0.1  # between looks at warnings and laws
_TOUCHED_S = 0.3  # after a touch, from which there should be estimates
_SETTLED_S = 1.0  # after a touch, from which bands are checked
_BEFORE_END_S = 0.05  # of a contact: the wall is being left
_EVERY_S = 0.1  # between instants at which bands are checked
_FAMILIES = {'hunt_crossley_1': 'hunt_crossley', 'hunt_crossley_1.5': 'hunt_crossley',
             'hunt_crossley_2': 'hunt_crossley', 'moving_wall': 'moving',
             'creeping_wall': 'moving',
             'kelvin_voigt': 'spring_damper'}  # others are families of their own
BAND = 2.0
"""Standard deviations in which the truth should be."""


class Trace(NamedTuple):
    """Estimates of a world."""

    t: Array  # (N,) when the wrenches of the samples were measured [s]
    # K, B, K_std, B_std (N,): estimates and their deviations, NaN where withheld
    K: Array
    B: Array
    K_std: Array
    B_std: Array
    location: Array  # (N,) estimated x_e [m]
    contact: NDArray[np.bool_]  # (N,) whether the status is not free
    warnings: list[tuple[float, str, str]]  # when looked at [s], name and text
    # when looked at [s], and the probability of each law
    laws: list[tuple[float, Mapping[str, float]]]
    error: str  # what was raised, after which nothing follows; '' for nothing


class Score(NamedTuple):
    """One world."""

    group: str  # of the world
    # K_error, B_error: relative; NaN without an estimate
    K_error: float
    B_error: float
    # K_held, B_held: at how many instants the truth is in the band, of how many at which there is
    # one
    K_held: tuple[int, int]
    B_held: tuple[int, int]
    more: Mapping[str, Any] = {}  # whatever else a row measures, by name and unit


def follow(world: World, estimator: str) -> Trace:
    """Feed a session as node and replay do."""
    session = ContactSession(
        changed(EstimationParameters(), {**world.parameters, 'estimator': estimator}),
        generate_reference=False)
    times: dict[int, float] = {}
    rows: list[tuple[Any, ...]] = []
    warnings: list[tuple[float, str, str]] = []
    laws: list[tuple[float, Mapping[str, float]]] = []
    look, error = _LOOK_S, ''
    try:
        for t, kind, stamp_ns, values in messages(world.wrenches, world.motions):
            if kind:
                times[stamp_ns] = t
            add = session.add_wrench if kind else session.add_motion
            rows += [_row(times, result) for result in add(stamp_ns, *values)]
            if t >= look:
                look = t + _LOOK_S
                warnings += [(t, one.name, one.text) for one in session.checks.warnings()]
                laws.append((t, dict(zip(LAWS, session.pipeline.posterior.known.laws))))
    except Exception as raised:  # whatever it is, it is what the study looks for
        error = f'{type(raised).__name__}: {raised}'
    t, K, B, K_std, B_std, location, contact = np.array(rows or [(nan,) * 7]).T
    return Trace(t, K, B, K_std, B_std, location, contact == 1.0, warnings, laws, error)


def messages(wrenches: Stream, motions: Stream) -> list[tuple[float, int, int, list[float]]]:
    """Return time, 1 for a wrench or 0, stamp and values of all messages, in order."""
    found = []
    for kind, stream in enumerate((motions, wrenches)):
        found += [(t, kind, stamp_ns, values) for t, stamp_ns, values in zip(
            stream.t.tolist(), stream.stamp_ns.tolist(), stream.values.tolist())]
    return sorted(found, key=lambda message: message[:2])


def _row(times: Mapping[int, float], result: Result) -> tuple[Any, ...]:
    one = result.estimate
    return (times[result.sample.stamp_ns], one.stiffness, one.damping, one.stiffness_std,
            one.damping_std, one.location, one.status is not EstimateStatus.FREE)


def score(
    world: World, trace: Trace, at: float | None = None,
    instants: Sequence[float] | Array | None = None, more: Mapping[str, Any] | None = None,
) -> Score:
    """Compare with the truth: errors at a time [s], bands at instants [s] of settled contact."""
    at = end_of_contact(world) if at is None else at
    instants = settled_instants(world) if instants is None else instants
    raised = {'raised': True} if trace.error else {}
    K_error = B_error = nan
    k = sample_at(trace, at)
    if k >= 0:
        stiffness, damping = truth_at(world, at)
        if isfinite(trace.K_std[k]):
            K_error = float(trace.K[k]) / stiffness - 1.0
        if isfinite(trace.B_std[k]):
            B_error = float(trace.B[k]) / damping - 1.0
    held = [_held(world, trace, time) for time in instants]
    K_held, B_held = ([bool(one[i]) for one in held if one[i] is not None] for i in (0, 1))
    return Score(world.group, K_error, B_error, (sum(K_held), len(K_held)),
                 (sum(B_held), len(B_held)), {**(more or {}), **raised})


def _held(world: World, trace: Trace, at: float) -> tuple[bool | None, bool | None]:
    k = sample_at(trace, at)
    if k < 0:
        return None, None
    stiffness, damping = truth_at(world, float(trace.t[k]))
    K, B, K_std, B_std = trace.K[k], trace.B[k], trace.K_std[k], trace.B_std[k]
    return (None if np.isnan(K_std) else bool(abs(K - stiffness) <= BAND * K_std),
            None if np.isnan(B_std) else bool(abs(B - damping) <= BAND * B_std))


def in_contact(world: World, trace: Trace) -> NDArray[np.bool_]:
    """Return which samples are in contact, from 0.3 s after its touch."""
    inside = np.zeros(len(trace.t), bool)
    for begin, end in world.truth.contacts:
        inside |= (trace.t > begin + _TOUCHED_S) & (trace.t < end - _BEFORE_END_S)
    return inside


def law_families(trace: Trace, at: float) -> dict[str, float]:
    """Return the probability of each family of laws at a time; {} before the first look."""
    known = [laws for t, laws in trace.laws if t <= at]
    found: dict[str, float] = {}
    for law, probability in (known[-1] if known else {}).items():
        name = _FAMILIES.get(law, law)
        found[name] = found.get(name, 0.0) + probability
    return found


def truth_at(world: World, at: float) -> tuple[float, float]:
    """Return the true K_e [N/m] and B_e [N s/m]."""
    truth = world.truth
    k = min(int(np.searchsorted(truth.t, at)), len(truth.t) - 1)
    return float(truth.stiffness[k]), float(truth.damping[k])


def sample_at(trace: Trace, at: float) -> int:
    """Return the index of the last sample until a time; -1: none, or nothing came for 0.1 s."""
    k = int(np.searchsorted(trace.t, at, side='right')) - 1
    return k if k >= 0 and trace.t[k] > at - _LOOK_S else -1


def end_of_contact(world: World) -> float:
    """Return when the last contact is about to end [s]."""
    return world.truth.contacts[-1][1] - _BEFORE_END_S


def settled_instants(world: World, since: float = _SETTLED_S) -> Array:
    """Return the times in contact, every 0.1 s from some time after each touch [s]."""
    return np.concatenate([np.arange(begin + since, end - _BEFORE_END_S, _EVERY_S)
                           for begin, end in world.truth.contacts])


GAP = 5e-3
"""Of the tool from the wall in free flight [m]."""

AS_TOLD, WITHIN, EXACT, UNKNOWN = 'x_e as told', 'x_e within 2 mm', 'x_e exact', 'x_e unknown'
MOVE_S = 0.5
"""Duration of an approach and of a withdrawal [s]."""

_DEEPEST = 0.03  # [m]
_LOCATION, _LOCATION_STD, _FARTHEST = 0.3, 2e-3, 3.0  # [m], [m], of them
_GOLDEN = 0.6180339887


class Row(NamedTuple):
    """One item that is measured."""

    meaning: str  # what is measured
    # worlds, quick: number of worlds, and with --quick
    worlds: int
    quick: int
    # makes a world from a generator and its index
    make: Callable[[np.random.Generator, int], Any]
    score: Callable[[Any, Any], Score]  # scores a trace of a world
    trace: Callable[[Any, str], Any] = follow  # with an estimator

    def run(
        self, draw: np.random.Generator, index: int, estimator: str = MULTIPLE_MODEL
    ) -> Score:
        """Make, follow and score one world."""
        world = self.make(draw, index)
        return self.score(world, self.trace(world, estimator))


def spread(index: int, low: float = 300.0, high: float = 3e4) -> float:
    """Return a stiffness [N/m], evenly spread in its logarithm over consecutive indices."""
    share: float = (0.5 + index * _GOLDEN) % 1.0
    return low * (high / low)**share


def drawn_wall(draw: np.random.Generator, stiffness: float, location: float, **law: Any) -> Wall:
    """Return a wall with B_e / K_e of 2 to 50 ms."""
    return Wall(stiffness, stiffness * log_uniform(draw, 2e-3, 5e-2), location, **law)


def drawn_sensor(draw: np.random.Generator, **known: Any) -> Sensor:
    """Return a sensor as real ones are, the velocity measured by every second."""
    drawn = Sensor(
        draw.uniform(0.5e-3, 1.6e-3), int(draw.integers(1, 3)), log_uniform(draw, 0.1, 0.5),
        0.05 * draw.standard_normal(), log_uniform(draw, 2e-7, 2e-6),
        1e-4 if draw.uniform() < 0.5 else nan)
    return drawn._replace(**known)


def drawn_location(draw: np.random.Generator, how: str) -> tuple[dict[str, Any], float]:
    """Return the parameters that tell x_e, and the true x_e [m]."""
    off = float(np.clip(draw.standard_normal(), -_FARTHEST, _FARTHEST)) * _LOCATION_STD
    parameters: dict[str, Any] = {'environment.location': _LOCATION}
    if how == EXACT:
        parameters['environment.location_std'] = 0.0
    elif how == UNKNOWN:
        parameters['environment.location'] = nan
    return parameters, _LOCATION + (off if how in (WITHIN, UNKNOWN) else 0.0)


def drawn_depth(draw: np.random.Generator, stiffness: float) -> float:
    """Return the depth of a press of 20 to 60 N [m]."""
    return min(draw.uniform(20.0, 60.0) / stiffness, _DEEPEST)


def presses(
    draw: np.random.Generator, depth: float, contacts: int = 2, hold_s: float = 4.0,
    excited: bool = True, free_s: float = 1.0,
) -> tuple[list[Piece], float]:
    """Return a path that presses to a depth [m], holds and withdraws, and its duration [s]."""
    pieces, t = [start(-GAP)], 0.0
    for _ in range(contacts):
        t += free_s
        pieces.append(ramp(t, MOVE_S, GAP + depth))
        t += MOVE_S
        if excited:
            pieces.append(sines(t, t + hold_s, depth / 3.0, draw))
        t += hold_s
        pieces.append(ramp(t, MOVE_S, -GAP - depth))
        t += MOVE_S
    return pieces, t + 0.5 * free_s
