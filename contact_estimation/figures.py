# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Figures with matplotlib, an optional package: one style, files without a display."""

from base64 import b64encode
from contextlib import contextmanager
import io
from typing import Any, Iterator

from .exceptions import MissingPackageError

INK, MUTED, GRID = '#1f2933', '#9aa5b1', '#e4e7eb'
BLUE, ORANGE, GREY, OCHRE = '#0b6e99', '#c2410c', '#7b8794', '#b7791f'

STYLE = {
    'axes.axisbelow': True,
    'axes.edgecolor': MUTED,
    'axes.grid': True,
    'axes.labelcolor': INK,
    'axes.labelsize': 9,
    'axes.spines.right': False,
    'axes.spines.top': False,
    'axes.titlecolor': INK,
    'axes.titlelocation': 'left',
    'axes.titlesize': 9,
    'axes.xmargin': 0.01,
    'figure.constrained_layout.use': True,
    'grid.color': GRID,
    'grid.linewidth': 0.6,
    'legend.fontsize': 8,
    'legend.frameon': False,
    'savefig.dpi': 130,
    'text.color': INK,
    'xtick.color': MUTED,
    'xtick.labelcolor': INK,
    'xtick.labelsize': 8,
    'ytick.color': MUTED,
    'ytick.labelcolor': INK,
    'ytick.labelsize': 8,
}


@contextmanager
def figure_style() -> Iterator[None]:
    """Apply the style to the figures plotted meanwhile; also a decorator of plotting functions."""
    with require_matplotlib().rc_context(STYLE):
        yield


def new_figure(
    size: tuple[float, float], rows: int = 1, columns: int = 1, **options: Any
) -> tuple[Any, Any]:
    """Create a figure that no window manager keeps alive; size: width and height [inch]."""
    figure = require_matplotlib().Figure(figsize=size)
    return figure, figure.subplots(rows, columns, **options)


def as_png(figure: Any) -> bytes:
    """Render a figure."""
    stream = io.BytesIO()
    with figure_style():
        figure.savefig(stream, format='png')
    return stream.getvalue()


def as_data_uri(figure: Any) -> str:
    """Render a figure for an HTML page."""
    return 'data:image/png;base64,' + b64encode(as_png(figure)).decode('ascii')


def require_matplotlib() -> Any:
    """Import matplotlib for files, without a display."""
    try:
        import matplotlib
    except ImportError as error:
        raise MissingPackageError.of('matplotlib', 'plotting figures') from error
    matplotlib.use('Agg')
    from matplotlib import pyplot

    return pyplot
