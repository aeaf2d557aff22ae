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

"""
The experiment that separates what a recording could not.

Each candidate is simulated with the corrected model; then the rival is held to that motion, with
the values that suit it best and still fit the old recordings. What it cannot follow even so is
what the diagnosis would see (T-optimality, Atkinson and Fedorov 1975, linearised).
"""

from __future__ import annotations

import dataclasses
from math import isfinite, sqrt
from typing import Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .candidates import Candidate, candidates, Reach, scaling_test
from .finding import Diagnosis
from ..fit.fitting import differentiate_by, residual_function
from ..fit.free_run import plant_of
from ..fit.nuisances import doubt
from ..fit.selection import THRESHOLD
from ..observe.episodes import episodes
from ..observe.model import Model
from ..observe.observed import Observed
from ..observe.ports import Ports
from ..observe.usable_samples import default_block, usable
from ...plant.open_loop import simulate_on
from ...reference.experiment import Experiment

Array = NDArray[np.float64]

_INTEGRATION_RATE = 1000.0
_LEAST_PACE = 0.1


class Proposal(NamedTuple):
    """
    What to run next.

    Attributes
    ----------
    text : str
        In a sentence, with what it promises.
    experiment : Experiment
        To be played.

    """

    text: str
    experiment: Experiment


class Difference(NamedTuple):
    """
    What tells two models apart in an experiment.

    Attributes
    ----------
    strength : float
        Mean square of the residuals, in those of the noise.
    force, motion : float
        Greatest difference of each port, in standard deviations of one sample.

    """

    strength: float
    force: float
    motion: float


def choose(diagnosis: Diagnosis) -> Proposal | None:
    """
    Propose an experiment.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    proposal : Proposal or None
        None where nothing is open, or where there is no robot to play it: a permanently attached
        environment is driven by a force.

    """
    if not diagnosis.nominal.nominal.environment.unilateral:
        return None
    if diagnosis.rivals:
        return _separating(diagnosis)
    if diagnosis.verdict == 'unexplained':
        candidate = scaling_test(reach_of(diagnosis))
        return Proposal(candidate.words, candidate.experiment)
    return None


def reach_of(diagnosis: Diagnosis) -> Reach:
    """
    Measure how far the recordings went: no proposal shall go further.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    reach : Reach
        Over all recordings.

    """
    model = diagnosis.recalibrated
    depths, speeds, touching = [], [], []
    x_e = model.nominal.environment.location
    for port in diagnosis.ports:
        o = port.observed
        depths.append(float(np.percentile(o.x[o.x > x_e], 98)) - x_e)
        speeds.append(float(np.max(np.abs(o.v))))
        touching += [abs(float(o.v[first])) for first, _ in episodes(model, o)]
    lowest = min(float(np.min(port.observed.x)) for port in diagnosis.ports)
    gain = 1.0 + model.stiffness / max(model.nominal.robot.stiffness, 1e-9)
    # A touch-down at no speed at all would make the half of it take for ever.
    typical = max(float(np.median(touching or speeds)), _LEAST_PACE * max(speeds))
    return Reach(x_e, x_e - lowest, max(depths), gain, max(speeds), typical)


def _separating(diagnosis: Diagnosis) -> Proposal:
    judge = Judge(diagnosis)
    judged = [(judge.least_difference(candidate.experiment), candidate)
              for candidate in candidates(reach_of(diagnosis))]
    difference, best = max(judged, key=lambda pair: pair[0].strength)
    pairs = '; '.join(f'{effect.name} from {" and ".join(effect.indistinguishable_from)}'
                      for effect in diagnosis.effects if effect.indistinguishable_from)
    noise = diagnosis.ports[0].force_noise
    return Proposal(_sentence(pairs, best, difference, len(judged), noise), best.repeated())


def _sentence(
    pairs: str, best: Candidate, difference: Difference, tried: int, force_noise: float
) -> str:
    size = (f'{_short(difference.force * force_noise)} N in force ({_short(difference.force)} '
            f'times the noise of a sample) and {_short(difference.motion)} times the noise in '
            'motion')
    if difference.strength < THRESHOLD:
        return (
            f'Within what this recording reached it is hard to tell {pairs}. Of {tried} '
            f'experiments the best is to {best.words}: whatever the values, the predictions then '
            f'differ by up to {size}. Deeper or faster than here would tell more.'
        )
    return (f'To tell {pairs}, {best.words}: whatever the values, their predictions then differ '
            f'by up to {size}.')


def _short(value: float) -> str:
    """Write two digits, but none of a power of ten."""
    return f'{value:.0f}' if value >= 10.0 else f'{value:.2g}'


class Judge:
    """
    Tells by how much rivals would differ from the corrected model in an experiment.

    Parameters
    ----------
    diagnosis : Diagnosis
        With rivals.

    """

    def __init__(self, diagnosis: Diagnosis) -> None:
        self._model, self._rivals = diagnosis.corrected, dict(diagnosis.rivals)
        self._port = diagnosis.ports[0]
        self._known: Mapping[str, Array] = {
            name: _sensitivities(diagnosis.ports, rival) for name, rival in self._rivals.items()
        }

    def least_difference(self, experiment: Experiment) -> Difference:
        """
        Simulate an experiment and compare.

        Parameters
        ----------
        experiment : Experiment
            A candidate.

        Returns
        -------
        difference : Difference
            From the rival that is nearest.

        """
        port = self._played(experiment)
        doubt(port, self._model)
        true = port.residuals(self._model, robust=False)
        differences = (self._difference(port, true, name) for name in self._rivals)
        return min(differences, key=lambda difference: difference.strength)

    def _difference(self, port: Ports, true: Array, name: str) -> Difference:
        rival, known = self._rivals[name], self._known[name]
        off = port.residuals(rival, robust=False) - true
        new = _sensitivities([port], rival)
        target = np.concatenate((np.zeros(len(known)), -off))
        change = np.linalg.lstsq(np.concatenate((known, new)), target, rcond=1e-10)[0]
        parts = port.split(off + new @ change)
        strength = float(np.sum(parts**2)) / port.count
        if not isfinite(strength):
            return Difference(0.0, 0.0, 0.0)
        peaks = np.max(np.abs(parts), axis=1) / sqrt(port.block)
        return Difference(strength, float(peaks[0]), float(peaks[1]))

    def _played(self, experiment: Experiment) -> Ports:
        """Play an experiment with the corrected model, free of noise."""
        o, h = self._port.observed, self._port.observed.h
        t: Array = h * np.arange(round(experiment.duration / h), dtype=np.float64)
        wanted = [experiment.desired(now) for now in t.tolist()]
        reference = np.array([(*desired[:3], 0.0) for desired in wanted]).T
        parameters = dataclasses.replace(
            plant_of(self._model), sample_rate=1.0 / h,
            integration_rate=max(_INTEGRATION_RATE, 1.0 / h),
        )
        truths = simulate_on(parameters, t, reference, float(reference[0, 0]))
        _, x, v, a, _, force = np.array(truths, np.float64).T
        observed = Observed(t, h, force, np.ones(len(t), bool), x, x, v, a, reference,
                            o.position_noise, o.cutoff)
        return Ports(observed, self._port.force_noise, self._port.motion_noise,
                     usable(self._model, observed), default_block(observed))


def _sensitivities(ports: Sequence[Ports], model: Model) -> Array:
    """Differentiate the residuals by the relative change of each free value."""
    function = residual_function(ports, model, robust=False)
    values = model.coordinates
    return differentiate_by(values, model.steps, function, function(values))
