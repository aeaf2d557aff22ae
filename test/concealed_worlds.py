# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Short noisy recordings of worlds with concealed physics, some of it outside the library."""

from dataclasses import dataclass
from functools import lru_cache
from math import pi, sin
from typing import Any, Sequence

from contact_estimation.diagnosis.diagnose import diagnose
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.result import Diagnosis
from contact_estimation.parameters import build, optional_parameter
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.contact_effect import ContactEffect, State
from contact_estimation.physics.effect import Effect
from contact_estimation.physics.force_sensor_effect import ForceSensorEffect
from contact_estimation.physics.numeric import Number
from contact_estimation.physics.robot_effect import RobotEffect
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.plant.simulation import run_open_loop, simulate_force
from contact_estimation.reference.experiment import Excitation, Experiment, Multisine, Segment
from contact_estimation.reference.reference_generator import quintic
import numpy as np


@dataclass(frozen=True)
class SoftSpell(ContactEffect):
    """A wall that is softer during an interval."""

    softer: float = optional_parameter('', '1')
    first: float = optional_parameter('', '1')
    last: float = optional_parameter('', '1')

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        return -self.softer * d if self.first < t < self.last else 0.0


@dataclass(frozen=True)
class WarmingWall(ContactEffect):
    """A wall that softens as motion warms it, and recovers as it cools."""

    softening: float = optional_parameter('', '1')
    tau: float = optional_parameter('', '1')
    states = 1  # warmth, as distance travelled in contact [m]

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        return -self.softening * state[0] * d

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        """Heat by motion in contact, and cool exponentially."""
        return ((abs(v) if contact else 0.0) - state[0] / self.tau,)


@dataclass(frozen=True)
class Ripple(ContactEffect):
    """A force periodic in the depth, as of a thread or of magnets."""

    amplitude: float = optional_parameter('', '1')
    wavelength: float = optional_parameter('', '1')

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        return self.amplitude * sin(2.0 * pi * d / self.wavelength)


@dataclass(frozen=True)
class Hum(ForceSensorEffect):
    """A force sensor that picks up the mains."""

    amplitude: float = optional_parameter('', '1')
    frequency: float = optional_parameter('', '1')

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        return force + self.amplitude * m.sin(2.0 * pi * self.frequency * t)


@dataclass(frozen=True)
class DeadBand(RobotEffect):
    """Drives that do not answer to small forces."""

    width: float = optional_parameter('', '1')

    def control(self, u: Any, m: Any) -> Any:
        width = self.width
        return u - 0.5 * (abs(u + width) - abs(u - width))


OUTSIDE_EFFECTS: dict[str, type[Effect]] = {
    cls.name: cls for cls in (SoftSpell, WarmingWall, Ripple, Hum, DeadBand)
}


def make_outside(name: str, **values: float) -> Effect:
    """Build an effect outside the library, to pass to `World`."""
    return OUTSIDE_EFFECTS[name](**values)


MODEL: dict[str, Any] = {
    'environment.stiffness': 5000.0, 'environment.damping': 120.0,
    'robot.mass': 12.0, 'robot.damping': 350.0, 'robot.stiffness': 2500.0,
}
FORCE_NOISE, POSITION_NOISE, QUANTUM = 0.3, 3e-6, 1e-6
SENSORS: dict[str, Any] = {
    'sensors.force_noise': FORCE_NOISE, 'sensors.position_noise': POSITION_NOISE,
    'sensors.position_quantisation': QUANTUM,
}
RATE_HZ, FREE = 250.0, -0.012
INTEGRATION_HZ = 2000.0  # fine enough for friction, see test_effect_worlds.py

_TONES_HZ = (0.7, 1.3, 2.1, 3.3, 4.7, 6.1)
_SWING = Multisine(1.0, [2.0 * pi * f for f in _TONES_HZ])
_RISE_S = 0.2


class Swing(Excitation):
    """A multisine that swells and fades: an excitation that jumps would be an impact."""

    def __init__(self, amplitude: float, begin: float, duration: float) -> None:
        self._amplitude, self._begin, self._end = amplitude, begin, begin + duration

    def _window(self, t: float) -> tuple[float, float, float]:
        if t < self._end - _RISE_S:
            return quintic(0.0, self._amplitude, _RISE_S, t - self._begin)
        return quintic(self._amplitude, 0.0, _RISE_S, t - self._end + _RISE_S)

    def value(self, t: float) -> float:
        """Give the product of window and multisine."""
        return self._window(t)[0] * _SWING.value(t)

    def rates(self, t: float) -> tuple[float, float]:
        """Differentiate the product."""
        (w, w_1, w_2), m, (m_1, m_2) = self._window(t), _SWING.value(t), _SWING.rates(t)
        return w_1 * m + w * m_1, w_2 * m + 2.0 * w_1 * m_1 + w * m_2


