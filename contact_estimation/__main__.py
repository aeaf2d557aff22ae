# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`python -m contact_estimation [NAME] ...`: an executable, by default the demonstration."""

import sys

from . import executables

if __name__ == '__main__':
    chosen = 'demonstrate'
    if sys.argv[1:2] and sys.argv[1] in {*executables.NODES, *executables.COMMANDS}:
        chosen = sys.argv.pop(1)
    raise SystemExit(getattr(executables, chosen)())
