# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
On-line estimation of contact stiffness and damping, and diagnosis of simulation models.

``import contact_estimation as ce`` gives the names that `__init__.pyi` imports for type checkers.
Each is imported when it is first used, so importing the package is fast and needs neither numpy
nor ROS.
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import Any

_STUB = ast.parse(Path(__file__).with_suffix('.pyi').read_text(encoding='utf-8'))
_MODULES = {alias.name: f'.{node.module}' for node in _STUB.body
            if isinstance(node, ast.ImportFrom) for alias in node.names}
__all__ = sorted(_MODULES, key=str.lower)


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _MODULES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}; expected one of '
                             f'{", ".join(__all__)}')
    value = getattr(import_module(_MODULES[name], __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
