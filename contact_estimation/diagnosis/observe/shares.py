# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Shares of a range, of a duration or of what is expected: one scale, in steps of two to five.

Preparation and checks of a recording ask for no more: what they find differs from what is right
by factors. Those that decide on names are in `fit/constants.json`.
"""

SLIGHT, LITTLE, MUCH, MOST = 0.02, 0.1, 0.25, 0.5
