# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The header of this package's files, for `ament_copyright`.

`ament_copyright` of Jazzy knows no SPDX identifiers; further headers are registered as entry
points of the group ``ament_copyright.license`` (see setup.py).

"""

from typing import NamedTuple


class Licence(NamedTuple):
    """What `ament_copyright` reads of a licence, by the names of its `LicenseEntryPoint`."""

    name: str
    spdx: str
    file_headers: list[str]
    license_files: list[str]
    contributing_files: list[str]


APACHE_2_SPDX = Licence(
    'Apache License, Version 2.0 (SPDX)', 'Apache-2.0',
    ['{copyright}\n' 'SPDX-License-Identifier: Apache-2.0\n'], [], [],
)
