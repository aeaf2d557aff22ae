# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`python -m contact_estimation`: the demonstration, see `commands/demonstrate.py`."""

from .executables import demonstrate

if __name__ == '__main__':
    raise SystemExit(demonstrate())
