# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""What a diagnosis says: plain data that report, pictures and model files are made of."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .dependence import Dependence
from .location import Location
from ..observe.model import Model
from ..observe.ports import Ports

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Value:
    """
    A parameter with its uncertainty.

    Attributes
    ----------
    value, std : float
        Standard deviation from residuals clustered in blocks of time.
    unit : str
        SI.

    """

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class NamedEffect:
    """
    An effect that was found.

    Attributes
    ----------
    name, port, equation : str
        As in the registry.
    probability : float
        Of this name among the rivals, given that one of them is true.
    parameters : dict of str to Value
        Fitted.
    indistinguishable_from : list of str
        Names that predict held-out data as well.
    location : Location
        Where it was seen.

    """

    name: str
    port: str
    equation: str
    probability: float
    parameters: dict[str, Value]
    indistinguishable_from: list[str]
    location: Location


@dataclass(frozen=True)
class Errors:
    """
    Root-mean-square errors of the three models.

    Attributes
    ----------
    nominal, recalibrated, corrected : float or None
        None where there is nothing to compare.

    """

    nominal: float | None
    recalibrated: float | None
    corrected: float | None


@dataclass(frozen=True)
class HeldOutErrors:
    """
    Errors on one part that no fit has seen.

    Attributes
    ----------
    name : str
        Such as 'episode 2'.
    force, motion : Errors
        [N], [m].

    """

    name: str
    force: Errors
    motion: Errors


@dataclass(frozen=True)
class Diagnosis:
    """
    The result.

    Attributes
    ----------
    verdict : str
        'consistent', 'recalibrate', 'physics_missing' or 'unexplained'.
    effects : list of NamedEffect
        Strongest first.
    location : Location or None
        Of what the recalibrated model leaves; None where that is noise.
    nominal, recalibrated, corrected : Model
        The three models; the last with the effects.
    stiffness, damping : Value
        Of the corrected model.
    noise_floor : float
        Of the force [N].
    force, motion : Errors
        Pooled over the held-out parts [N], [m].
    improvement : tuple of float or None
        95 % interval of 1 - corrected / recalibrated.
    holdouts : list of HeldOutErrors
        Part by part.
    next_experiment : str
        What to run, in words; '' where nothing is open.
    rivals : dict of str to Model
        Models that the next experiment would tell from the corrected one, by effect.
    evidence : dict of str to float
        Share of the misfit that each candidate alone explains, by name.
    left : float
        Mean square of what the corrected model leaves, in those of the noise.
    predictable : float
        Share of it that a flexible smoother predicts in blocks it has not seen.
    dependences : dict of str to list of Dependence
        On what the residuals of the shown recording depend, for each model of `pair`.
    shown : str
        Name of the recording that is located and shown: the worst.
    ports : list of Ports
        The recordings, for pictures, the shown one first.
    free_runs : dict of str to ndarray
        Positions of its free runs, by model.

    """

    verdict: str
    effects: list[NamedEffect]
    location: Location | None
    nominal: Model
    recalibrated: Model
    corrected: Model
    stiffness: Value
    damping: Value
    noise_floor: float
    force: Errors
    motion: Errors
    improvement: tuple[float, float] | None
    holdouts: list[HeldOutErrors]
    next_experiment: str
    rivals: dict[str, Model]
    evidence: dict[str, float]
    left: float
    predictable: float
    dependences: dict[str, list[Dependence]] = field(repr=False)
    shown: str
    ports: list[Ports] = field(repr=False)
    free_runs: dict[str, Array] = field(repr=False)

    @property
    def pair(self) -> tuple[str, str]:
        """The models to be compared: before and after what the diagnosis changes."""
        return pair_of(bool(self.effects))

    @property
    def located_port(self) -> str:
        """The port that shows the mismatch: 'motion' or 'force'."""
        in_motion = self.location is not None and self.location.port == 'robot'
        return 'motion' if in_motion or self.ports[0].driven_by_force(self.nominal) else 'force'

    @property
    def between_samples(self) -> str | None:
        """How the force that drives a wall goes on between samples; None with a robot."""
        driven = self.ports[0].driven_by_force(self.nominal)
        return self.ports[0].observed.between if driven else None


def pair_of(with_effects: bool) -> tuple[str, str]:
    """
    Tell which models a diagnosis compares.

    Parameters
    ----------
    with_effects : bool
        Whether effects are named.

    Returns
    -------
    before, after : str
        Attributes of `Diagnosis`.

    """
    return ('recalibrated', 'corrected') if with_effects else ('nominal', 'recalibrated')
