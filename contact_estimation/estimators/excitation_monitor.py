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

"""Excitation: how precisely the last window of data determines each parameter."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

from .estimate import Frozen
from .row_sums import RowSums
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class ExcitationParameters(ParameterGroup):
    """When a parameter is frozen for lack of excitation."""

    window_s: float = parameter(
        1.0, 'Length of the window over which excitation is evaluated', 's',
        minimum=0.01, maximum=100.0,
    )
    maximum_relative_std: float = parameter(
        0.2,
        'A parameter is frozen while its predicted relative standard deviation is above this; '
        'large: never frozen',
        minimum=1e-4,
    )


class ExcitationMonitor:
    """
    Predict the standard deviations that the window permits: eq. (27) made quantitative.

    sigma_F^2 (sum phi phi^T)^-1 is the Cramer-Rao bound of K_e and B_e over the window. Where it
    exceeds a share of the estimate, noise would dominate an update, and the parameter is frozen.
    Where the location is estimated too, it is marginalised out.

    Parameters
    ----------
    parameters : ExcitationParameters
        Window and limit.
    sample_period_s : float
        Nominal T [s].

    Attributes
    ----------
    sums : RowSums
        Of the rows of the window.
    frozen : Frozen
        The last judgement.
    stiffness_std, damping_std : float
        Predicted standard deviations [N/m], [N s/m].

    """

    def __init__(self, parameters: ExcitationParameters, sample_period_s: float) -> None:
        self._T, self._rows = sample_period_s, 0
        self.configure(parameters)

    def configure(self, parameters: ExcitationParameters) -> None:
        """
        Set a new window and limit; the rows collected stay unless the window changes.

        Parameters
        ----------
        parameters : ExcitationParameters
            Window and limit.

        """
        rows = round(parameters.window_s / self._T)
        if rows != self._rows:
            self._rows = rows
            self.reset()
        self._limit = parameters.maximum_relative_std

    def reset(self) -> None:
        """Discard all rows."""
        self.sums = RowSums(self._rows)
        self.frozen = Frozen(True, True)
        self.stiffness_std = self.damping_std = inf

    def judge(
        self,
        noise_variance: float,
        stiffness: float,
        damping: float,
        location_std: float | None,
    ) -> None:
        """
        Judge the excitation of the window; sets `frozen` and the predicted standard deviations.

        Parameters
        ----------
        noise_variance : float
            Of the unfiltered equation [N^2]; the filter passes the band in which phi lives
            unchanged, so the bound is that of the raw samples.
        stiffness, damping : float
            The scales to compare with, > 0: the estimates with lower bounds.
        location_std : float or None
            Prior standard deviation of x_e [m] where x_e is estimated too, else None.

        """
        (_, Ky, By, cy, _), (_, KK, KB, Kc, _), (_, _, BB, Bc, _), (*_, cc, _), _ = (
            self.sums.window().products.tolist()
        )
        limit_K = self._limit * max(stiffness, Ky / KK if KK > 0.0 else 0.0)
        if location_std is not None:
            # Marginalise the location out (Schur complement), with its prior as information.
            cc += noise_variance / max((stiffness * location_std) ** 2, 1e-30)
            KK -= Kc * Kc / cc
            KB -= Kc * Bc / cc
            BB -= Bc * Bc / cc
            Ky -= Kc * cy / cc
            By -= Bc * cy / cc
        # The fit over the window counts as well, as does its secant stiffness: with an initial
        # value far too soft, a stiff and damped wall would otherwise appear unexcited.
        determinant = KK * BB - KB * KB
        fitted_B = (KK * By - KB * Ky) / determinant if determinant > 1e-12 * KK * BB else 0.0
        limit_B = self._limit * max(damping, fitted_B)
        both_K, both_B = _std(noise_variance, KK, KB, BB), _std(noise_variance, BB, KB, KK)
        alone_K, alone_B = _std(noise_variance, KK, 0.0, 1.0), _std(noise_variance, BB, 0.0, 1.0)
        self.stiffness_std, self.damping_std = both_K, both_B
        if both_K <= limit_K and both_B <= limit_B:
            self.frozen = Frozen(False, False)
        elif alone_K <= limit_K:
            self.frozen = Frozen(False, True)
            self.stiffness_std = alone_K
        elif alone_B <= limit_B:
            self.frozen = Frozen(True, False)
            self.damping_std = alone_B
        else:
            self.frozen = Frozen(True, True)


def _std(noise_variance: float, own: float, cross: float, other: float) -> float:
    """Return the square root of a diagonal entry of sigma^2 [[own, cross], [cross, other]]^-1."""
    information = own - (cross * cross / other if other > 0.0 else 0.0)
    if information <= 1e-12 * own or own <= 0.0:
        return inf
    return sqrt(noise_variance / information)
