# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The library on arms simulated in MuJoCo: tool, stiffness, damping, node and diagnosis."""
