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

"""The plant on a given reference, without an estimator."""

from __future__ import annotations

from .plant_parameters import PlantParameters
from .sensors import Sensors
from .world import ReferenceAt, Truth, World
from ..signals.contact_recording import ContactRecording
from ..signals.contact_sample import ContactSample


def run_open_loop(
    plant: PlantParameters, reference: ReferenceAt, start: float, duration: float
) -> tuple[list[Truth], ContactRecording]:
    """
    Simulate.

    Parameters
    ----------
    plant : PlantParameters
        The world.
    reference : callable
        Time [s] to (x_r, its rate, its acceleration, F_r).
    start : float
        Where the robot rests at t = 0 [m].
    duration : float
        Time to run [s].

    Returns
    -------
    truths : list of Truth
        The world, one entry a sample.
    recording : ContactRecording
        What the sensors tell of it.

    """
    period = 1.0 / plant.sample_rate
    world, sensors = World(plant, start), Sensors(plant)
    truths: list[Truth] = []
    samples: list[ContactSample] = []
    for k in range(round(duration * plant.sample_rate)):
        truth = world.truth(reference)
        force, position, velocity = sensors.measure(truth)
        truths.append(truth)
        samples.append(ContactSample(round(1e9 * k * period), position, velocity, force))
        world.advance(period, reference)
    return truths, ContactRecording.of(samples)
