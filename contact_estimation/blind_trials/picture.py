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

"""The confusion matrix as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Sequence

import numpy as np

from .scoring import Score
from .totals import confusion
from ..optional_packages import require_matplotlib
from ..physics import EFFECTS

_NOT_NAMES = ('nothing', 'unexplained', 'failed')


def draw_confusion(scores: Sequence[Score], path: Path) -> Path:
    """
    Draw what was said of what.

    Parameters
    ----------
    scores : sequence of Score
        Of a study.
    path : Path
        The PNG file.

    Returns
    -------
    path : Path
        The same.

    """
    pyplot = require_matplotlib()
    counts = confusion(scores)
    rows, columns = [*EFFECTS, 'nothing'], [*EFFECTS, *_NOT_NAMES]
    table = np.array([[counts.get(row, {}).get(column, 0) for column in columns]
                      for row in rows], float)
    shares = table / np.maximum(table.sum(axis=1, keepdims=True), 1.0)
    figure, axis = pyplot.subplots(figsize=(12.0, 11.0), layout='constrained')
    axis.imshow(shares, cmap='Blues', vmin=0.0, vmax=1.0)
    for k, j in zip(*np.nonzero(table)):
        axis.text(j, k, f'{table[k, j]:.0f}', ha='center', va='center', fontsize=8,
                  color='white' if shares[k, j] > 0.5 else '#1f2933')
    axis.set_xticks(range(len(columns)), columns, rotation=90)
    axis.set_yticks(range(len(rows)), rows)
    axis.set(xlabel='first name said', ylabel='truth',
             title=f'{len(scores)} blind trials')
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
    return path
