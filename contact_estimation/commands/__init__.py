# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The commands: parse options, call the library, print and write the result.

They run the linear algebra on one thread unless OMP_NUM_THREADS says otherwise, which numpy reads
when it is imported. The matrices are small: a second thread only waits, and beside other work it
made a diagnosis six times as slow. The library sets nothing: its user chooses.
"""

import os

os.environ.setdefault('OMP_NUM_THREADS', '1')
