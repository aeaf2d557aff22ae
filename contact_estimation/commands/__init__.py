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
The executables that need no ROS.

Their matrices are small: a second thread of the linear algebra only waits, and beside other work
that made a diagnosis six times as slow. The variable is read when numpy is first imported, after
this; who sets it decides.
"""

import os

os.environ.setdefault('OMP_NUM_THREADS', '1')