Touch = tuple[float, float]  # where x_d goes [m], how long it swings there [s]


def touches(*places: Touch, swing: float = 0.012) -> Experiment:
    """Touch, swing, hold and let go, each time from free flight."""
    segments, now = [Segment(0.7, FREE)], 0.7
    for depth, duration in places:
        excitation = Swing(swing, now + 0.5, duration)
        segments += [
            Segment(0.5, depth), Segment(duration, depth, position_excitation=excitation),
            Segment(0.2, depth), Segment(0.4, FREE), Segment(0.3, FREE)]
        now += duration + 1.4
    return Experiment('touches', FREE, tuple(segments))


TOUCHES = touches((0.03, 1.0), (0.024, 0.8), (0.036, 0.6))


def nominal(**changes: Any) -> PlantParameters:
    """Give the model that the diagnosis is told; dots in names as double underscores."""
    return build(PlantParameters, {**MODEL, **_dotted(changes)})


def _dotted(changes: dict[str, Any]) -> dict[str, Any]:
    return {name.replace('__', '.'): value for name, value in changes.items()}


def physics(name: str, *values: float) -> dict[str, Any]:
    """Name an effect's parameters with dots as double underscores."""
    return {f'physics__{name}__{key}': value
            for key, value in zip(EFFECTS[name].neutral(), values)}


def recorded(experiment: Experiment = TOUCHES, seed: int = 1, **changes: Any) -> Signals:
    """Record an experiment in a world; equal requests share one simulation."""
    return _recorded(experiment, seed, tuple(changes.items()))


@lru_cache(maxsize=None)
def _recorded(experiment: Experiment, seed: int, changes: tuple[Any, ...]) -> Signals:
    return record(_world(seed, dict(changes)), experiment)


def _world(seed: int, changes: dict[str, Any]) -> PlantParameters:
    return build(PlantParameters, {
        **MODEL, **SENSORS, 'sample_rate': RATE_HZ, 'integration_rate': INTEGRATION_HZ,
        'seed': seed, **_dotted(changes),
    })


def record(
    plant: PlantParameters, experiment: Experiment = TOUCHES, further: Sequence[Effect] = ()
) -> Signals:
    """Record an experiment with a given plant."""
    def reference(t: float) -> tuple[float, float, float, float]:
        return (*experiment.desired(t)[:3], 0.0)

    start = experiment.desired(0.0).position
    truths, samples = run_open_loop(plant, reference, start, experiment.duration, further)
    t = np.array([truth.t for truth in truths])
    return Signals(t, samples.force, t, samples.position, t,
                   np.array([reference(now) for now in t.tolist()]).T)


@lru_cache(maxsize=None)
def with_unknown(name: str, *values: tuple[str, float]) -> Signals:
    """Record a world with an effect outside the library."""
    return record(_world(1, {}), further=(make_outside(name, **dict(values)),))


def softened(first: float, last: float) -> Signals:
    """Record a world whose wall is an eighth softer for a while."""
    return with_unknown('soft_spell', ('softer', 600.0), ('first', first), ('last', last))


ATTACHED: dict[str, Any] = {
    'environment__stiffness': 5000.0, 'environment__damping': 12.0, 'environment__inertia': 2.0,
    'environment__unilateral': False,
}
_SHAKE = Multisine(25.0, [2.0 * pi * f for f in (0.6, 1.7, 3.1, 5.3, 7.1, 8.3, 9.7, 12.1)])


@lru_cache(maxsize=None)
def attached(*changes: tuple[str, float]) -> Signals:
    """Record a permanently attached wall under a known force."""
    plant = _world(1, {**ATTACHED, 'sensors__force_noise': 0.0, 'integration_rate': 5000.0,
                       **dict(changes)})
    stamps = np.arange(round(8.0 * RATE_HZ)) * round(1e9 / RATE_HZ)
    t = np.asarray(stamps * 1e-9, np.float64)
    force = np.array([_SHAKE.value(now) for now in t.tolist()])
    measured = simulate_force(plant, stamps, force, (0.0, 0.0)).measured
    return Signals(t, measured[0], t, measured[1], np.empty(0), np.empty((4, 0)))


def diagnosed(signals: Signals, model: PlantParameters | None = None) -> Diagnosis:
    """Diagnose one recording."""
    return diagnose(Recording('world', signals), model or nominal())


def named(diagnosis: Diagnosis) -> list[str]:
    """List the names."""
    return [effect.name for effect in diagnosis.effects]


def prepared_from(
    signals: Signals, model: PlantParameters | None = None
) -> tuple[PreparedRecording, Model]:
    """Prepare a recording as the diagnosis does, nothing held out."""
    start = Model.of(model or nominal())
    return PreparedRecording.of('world', observe(signals, start.nominal), start), start
