# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

# The public names: `__init__.py` imports each when it is first used.
from .diagnosis.diagnose import diagnose as diagnose
from .diagnosis.observe.signals import read_recording as read_recording, Recording as Recording
from .diagnosis.result import Diagnosis as Diagnosis, NamedEffect as NamedEffect
from .estimators import ESTIMATORS as ESTIMATORS
from .estimators.estimate import Estimate as Estimate
from .exceptions import ContactEstimationError as ContactEstimationError
from .kinematics.description import joint_friction as joint_friction
from .physics import EFFECTS as EFFECTS
from .pipeline.axes import Result as Result
from .pipeline.axis_pipeline import EstimationPipeline as EstimationPipeline
from .pipeline.parameters import EstimationParameters as EstimationParameters
from .pipeline.session import ContactSession as ContactSession
from .plant.closed_loop import ClosedLoopRun as ClosedLoopRun, run_closed_loop as run_closed_loop
from .plant.plant_parameters import (
    PlantParameters as PlantParameters, read_model as read_model,
    SensorParameters as SensorParameters)
from .recordings.arrays import read_table as read_table, write_recording as write_recording
from .reference.experiment import Experiment as Experiment
from .reference.experiments import experiment_named as experiment_named
from .reference.stable_gains import stable_gains as stable_gains, StableGains as StableGains

__all__: list[str]
