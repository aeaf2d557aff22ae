# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Values of parameters as texts of errors, help and comments show them: as in YAML, but short."""

from __future__ import annotations

import math
import re

Value = bool | int | float | str | tuple[float, ...]

_LARGE = 1e6  # from here on zeros are tedious to count


def number_text(number: float) -> str:
    """Return a number to six digits, its exponent as people write it: 1e6, not 1e+06."""
    return re.sub(r'e([+-])0*', lambda found: 'e' + found[1].strip('+'), f'{number:g}')


def value_text(value: Value) -> str:
    """Return the value of a parameter: true, [0.0, 0.0, 0.0], 1e10, NaN."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return '[' + ', '.join(value_text(element) for element in value) + ']'
    if isinstance(value, float):
        if math.isnan(value):
            return 'NaN'
        short = number_text(value)
        if (abs(value) >= _LARGE or 'e' in repr(value)) and float(short) == value:
            return short
    return repr(value)
