# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Small simulated recordings and their diagnoses, each made once, for several test files."""

from functools import lru_cache
from math import pi
from pathlib import Path
from typing import Any

from concealed_worlds import record
from contact_estimation.diagnosis.diagnose import diagnose
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.result import Diagnosis
from contact_estimation.parameters import build
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.recordings import RecordingWriter
from contact_estimation.recordings.encoding import (
    JointStateEncoder, TrajectoryEncoder, WrenchEncoder)
from contact_estimation.reference.experiment import Experiment, Segment
import numpy as np
import yaml

MODEL: dict[str, Any] = {
    'environment': {'stiffness': 5000.0, 'damping': 100.0},
    'robot': {'mass': 12.0, 'damping': 350.0, 'stiffness': 2500.0},
}
RATE_HZ, INTEGRATION_HZ = 250.0, 1000.0  # see test_effect_worlds.py
BEGIN_NS = 1_750_000_000_000_000_000
_TOUCH = (
    Segment(0.8, -0.01),
    Segment(0.5, 0.03),
    *(Segment(0.16, place) for place in (0.02, 0.036, 0.022, 0.032, 0.018, 0.03)),
    Segment(0.4, 0.03),
    Segment(0.4, -0.01),
)
TWO_TOUCHES = Experiment('two touches', -0.01, (*_TOUCH, *_TOUCH, Segment(0.6, -0.01)))


def nominal() -> PlantParameters:
    """Give the model of the simulation."""
    return world()


def world(**changes: Any) -> PlantParameters:
    """Change the nominal model; dots in names as double underscores."""
    flat = {f'{group}.{name}': value for group, values in MODEL.items()
            for name, value in values.items()}
    flat.update({name.replace('__', '.'): value for name, value in changes.items()})
    return build(PlantParameters, flat)


def recorded(experiment: Experiment = TWO_TOUCHES, seed: int = 1, **changes: Any) -> Signals:
    """Record an experiment in a noisy world; equal requests share one simulation."""
    return _recorded(experiment, seed, tuple(changes.items()))


@lru_cache(maxsize=None)
def _recorded(experiment: Experiment, seed: int, changes: tuple[Any, ...]) -> Signals:
    return record(world(
        sensors__force_noise=0.3, sensors__position_noise=3e-6, sample_rate=RATE_HZ,
        integration_rate=INTEGRATION_HZ, seed=seed, **dict(changes)), experiment)


@lru_cache(maxsize=None)
def diagnosed(name: str) -> Diagnosis:
    """Diagnose one of the worlds: 'clean', 'stiffer', 'friction' or 'unknown'."""
    signals = {
        'clean': lambda: recorded(),
        'stiffer': lambda: recorded(environment__stiffness=5600.0),
        'friction': lambda: recorded(seed=2, physics__coulomb_friction__F_c=2.0),
        'unknown': lambda: with_unknown_force(recorded()),
    }[name]()
    return diagnose(Recording(f'{name}.mcap', signals), nominal())


def with_unknown_force(signals: Signals) -> Signals:
    """Add to the force in contact what no effect of the library is like."""
    t, x = signals.wrench_t, signals.position
    swing = 10.0 * np.sin(x / 0.002) * (1.0 + np.cos(2.0 * pi * 1.3 * t))
    return signals._replace(force=signals.force + np.where(x > 0.0, swing, 0.0))


def write_recording(
    path: Path, signals: Signals, wrench: str = '/wrench', with_reference: bool = True
) -> Path:
    """Write signals with common stamps as a recording."""
    wrenches = WrenchEncoder('tool')
    joints = JointStateEncoder('tool', 'contact_x', False)
    references = TrajectoryEncoder('tool', 'contact_x')
    with RecordingWriter.file(path) as writer:
        for k, t in enumerate(signals.wrench_t.tolist()):
            stamp_ns = BEGIN_NS + round(1e9 * t)
            position, force = float(signals.position[k]), float(signals.force[k])
            for topic, kind, data in (
                ('/joint_states', 'sensor_msgs/msg/JointState',
                 joints.encode(stamp_ns, position, float('nan'))),
                ('/reference_trajectory', 'trajectory_msgs/msg/JointTrajectory',
                 references.encode(stamp_ns, *signals.reference[:, k].tolist())),
                (wrench, 'geometry_msgs/msg/WrenchStamped',
                 wrenches.encode(stamp_ns, force, 0.0, 0.0)),
            ):
                if with_reference or topic != '/reference_trajectory':
                    writer.write(topic, kind, data, stamp_ns)
    return path


def write_model(path: Path, **sections: Any) -> Path:
    """Write the nominal model, with sections changed, as a model file."""
    content = {'plant_node': {'ros__parameters': {**MODEL, **sections}}}
    path.write_text(yaml.safe_dump(content))
    return path
