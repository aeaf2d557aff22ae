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

"""What a check is, and the evidence from which it decides."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from math import sqrt
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .robust_statistics import loaded_correlation, median_of, spread_of
from ..parameters import EstimationParameters

Array = NDArray[np.float64]

CLEAR = 8.0
"""Spread of a force, in standard deviations of its noise, that is clearly no noise."""

_MEDIAN = 0.6745  # of the size of a normal variable of variance 1
_BELOW_95_PERCENT = 0.759  # mean of the lower 95 % of its squares
_NOTHING = np.zeros(0)


def millimetres(metres: float) -> str:
    """Return a length for a text, such as 9.9 mm, 400 mm or 2100 mm."""
    length = 1e3 * metres
    return f'{length:.0f} mm' if abs(length) >= 100.0 else f'{length:.3g} mm'


class Warned(NamedTuple):
    """
    An active warning.

    Attributes
    ----------
    name : str
        Of the check.
    axis : str
        'x', 'y' or 'z'; '' where the warning concerns all.
    text : str
        What is wrong and what to do.
    invalidates : bool
        Whether estimates are withheld because of it.

    """

    name: str
    axis: str
    text: str
    invalidates: bool


class Forces(NamedTuple):
    """
    One component of the wrench that no axis estimates.

    Attributes
    ----------
    axis : str
        Its name.
    force : ndarray, shape (M,)
        Force [N].
    x : ndarray, shape (M,)
        Position of the contact axis at the same time [m].

    """

    axis: str
    force: Array
    x: Array


@dataclass(frozen=True)
class Evidence:
    """
    The last seconds of one axis.

    Attributes
    ----------
    axis : str
        Its name.
    parameters : EstimationParameters
        All parameters.
    pipeline : EstimationPipeline
        State of the axis, read only.
    t, x, v, force : ndarray, shape (N,)
        Time [s], position [m], rate [m/s] (NaN where not measured) and F_e less the bias [N].
    contact : ndarray of bool, shape (N,)
        Whether contact was detected.
    others : tuple of Forces
        Components of the wrench that are not estimated.
    joint_rate : float
        Rate of the joint states [Hz]; NaN while unknown.
    travel : float
        Range of all positions since the start [m].
    memory : dict
        What a check has computed that another needs.

    """

    axis: str
    parameters: EstimationParameters
    pipeline: Any
    t: Array
    x: Array
    v: Array
    force: Array
    contact: NDArray[np.bool_]
    others: tuple[Forces, ...] = ()
    joint_rate: float = float('nan')
    travel: float = 0.0
    memory: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of_state(
        cls, axis: str, parameters: EstimationParameters, pipeline: Any
    ) -> Evidence:
        """
        Return evidence without samples, for checks of the state of a pipeline.

        Parameters
        ----------
        axis, parameters, pipeline
            As above.

        """
        return cls(axis, parameters, pipeline, _NOTHING, _NOTHING, _NOTHING, _NOTHING,
                   np.zeros(0, dtype=np.bool_))

    @property
    def configured_noise(self) -> float:
        """Return the configured standard deviation of the force [N]."""
        return self.parameters.contact.force_noise

    @cached_property
    def noise(self) -> float:
        """
        White noise of the force, by the differences of its samples, at least as configured [N].

        What the detector learns in free flight may be a contact that it does not recognise.

        """
        if len(self.force) < 2:
            return self.configured_noise
        white = median_of(np.abs(self.force[1:] - self.force[:-1])) / (_MEDIAN * sqrt(2.0))
        return max(self.configured_noise, white)

    @cached_property
    def white_noise(self) -> float:
        """
        White noise of the force, by second differences, in which motion hardly shows [N].

        The largest are left out: an impact is no noise.

        """
        f = self.force
        if len(f) < 3:
            return 0.0
        squares = np.square(f[2:] - 2.0 * f[1:-1] + f[:-2])
        most = max(1, int(0.95 * len(squares)))
        lower = np.partition(squares, most - 1)[:most]
        return sqrt(float(np.mean(lower)) / (6.0 * _BELOW_95_PERCENT))

    @cached_property
    def period(self) -> float:
        """Usual time between samples [s]."""
        return median_of(self.t[1:] - self.t[:-1])

    @cached_property
    def rate(self) -> Array:
        """Rate of x, measured or by differences [m/s]."""
        if np.isfinite(self.v).all():
            return self.v
        return np.asarray(np.gradient(self.x, self.t))

    @cached_property
    def spread(self) -> float:
        """Range of the force without its extremes [N]."""
        return spread_of(self.force)

    @cached_property
    def slope_sign(self) -> float:
        """Correlation of force and position where there is a force."""
        return loaded_correlation(self.x, self.force, self.noise)


class Check(ABC):
    """
    One thing that is commonly wrong with the inputs.

    Stateless: all memory is in the evidence.

    Attributes
    ----------
    name : str
        In diagnostics, summaries and the documentation.
    message, cause, remedy : str
        For the table of warnings: the text with typical numbers, what it comes from, what to do.
    invalidates : bool
        Whether estimates are withheld while the warning is active.
    of_state : bool
        Whether the state of the pipeline alone decides, at any time.
    confirmations : int
        Judgements in a row that find it before it is reported.

    """

    name: ClassVar[str]
    message: ClassVar[str]
    cause: ClassVar[str]
    remedy: ClassVar[str]
    invalidates: ClassVar[bool] = False
    of_state: ClassVar[bool] = False
    confirmations: ClassVar[int] = 1

    @abstractmethod
    def judge(self, seen: Evidence) -> str | None:
        """
        Return the text of the warning.

        Parameters
        ----------
        seen : Evidence
            Of one axis.

        Returns
        -------
        text : str or None
            '' where all is well, None where the evidence does not tell: the last text stays.

        """
