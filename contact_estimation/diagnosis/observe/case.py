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

"""A recording as it goes through the diagnosis: its signals, its ports, what is held out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

from .episodes import HeldOut, hold_out, require_contact
from .model import Model
from .noise import force_noise, motion_noise
from .observed import observe, Observed, Signals
from .ports import Ports
from .usable_samples import default_block, force_drops, usable


@dataclass(frozen=True)
class Recording:
    """
    A recording to be diagnosed.

    Attributes
    ----------
    name : str
        For texts.
    signals : Signals
        What it holds.

    """

    name: str
    signals: Signals


class Case(NamedTuple):
    """
    A recording under diagnosis.

    Attributes
    ----------
    recording : Recording
        As it came.
    port : Ports
        What models leave of it, on the part that is fitted.
    held_out : HeldOut or None
        What no fit may see; None holds nothing out.

    """

    recording: Recording
    port: Ports
    held_out: HeldOut | None

    @classmethod
    def prepare(cls, recording: Recording, model: Model, hold: bool) -> 'Case':
        """
        Smooth a recording, measure its noise, hold a part out.

        Parameters
        ----------
        recording : Recording
            As it came.
        model : Model
            Nominal.
        hold : bool
            Whether a part is to be held out.

        Returns
        -------
        case : Case
            Ready to be fitted.

        Raises
        ------
        RecordingError
            If it has too little data, no contact or a constant signal.

        """
        observed = observe(recording.signals, model.nominal)
        require_contact(model, observed, recording.name)
        return cls.of(recording, observed, model, hold_out(model, observed) if hold else None)

    @classmethod
    def of(
        cls, recording: Recording, observed: Observed, model: Model, held: HeldOut | None
    ) -> 'Case':
        """Take a recording as it is smoothed."""
        use = usable(model, observed)
        if held is not None:
            use = use & ~held.samples
        noise = force_noise(model, observed)
        dropped = force_drops(observed, noise) if model.nominal.environment.unilateral else None
        port = Ports(observed, noise, motion_noise(model, observed, noise), use,
                     default_block(observed), dropped)
        return cls(recording, port, held)

    def with_force(self, between: str, model: Model) -> 'Case':
        """Let the force that drives a wall go on between its samples in another way."""
        port = self.port
        observed = replace(port.observed, between=between)
        noise = motion_noise(model, observed, port.force_noise)
        return self._replace(port=replace(port, observed=observed, motion_noise=noise))

    def whole(self, model: Model) -> Ports:
        """Take the held-out part back in."""
        return replace(self.port, use=usable(model, self.port.observed))
