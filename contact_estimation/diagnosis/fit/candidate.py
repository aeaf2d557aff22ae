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

"""Candidates for the next effect, fitted to the end and tested on parts left out."""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .fitting import Fit, fit_to_end
from .invariance import left_out_errors
from .parts import Part
from .search import is_credible, is_curve
from ..observe.model import names_of
from ..observe.prepared_recording import Recordings

Array = NDArray[np.float64]

_LEFT_OUT = 1.0 - np.exp(-1.0)  # weight of the errors on parts left out


class Candidate(NamedTuple):
    """
    A fitted candidate for the next effect.

    Attributes
    ----------
    found : Fit
        The present model with the candidate as its last effect.
    errors : ndarray, shape (parts, CHANNELS)
        On parts left out.
    fitted : ndarray, shape (parts, CHANNELS)
        On the same parts, of the fit on all of them.
    channel : int or None
        The channel by which the candidate is judged; None for all.
    flexible : bool
        Whether it is a curve that follows any slow misfit.

    """

    found: Fit
    errors: Array
    fitted: Array
    channel: int | None
    flexible: bool

    @property
    def name(self) -> str:
        """Return the name of the candidate."""
        return self.found.model.effects[-1]

    @property
    def total(self) -> float:
        """Return the sum of its errors."""
        return float(self.errors.sum())

    @property
    def expected(self) -> float:
        """
        Return the error to expect on further data, by which candidates are compared.

        A few parts left out tell it with a large variance, the fit itself too low: their weighted
        mean, the .632 estimate (Efron 1983, Journal of the American Statistical Association 78),
        errs least.
        """
        return _LEFT_OUT * self.total + (1.0 - _LEFT_OUT) * float(self.fitted.sum())

    @property
    def size(self) -> int:
        """Return the number of its parameters."""
        return len(names_of(self.name))


def assess(
    recordings: Recordings, found: Sequence[Fit], parts: Sequence[Part], before: Array,
    channel: int | None,
) -> list[Candidate]:
    """
    Fit candidates to the end and let them predict parts left out.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    found : sequence of Fit
        Candidates.
    parts : sequence of Part
        Left out in turn.
    before : ndarray, shape (parts, CHANNELS)
        Errors of the present model.
    channel : int or None
        By which they are judged.

    Returns
    -------
    candidates : list of Candidate
        The plausible ones.

    """
    fits = [fit_to_end(recordings, one._replace(ended=False)) for one in found]
    return [Candidate(one, left_out_errors(recordings, one, parts, before),
                      fitted_errors(one, parts), channel, is_curve(recordings, one))
            for one in fits if is_credible(recordings, one.model)]


def fitted_errors(found: Fit, parts: Sequence[Part]) -> Array:
    """
    Return the errors of a fit on the parts of its recordings.

    Parameters
    ----------
    found : Fit
        To them.
    parts : sequence of Part
        Of the recordings.

    Returns
    -------
    squares : ndarray, shape (parts, CHANNELS)
        Sum of the squared residuals.

    """
    return np.array([part.squares(found.residuals) for part in parts])
