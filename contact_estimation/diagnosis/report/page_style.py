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

"""How the page looks: quiet, on light and dark screens and on paper."""

from __future__ import annotations

STYLE = """
:root { color-scheme: light dark; --ink: #1f2933; --muted: #616e7c; --line: #d5dbe1;
  --page: #ffffff; --card: #f5f7f9; --accent: #0b6e99; --warn: #8d5b0c; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e7eb; --muted: #a3b0bd;
  --line: #3e4c59; --page: #161b21; --card: #1f2731; --accent: #5fb3d9; --warn: #e0ad55; } }
@media print { :root { color-scheme: light; --ink: #000000; --muted: #444444; --line: #bbbbbb;
  --page: #ffffff; --card: #ffffff; --accent: #0b6e99; --warn: #8d5b0c; }
  figure, table, section { break-inside: avoid; } h2 { break-after: avoid; } }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 62rem; margin: 0 auto; padding: 1.5rem 1rem 3rem; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0.4rem 0; }
h2 { font-size: 1.15rem; margin: 1.8rem 0 0.5rem; }
.verdict { display: inline-block; margin: 0; padding: 0 0.6rem; border: 1px solid var(--accent);
  border-radius: 0.3rem; color: var(--accent); font-size: 0.9rem; }
.verdict.unexplained { border-color: var(--warn); color: var(--warn); }
.lead { font-size: 1.05rem; margin: 0.3rem 0; }
.muted, figcaption { color: var(--muted); font-size: 0.9rem; }
.warning { border-left: 3px solid var(--warn); padding-left: 0.8rem; }
.effect { background: var(--card); border: 1px solid var(--line); border-radius: 0.4rem;
  padding: 0.2rem 1rem 0.4rem; margin: 1.2rem 0; }
.effect h2 { margin-top: 0.6rem; }
.equation, code { font-family: ui-monospace, monospace; font-size: 0.92rem; }
figure { margin: 1rem 0; }
figure img { width: 100%; height: auto; background: #ffffff; border-radius: 0.3rem; }
table { border-collapse: collapse; width: 100%; font-size: 0.92rem;
  font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 0.25rem 0.6rem; border-bottom: 1px solid var(--line);
  vertical-align: top; }
thead th { color: var(--muted); font-weight: normal; }
"""
