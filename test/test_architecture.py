# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Data flow one way: a package imports only from packages listed before it."""

from __future__ import annotations

import ast
from functools import lru_cache
from pathlib import Path

import contact_estimation

ROOT = Path(contact_estimation.__file__).parent
LAYERS = [
    'ament_licence', 'texts', 'exceptions', 'figures', 'scheduling', 'parameters',
    'parameter_files', 'recordings', 'signals', 'kinematics', 'physics', 'reference',
    'estimators', 'pipeline', 'plant', 'diagnosis.observe', 'diagnosis.checks', 'diagnosis.fit',
    'diagnosis', 'diagnosis.report', 'diagnosis.arm', 'fleet', 'watch', 'ros', 'commands',
    'studies.blind_trials', 'studies', 'executables',
]


def package_of(module: str) -> str:
    """Return the layer that a module, named below contact_estimation, belongs to."""
    return max((p for p in LAYERS if f'{module}.'.startswith(f'{p}.')), key=len)


@lru_cache(maxsize=None)
def imported(file: Path) -> list[str]:
    """Return the modules of this project that a file imports, below contact_estimation."""
    parts = file.relative_to(ROOT).parts[:-1]
    return ['.'.join([*parts[:len(parts) - node.level + 1], *filter(None, [node.module])])
            for node in ast.walk(ast.parse(file.read_text()))
            if isinstance(node, ast.ImportFrom) and node.level]


def test_a_package_imports_only_packages_listed_before_it() -> None:
    for package in LAYERS:
        files = [f for f in ROOT.rglob('*.py')
                 if f.stat().st_size and (f.parent != ROOT or f.stem in LAYERS)]
        names = {f: '.'.join(f.relative_to(ROOT).with_suffix('').parts) for f in files}
        of_package = [f for f, name in names.items() if package_of(name) == package]
        used = {package_of(module) for f in of_package for module in imported(f) if module}
        assert of_package, package
        below = LAYERS[:LAYERS.index(package) + 1]
        assert not used - set(below), package


def test_every_module_belongs_to_a_listed_package() -> None:
    names = {f.relative_to(ROOT).parts[0].removesuffix('.py') for f in ROOT.rglob('*.py')}
    listed = {layer.partition('.')[0] for layer in LAYERS}
    assert {name for name in names if not name.startswith('__')} == listed


def test_laws_of_blind_trials_share_no_code_with_the_diagnosis() -> None:
    files = list((ROOT / 'studies/blind_trials').glob('foreign_*.py'))
    used = {module for file in files for module in imported(file)}
    assert len(files) > 5
    assert all(module.startswith('studies.blind_trials.foreign_') for module in used)
