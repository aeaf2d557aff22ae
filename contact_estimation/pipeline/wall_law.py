# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The laws of a contact in words: their probabilities, and whether any of them fits."""

from math import nan
from typing import NamedTuple, Sequence

from ..estimators.multiple_model import Knowledge, LAWS


_NOTABLE_RATIO = 2.0  # residual rms over what noise and the usual error of a model explain


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
        self._noted: Knowledge | None = None

    def note(self, known: Knowledge, stamp_ns: int) -> None:
        """Judge the fit of what is known since a sample in contact, by its stamp [ns]."""
        ratio, text = known.fit, ''
        if known is self._noted or ratio != ratio:
            return
        self._noted = known
        if ratio > _NOTABLE_RATIO:
            text = (f'residuals are {ratio:.2g} times the noise under the best law '
                    f'({LAWS[_leader(known.laws)]}): none of the laws fits; record a contact and '
                    'diagnose it')
            if not self.now.text:
                self.count += 1
        self.now = Fit(ratio, text, stamp_ns)
        if text and not ratio < self.worst.ratio:
            self.worst = self.now


_LEAST = 0.005  # a smaller probability would be printed as 0.00
_NOTABLE = 0.1  # change of a probability that is published


def laws_in_words(probabilities: Sequence[float]) -> str:
    """Return names and probabilities, the most probable first."""
    order = sorted(zip(probabilities, LAWS), key=lambda one: -one[0])
    return ' '.join(f'{name} {p:.2f}' for p, name in order if p >= _LEAST)


class WallLawNews:
    """Tells the laws where another one leads, or a probability has changed by more than 0.1."""

    def __init__(self) -> None:
        self._last: Sequence[float] = ()  # seen
        self._told: Sequence[float] = ()

    def take(self, probabilities: Sequence[float]) -> str:
        """Return what is new."""
        if probabilities is self._last:  # between two blocks of samples, as nearly always
            return ''
        self._last, told = probabilities, self._told
        if told and _leader(told) == _leader(probabilities) and all(
                abs(p - before) <= _NOTABLE for p, before in zip(probabilities, told)):
            return ''
        self._told = probabilities
        return laws_in_words(probabilities)


def _leader(probabilities: Sequence[float]) -> int:
    return max(range(len(probabilities)), key=probabilities.__getitem__)
