# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The paper's tables and figures: its simulation (section 4) and its experiment (section 5).

`cases` run on the simulated plant, or on a virtual testbed (`testbed_*`) that takes the place of
the paper's robot and wall; `table` and `figures` run them.
`three_contacts*` demonstrate eq. (6), which the paper derives for several contact points.
"""
