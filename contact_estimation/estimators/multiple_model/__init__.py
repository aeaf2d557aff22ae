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

"""One recursive posterior of a contact: whether there is one, K_e, B_e, the surface, the law."""

from .contact import CONTACT, FREE, NEITHER
from .knowledge import Knowledge
from .lag import told_lag
from .laws import NAMES as LAWS
from .posterior import WallPosterior

__all__ = [
    'CONTACT',
    'FREE',
    'Knowledge',
    'LAWS',
    'NEITHER',
    'told_lag',
    'WallPosterior',
]
