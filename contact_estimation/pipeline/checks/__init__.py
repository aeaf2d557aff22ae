# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
On-line checks of what an estimator is given, with cause and remedy; the same in node and replay.

A check of `CHECKS` looks at the last seconds of one axis, `REJECTIONS` at the counts of rejected
messages. Both stand in the order of importance: the first active one is the headline.

"""

from .check import Check, Forces, Warned, Window
from .input_checks import CHECKS, InputChecks
from .rejections import lag_in_words, Rejection, REJECTIONS, Rejections

__all__ = [
    'Check', 'CHECKS', 'Forces', 'InputChecks', 'lag_in_words', 'Rejection', 'Window',
    'REJECTIONS', 'Rejections', 'Warned',
]
