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

"""
On-line checks of what an estimator is given, with cause and remedy; the same in node and replay.

A check of `CHECKS` looks at the last seconds of one axis, `REJECTIONS` at the counts of rejected
messages. Both stand in the order of importance: the first active one is the headline.

"""

from .check import Check, Evidence, Forces, Warned
from .input_checks import CHECKS, InputChecks
from .rejections import lag_in_words, Rejection, REJECTIONS, Rejections

__all__ = [
    'Check', 'CHECKS', 'Evidence', 'Forces', 'InputChecks', 'lag_in_words', 'Rejection',
    'REJECTIONS', 'Rejections', 'Warned',
]
