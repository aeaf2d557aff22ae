# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Compared models as plain data: what a decision is made of, and may be made again from."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np

from .beam import Compared
from .constants import Constants
from .evidence import Evidence, Scored

_MOST = 60  # models: the others weigh nothing


def as_dict(compared: Compared) -> dict[str, Any]:
    """Return the errors of all likely models on parts left out, ready for JSON."""
    evidence, likely = compared.evidence, compared.models[:_MOST]
    return {
        'instrument': evidence.instrument.tolist(), 'as_force': evidence.as_force.tolist(),
        'white': evidence.white,
        'base': _scored(evidence.base),
        'models': [_scored(one) for one in likely if one is not evidence.base],
    }


def _scored(one: Scored) -> dict[str, Any]:
    return {
        'effects': list(one.effects), 'families': list(one.families), 'rank': one.rank,
        'left_out': one.left_out.tolist(), 'fitted': one.fitted.tolist(),
        'counts': one.counts.tolist(), 'parameters': one.parameters, 'laws': one.laws,
        'curves': one.curves,
    }


def of_dict(data: Mapping[str, Any], constants: Constants) -> Compared:
    """Return compared models, as they are with certain constants."""
    base, *others = (
        Scored(tuple(one['effects']), tuple(one['families']), tuple(one['rank']),
               np.array(one['left_out']), np.array(one['fitted']), np.array(one['counts']),
               one['parameters'], one['laws'], one['curves'])
        for one in (data['base'], *data['models']))
    evidence = Evidence(base, np.array(data['instrument']), np.array(data['as_force']), constants,
                        white=data['white'])
    evidence = evidence.informed_by([base, *others])
    return Compared(evidence, evidence.ranked([base, *others]))
