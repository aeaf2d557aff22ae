# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
On-line estimation of contact stiffness and damping, and diagnosis of simulation models.

``import contact_estimation as ce`` gives the names of `__all__`. Each name is imported when it is
first used, so importing the package is fast and needs neither numpy nor ROS.

"""

from importlib import import_module
from typing import Any, TYPE_CHECKING

if TYPE_CHECKING:
    from .diagnosis.conclude.diagnose import diagnose
    from .diagnosis.conclude.result import Diagnosis, NamedEffect
    from .diagnosis.observe.read_recording import read_recording
    from .estimation.parameters import EstimationParameters
    from .estimation.pipeline import EstimationPipeline
    from .estimation.session import ContactSession
    from .estimators import ESTIMATORS
    from .estimators.estimate import Estimate
    from .exceptions import ContactEstimationError
    from .kinematics.written_friction import joint_friction
    from .physics import EFFECTS
    from .plant.closed_loop import run_closed_loop
    from .plant.model_file import read_model
    from .plant.plant_parameters import PlantParameters, SensorParameters
    from .recordings.arrays import read_table, write_recording
    from .reference.experiments import experiment_named
    from .reference.stable_gains import stable_gains, StableGains

__all__ = [
    'ContactEstimationError',
    'ContactSession',
    'diagnose',
    'Diagnosis',
    'EFFECTS',
    'Estimate',
    'ESTIMATORS',
    'EstimationParameters',
    'EstimationPipeline',
    'experiment_named',
    'joint_friction',
    'NamedEffect',
    'PlantParameters',
    'read_model',
    'read_recording',
    'read_table',
    'run_closed_loop',
    'SensorParameters',
    'stable_gains',
    'StableGains',
    'write_recording',
]

_MODULES = {
    'ContactEstimationError': 'exceptions',
    'ContactSession': 'estimation.session',
    'diagnose': 'diagnosis.conclude.diagnose',
    'Diagnosis': 'diagnosis.conclude.result',
    'EFFECTS': 'physics',
    'Estimate': 'estimators.estimate',
    'ESTIMATORS': 'estimators',
    'EstimationParameters': 'estimation.parameters',
    'EstimationPipeline': 'estimation.pipeline',
    'experiment_named': 'reference.experiments',
    'joint_friction': 'kinematics.written_friction',
    'NamedEffect': 'diagnosis.conclude.result',
    'PlantParameters': 'plant.plant_parameters',
    'read_model': 'plant.model_file',
    'read_recording': 'diagnosis.observe.read_recording',
    'read_table': 'recordings.arrays',
    'run_closed_loop': 'plant.closed_loop',
    'SensorParameters': 'plant.plant_parameters',
    'stable_gains': 'reference.stable_gains',
    'StableGains': 'reference.stable_gains',
    'write_recording': 'recordings.arrays',
}

if not TYPE_CHECKING:  # a type checker would accept any name of a module that has __getattr__
    def __getattr__(name: str) -> Any:
        """Import a public name on first use."""
        if name not in _MODULES:
            raise AttributeError(
                f'module {__name__!r} has no attribute {name!r}; expected one of '
                f'{", ".join(__all__)}'
            )
        value = getattr(import_module(f'.{_MODULES[name]}', __name__), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
