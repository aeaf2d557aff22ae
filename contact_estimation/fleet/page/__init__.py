# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The sections of the fleet's page: each module prepares the data of the template of its name."""
