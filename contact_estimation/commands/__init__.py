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
The commands: parse options, call the library, print and write the result.

They run the linear algebra on one thread unless OMP_NUM_THREADS says otherwise, which numpy reads
when it is imported. The matrices are small: a second thread only waits, and beside other work it
made a diagnosis six times as slow. The library sets nothing: its user chooses.
"""

import os

os.environ.setdefault('OMP_NUM_THREADS', '1')
