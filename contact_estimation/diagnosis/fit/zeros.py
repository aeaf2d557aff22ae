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
The zeros of force sensor and surface, which no rig has exactly: a law must explain more.

A bias of the sensor pushes the robot of a model to and fro; scales of its impedance, a drift or a
friction then fit what the bias leaves. Every candidate is therefore tested beside the zeros as
well. The zeros themselves are named only if they are a fair share of the misfit.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .candidate import Candidate, fitted_errors
from .criteria import is_sure_of_little, predicts_enough, SHARE
from .discrepancy import material, weighed
from .first_step import fit_without
from .fitting import Fit, fit, fit_to_end
from .invariance import left_out_errors
from .order import ZEROS
from .parts import Part
from .share import Share, share_of
from ..observe.model import Model
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]


class Zeros(NamedTuple):
    """
    The zeros of sensor and surface beside a model.

    Attributes
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    parts : sequence of Part
        Left out in turn.
    names : tuple of str
        Zeros that the present model does not have.
    errors : ndarray, shape (parts, CHANNELS)
        On parts left out, of the present model with these zeros.
    whole : ndarray, shape (parts, CHANNELS)
        The same of the recalibrated model with these zeros.
    material : frozenset of int
        Channels in which the present model with these zeros lacks more than a trifle.

    """

    recordings: Recordings
    parts: Sequence[Part]
    names: tuple[str, ...]
    errors: Array
    whole: Array
    material: frozenset[int]

    @classmethod
    def of(
        cls, recordings: Recordings, present: Fit, level: Fit, parts: Sequence[Part],
        before: Array, whole: Array,
    ) -> 'Zeros':
        """
        Fit the zeros beside the present model.

        Parameters
        ----------
        recordings : sequence of PreparedRecording
            With a discrepancy.
        present : Fit
            The model that a further effect is searched for.
        level : Fit
            The recalibrated model with the zeros of that one, see `without_laws`.
        parts : sequence of Part
            Left out in turn.
        before, whole : ndarray, shape (parts, CHANNELS)
            Errors of the present and of the recalibrated model.

        Returns
        -------
        zeros : Zeros
            Without names if the present model has them all.

        """
        names = zeros_lacking(present.model)
        if not names:
            large = frozenset(material(recordings, present.model))
            return cls(recordings, parts, (), before, whole, large)
        found = fit(recordings, beside(present.model, names))
        errors = left_out_errors(recordings, found, parts, before)
        if present.model.effects:
            bare = fit(recordings, beside(level.model, names))
            whole = left_out_errors(recordings, bare, parts, whole)
        else:
            whole = errors
        large = frozenset(material(weighed(recordings, found.model), found.model))
        return cls(recordings, parts, names, errors, whole, large)

    def beside(self, one: Candidate) -> Candidate | None:
        """
        Test a candidate beside the zeros.

        Parameters
        ----------
        one : Candidate
            Which predicts enough without them.

        Returns
        -------
        candidate : Candidate or None
            With the zeros that it needs; None if it predicts too little beside them, or if it
            is a curve in a channel of which they leave a trifle, or no sure law of it.

        """
        little = one.channel is not None and one.channel not in self.material
        if little and one.flexible:
            return None
        made, of_present = self._beside_all(one)
        if little and not is_sure_of_little(of_present):
            return None
        names = self._others(one)
        values = one.found.model.values[one.found.model.place(one.name)]
        of_whole = share_of(self.errors, made.errors, self.parts, self.whole)
        if not made.found.model.plausible() or not predicts_enough(of_present, of_whole):
            return None
        for name in names:
            without = self._made(one, tuple(other for other in names if other != name), values)
            share = share_of(without.errors, made.errors, self.parts, without.errors)
            if share.share < SHARE or share.interval[0] <= 0.0:
                made, names = without, tuple(other for other in names if other != name)
        return made

    def share_beside(self, one: Candidate) -> Share:
        """
        Return the share of what the zeros leave that a candidate takes away beside them.

        Parameters
        ----------
        one : Candidate
            Without the zeros.

        Returns
        -------
        share : Share
            In the channel by which it is judged.

        """
        return self._beside_all(one)[1]

    def _beside_all(self, one: Candidate) -> tuple[Candidate, Share]:
        """Test a candidate beside all zeros but those of its own family."""
        values = one.found.model.values[one.found.model.place(one.name)]
        made = self._made(one, self._others(one), values)
        return made, share_of(self.errors, made.errors, self.parts, self.errors, one.channel)

    def _others(self, one: Candidate) -> tuple[str, ...]:
        family = EFFECTS[one.name].family
        return tuple(name for name in self.names if EFFECTS[name].family != family)

    def _made(
        self, one: Candidate, names: tuple[str, ...], values: tuple[float, ...]
    ) -> Candidate:
        if not names:
            return one
        present = one.found.model.without(one.name)
        model = beside(present, names).with_effect(one.name, values)
        found = fit_to_end(self.recordings, fit(self.recordings, model))
        errors = left_out_errors(self.recordings, found, self.parts, self.errors)
        return one._replace(found=found, errors=errors, fitted=fitted_errors(found, self.parts))


def zeros_lacking(model: Model) -> tuple[str, ...]:
    """
    List the zeros that a model lacks.

    Parameters
    ----------
    model : Model
        With effects or without.

    Returns
    -------
    names : tuple of str
        Of `ZEROS`; the surface of an attached wall has none of its own.

    """
    unilateral = model.nominal.environment.unilateral
    return tuple(name for name in ZEROS if name not in (*model.effects, *model.excluded)
                 and (unilateral or name == 'force_bias'))


def beside(model: Model, zeros: Sequence[str]) -> Model:
    """Return a model with further zeros, still 0."""
    for name in zeros:
        model = model.with_effect(name, (0.0,))
    return model


def without_laws(recordings: Recordings, present: Model) -> Fit:
    """
    Fit a model with its zeros alone: what is large beside them is no trifle.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    present : Model
        With named zeros and laws.

    Returns
    -------
    found : Fit
        Of the recalibrated model with these zeros.

    """
    return fit_without(recordings, present, [name for name in present.effects
                                             if not is_zero(name)])


def is_zero(name: str) -> bool:
    """Return whether an effect is a constant or slow zero, of the sensor or of the surface."""
    of_sensor = EFFECTS[name].family == 'sensor_zero' and EFFECTS[name].port == 'force_sensor'
    return name == 'contact_offset' or of_sensor


def resembles_zero(name: str) -> bool:
    """Return whether an effect is a zero, or of the family of one."""
    return is_zero(name) or EFFECTS[name].family == 'clearance'
