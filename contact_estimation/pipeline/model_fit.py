# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Whether any law of the contact fits, as `~/model_fit` and the diagnostics tell it."""

from __future__ import annotations

from math import nan
from typing import NamedTuple

_NOTABLE = 2.0  # residual rms over what noise and the usual error of a model explain


class Fit(NamedTuple):
    """One judgement."""

    ratio: float  # rms of the residual over that of noise and model error; NaN before any
    text: str  # what is wrong; '' where a law fits
    stamp_ns: int  # when it was judged [ns]


NO_FIT = Fit(nan, '', 0)


class ModelFitMonitor:
    """
    The fit now and at its worst.

    now, worst: of the last 2 s of contact, and the largest that was notable
    count: how often a law began not to fit
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget all judgements."""
        self.now, self.worst, self.count = NO_FIT, NO_FIT, 0

    def note(self, ratio: float, law: str, stamp_ns: int) -> None:
        """
        Judge a ratio.

        stamp_ns: of the sample [ns]
        """
        text = ''
        if ratio > _NOTABLE:
            text = (f'residuals are {ratio:.2g} times the noise under the best law ({law}): none '
                    'of the laws fits; record a contact and diagnose it')
            if not self.now.text:
                self.count += 1
        self.now = Fit(ratio, text, stamp_ns)
        if text and not ratio < self.worst.ratio:
            self.worst = self.now
