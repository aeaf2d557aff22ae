# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Rerun, an optional package, imported when it is needed."""

from __future__ import annotations

from typing import Any

from ..exceptions import MissingPackageError


def require_rerun() -> Any:
    """
    Import Rerun.

    Returns
    -------
    rerun : module
        With its submodule `blueprint`.

    Raises
    ------
    MissingPackageError
        If it is not installed.

    """
    try:
        import rerun
        import rerun.blueprint
    except ImportError as error:
        raise MissingPackageError.of('rerun-sdk', 'the live view') from error
    return rerun
