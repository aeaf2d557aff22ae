# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rerun, an optional package, imported when it is needed."""

from __future__ import annotations

from typing import Any

from ..exceptions import MissingPackageError


def require_rerun() -> Any:
    """Import Rerun."""
    try:
        import rerun
        import rerun.blueprint
    except ImportError as error:
        raise MissingPackageError.of('rerun-sdk', 'the live view') from error
    return rerun
