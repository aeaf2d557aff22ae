# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a diagnosis says about its names and about what to run next."""

from __future__ import annotations

from typing import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from .result import NamedEffect
from ..compare.evidence import Evidence, Scored
from ..compare.shares import explained

Array = NDArray[np.float64]

_LISTED = 8  # contacts
_FAIR = 0.3  # share of the misfit from which on a model nearly explains it


def nearly(evidence: Evidence, models: Sequence[Scored]) -> str:
    """Say which law nearly explains what no name explains."""
    alone = [(explained(evidence, one), one.effects[-1]) for one in models if one.laws == 1]
    share, effect = max(alone, key=lambda pair: pair[0].share, default=(None, ''))
    if share is None or share.share < _FAIR:
        return ''
    parts = len(share.parts)
    return (f'{effect} would explain {100.0 * share.share:.0f} %, but {parts} parts cannot prove '
            f'it (95 %: {100.0 * share.interval[0]:.0f} to {100.0 * share.interval[1]:.0f} %): '
            'record further contacts at other depths and speeds')


def advice(
    names: Sequence[NamedEffect], rivals: Collection[str], verdict: str, touching: bool
) -> str:
    """Recommend what to run next."""
    pairs = indistinguishable_pairs(names, rivals)
    if pairs:
        return f'To tell {pairs}, run an experiment in which their predictions differ most.'
    if verdict == 'unexplained':
        again = 'contact at half and at twice the speed and depth' if touching else (
            'motion at half and at twice the speed and amplitude')
        return (f'{what_is_explained(names)} Repeat the same {again}: how the residuals scale '
                'shows what is missing.')
    return ''


def diagnose_apart(springs: Array) -> str:
    """Recommend what to run where each contact fits a wall of its own."""
    listed = ', '.join(f'{spring:.4g}' for spring in springs[:_LISTED])
    listed += ' ...' if len(springs) > _LISTED else ''
    return (f'Each contact fits a spring and a damper of its own, with K_e = {listed} N/m. '
            'Diagnose contacts of one object at one place together, and each object or place by '
            'itself.')


def what_is_explained(names: Sequence[NamedEffect]) -> str:
    """Say how far the library explains a mismatch whose verdict is 'unexplained'."""
    if not names:
        return 'No effect of the library explains this.'
    verb = 'explains' if len(names) == 1 else 'explain'
    return f'{" and ".join(effect.name for effect in names)} {verb} only a part of this.'


def listed(names: Sequence[str]) -> str:
    """List names in words."""
    *others, last = names
    return f'{", ".join(others)} and {last}' if others else last


def indistinguishable_pairs(names: Sequence[NamedEffect], rivals: Collection[str]) -> str:
    """List which effects cannot be distinguished from which."""
    pairs = [(effect.name, [other for other in effect.indistinguishable_from if other in rivals])
             for effect in names]
    return '; '.join(f'{name} from {listed(others)}' for name, others in pairs if others)
