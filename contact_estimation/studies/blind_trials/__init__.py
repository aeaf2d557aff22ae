# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Blind evaluation of `diagnose`: randomised worlds with known ground truth, and scores."""
