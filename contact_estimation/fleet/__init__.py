# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Archives of recordings: every one replayed and diagnosed, as one table and one page."""
