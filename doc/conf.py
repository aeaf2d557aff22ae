# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Configuration of Sphinx; build with: python -m sphinx -W -b html doc doc/_build/html."""

from pathlib import Path
import sys

sys.path.insert(0, str(Path(__file__).parent))  # the extension generated_pages

project = 'contact_estimation'
author = 'contact_estimation authors'
copyright = '2026, contact_estimation authors'  # noqa: A001

extensions = [
    'generated_pages',
    'myst_parser',
    'numpydoc',
    'sphinx.ext.autodoc',
    'sphinx.ext.autosummary',
    'sphinx.ext.viewcode',
]
exclude_patterns = ['_build', 'images']
html_theme = 'furo'
html_title = 'contact_estimation'
html_static_path: list[str] = []
myst_enable_extensions = ['colon_fence', 'deflist']
myst_heading_anchors = 3
pygments_style = 'friendly'

autodoc_member_order = 'bysource'
autodoc_typehints = 'none'  # numpydoc sections give the types
autosummary_generate = False
numpydoc_show_class_members = False
