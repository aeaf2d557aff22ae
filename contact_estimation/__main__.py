# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`python -m contact_estimation NAME ...` runs an executable, also one that is not on PATH."""

import sys

from . import executables

if __name__ == '__main__':
    name, known = ''.join(sys.argv[1:2]), [*executables.NODES, *executables.COMMANDS]
    if name not in known:
        print(f'expected one of {", ".join(known)}, got {name!r}', file=sys.stderr)
        raise SystemExit(1)
    del sys.argv[1]
    raise SystemExit(getattr(executables, name)())
