# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""The parameters of all processes of the loop, checked before any of them starts."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Mapping, NamedTuple

import yaml

from .estimator_node_parameters import EstimatorNodeParameters
from ..exceptions import ParameterRangeError
from ..parameters.file import ANY_NODE, read_parameter_file
from ..parameters.specification import ParameterGroup, specifications
from ..parameters.values import build, without
from ..pipeline.parameters import EstimationParameters
from ..plant.plant_node_parameters import PlantNodeParameters
from ..plant.plant_parameters import PAPER_NOISE, PlantParameters
from ..reference.experiment import Experiment
from ..reference.experiments import experiment_named, EXPERIMENTS
from ..reference.parameters import refuse_double_tracking

_LONGEST_S = 1e6
_RELIABLY = {f'qos_overrides./{topic}.subscription.reliability': 'reliable'
             for topic in ('wrench', 'joint_states', 'desired_trajectory')}
"""What the plant offers; best effort, as of any robot, may lose samples of a busy machine."""


def _names(*groups: type[ParameterGroup]) -> set[str]:
    return {spec.name for group in groups for spec in specifications(group)}


_OF_ESTIMATOR = _names(EstimationParameters, EstimatorNodeParameters)
_OF_PLANT = _names(PlantParameters, PlantNodeParameters)


class LoopConfiguration(NamedTuple):
    """Everything that a run of the loop depends on."""

    experiment: Experiment  # what the plant's planner plays
    duration: float  # length of the run [s]
    estimation: EstimationParameters  # as the estimator node will read them
    plant: PlantParameters  # as the plant node will read them
    sections: Mapping[str, Mapping[str, Any]]  # parameters of each node by full name

    @property
    def law(self) -> str:
        """Return the reference law, and whether the robot tracks force itself."""
        tracking = ' with force tracking' if self.plant.robot.force_tracking else ''
        return self.estimation.reference_law + tracking


def configure(
    experiment: str, parameter_file: str | None = None, estimator: str | None = None,
    duration: float | None = None, seed: int | None = None, reference_law: str | None = None,
    lockstep: bool = False,
) -> LoopConfiguration:
    """
    Combine a parameter file with options and check the result.

    duration: length of the run [s]; one experiment by default
    lockstep: the plant waits for the answer to each sample; otherwise as the file says
    """
    played = experiment_named(experiment)
    seconds = _duration(duration, played)
    plant_values: dict[str, Any] = {
        **PAPER_NOISE, **_values_in(parameter_file, 'plant_node', _OF_PLANT, _OF_ESTIMATOR),
        'experiment': (experiment if experiment in EXPERIMENTS
                       else str(Path(experiment).absolute())),
        'duration': seconds, 'repeat': seconds > played.duration,
        'subscribers': 2,  # estimator and recorder
    }
    if seed is not None:
        plant_values['seed'] = seed
    if lockstep:
        plant_values['lockstep'] = True
    plant = build(PlantParameters, without(PlantNodeParameters, plant_values))
    # The estimator's reference law depends on the robot and must assume the same one.
    estimator_values: dict[str, Any] = {
        'reference.robot_force_tracking': plant.robot.force_tracking,
        'reference.robot_stiffness': plant.robot.stiffness,
        'sample_rate': plant.sample_rate,
        **_values_in(parameter_file, 'estimator_node', _OF_ESTIMATOR, _OF_PLANT),
    }
    if estimator is not None:
        estimator_values['estimator'] = estimator
    if reference_law is not None:
        estimator_values['reference_law'] = reference_law
    estimation = build(EstimationParameters, without(EstimatorNodeParameters, estimator_values))
    refuse_double_tracking(estimation.reference_law, plant.robot.force_tracking)
    sections = {'estimator_node': estimator_values, 'plant_node': plant_values}
    return LoopConfiguration(played, seconds, estimation, plant, sections)


def _values_in(
    parameter_file: str | None, node: str, own: set[str], others: set[str]
) -> dict[str, Any]:
    """Read the parameters of a node; in the section of any node, those of the other are left."""
    if not parameter_file:
        return {}
    shared = read_parameter_file(parameter_file, ANY_NODE)
    return {name: value for name, value in read_parameter_file(parameter_file, node).items()
            if name in own or name not in shared or name not in others}


def _duration(given: float | None, experiment: Experiment) -> float:
    if given is None:
        return experiment.duration
    if not 0.0 < given <= _LONGEST_S:
        raise ParameterRangeError(f'--duration must be > 0 and <= {_LONGEST_S:g} s, got {given:g}')
    return given


def write_parameters(
    path: Path, configuration: LoopConfiguration, recording: Path,
    plant_summary: Path | None = None,
) -> None:
    """Write the parameter file of all nodes."""
    estimator, plant = (configuration.sections[f'{name}_node'] for name in ('estimator', 'plant'))
    nodes = {
        'estimator_node': {**(_RELIABLY if plant.get('lockstep') else {}), **estimator},
        'plant_node': {**plant, 'summary_file': str(plant_summary or '')},
        'recorder_node': {'output': str(recording)},
    }
    nested = {node: {'ros__parameters': dict(values)} for node, values in nodes.items()}
    path.write_text(yaml.safe_dump(nested, sort_keys=False))
