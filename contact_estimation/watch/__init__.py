# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""One view of a contact: live beside any estimator, or of a recording."""
