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


"""Numbers in HTML, rounded to what their uncertainty justifies."""

from __future__ import annotations

from math import floor, isfinite, log10

from markupsafe import Markup

DASH = Markup('&ndash;')


def with_std(value: float, std: float) -> Markup:
    """
    Format a value with its standard deviation, the latter to two digits.

    Parameters
    ----------
    value, std : float
        Any unit; a standard deviation that is 0 or not finite is left out.

    Returns
    -------
    html : Markup
        Such as '3.868 &plusmn; 0.053' or '(-7.202 &plusmn; 0.016) &times; 10<sup>6</sup>'.

    """
    if not (isfinite(value) and isfinite(std) and std > 0.0):
        return plain(value)
    power = _power(max(abs(value), std))
    value, std = value / 10.0**power, std / 10.0**power
    digits = max(0, 1 - floor(log10(std)))
    text = f'{value:.{digits}f} &plusmn; {std:.{digits}f}'
    return Markup(f'({text}){_times(power)}' if power else text)


def plain(value: float | None, digits: int = 5) -> Markup:
    """
    Format a value to a number of significant digits.

    Parameters
    ----------
    value : float or None
        Any unit.
    digits : int
        Significant digits.

    Returns
    -------
    html : Markup
        A dash for None and for a value that is not finite.

    """
    if value is None or not isfinite(value):
        return DASH
    power = _power(abs(value))
    return Markup(f'{value / 10.0**power:.{digits}g}{_times(power)}')


def _power(size: float) -> int:
    """Return the power of ten to split off; 0 for a number that is readable without."""
    if size == 0.0 or 1e-3 <= size < 1e5:
        return 0
    return floor(log10(size))


def _times(power: int) -> str:
    return f' &times; 10<sup>{power}</sup>' if power else ''
