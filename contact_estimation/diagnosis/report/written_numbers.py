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

"""Numbers in HTML, with as many digits as their uncertainty leaves them."""

from __future__ import annotations

from math import floor, isfinite, log10


def with_std(value: float, std: float) -> str:
    """
    Write a value with its standard deviation, the latter with two digits.

    Parameters
    ----------
    value, std : float
        Any unit; a standard deviation that is not finite or 0 is left out.

    Returns
    -------
    html : str
        Such as '3.868 &plusmn; 0.053' or '(-7.202 &plusmn; 0.016) &times; 10<sup>6</sup>'.

    """
    if not (isfinite(value) and isfinite(std) and std > 0.0):
        return plain(value)
    power = _power(max(abs(value), std))
    value, std = value / 10.0**power, std / 10.0**power
    digits = max(0, 1 - floor(log10(std)))
    text = f'{value:.{digits}f} &plusmn; {std:.{digits}f}'
    return f'({text}){_times(power)}' if power else text


def plain(value: float) -> str:
    """
    Write a value with five digits.

    Parameters
    ----------
    value : float
        Any unit.

    Returns
    -------
    html : str
        '&ndash;' where it is not finite.

    """
    if not isfinite(value):
        return '&ndash;'
    power = _power(abs(value))
    return f'{value / 10.0**power:.5g}{_times(power)}'


def _power(size: float) -> int:
    """Give the power of ten to be split off; 0 for what is read easily without."""
    if size == 0.0 or 1e-3 <= size < 1e5:
        return 0
    return floor(log10(size))


def _times(power: int) -> str:
    return f' &times; 10<sup>{power}</sup>' if power else ''
