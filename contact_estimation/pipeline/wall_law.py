# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The probabilities of the laws of a contact as text, for `~/wall_law` and the diagnostics."""

from __future__ import annotations

from typing import Sequence

from ..estimators.multiple_model import LAWS

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
