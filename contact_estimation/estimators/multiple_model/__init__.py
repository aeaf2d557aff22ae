# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""One recursive posterior of a contact: whether there is one, K_e, B_e, the surface, the law."""

from .contact import CONTACT, FREE, NEITHER
from .knowledge import Knowledge
from .laws import NAMES as LAWS
from .posterior import WallPosterior
from .slow_states import lag_prior

__all__ = [
    'CONTACT',
    'FREE',
    'Knowledge',
    'LAWS',
    'NEITHER',
    'lag_prior',
    'WallPosterior',
]
