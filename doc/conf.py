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
