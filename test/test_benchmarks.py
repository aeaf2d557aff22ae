# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The commands of the benchmarks: their help, and an end of every process they start."""

from __future__ import annotations

from importlib import import_module

import pytest

COMMANDS = ('__main__', 'arms.__main__', 'estimators_study', 'fleet', 'input_checks',
            'online_study', 'records')


@pytest.mark.parametrize('name', COMMANDS)
def test_every_benchmark_has_a_help(name: str) -> None:
    parser = import_module(f'contact_estimation.benchmarks.{name}').make_parser()
    assert len(parser.format_help()) > 200
