# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What an effect or an estimator needs besides its class is there; else one message lists it."""

from pathlib import Path
import re

from contact_estimation.commands.write_config import config_files
from contact_estimation.estimators import ESTIMATORS
from contact_estimation.physics import EFFECTS
from effect_formulas import FORMULAS, SENSED
import pytest
from test_diagnosis_names import WORLDS

ROOT = Path(__file__).resolve().parent.parent


def configured(name: str) -> list[str]:
    """Ask for the regenerated configuration files, where a name is not in them as it would be."""
    whole = re.compile(rf'\b{name}\b')
    stale = [file for file, text in config_files().items()
             if whole.search(text) and not whole.search((ROOT / 'config' / file).read_text())]
    return [f'{", ".join(stale)} of config/: run `python -m '
            'contact_estimation.commands.write_config`'] if stale else []


def to_do_for_effect(name: str) -> list[str]:
    """Return what doc/contributing.md asks for an effect and is not there."""
    family = EFFECTS[name].family
    rows = [row for row in (ROOT / 'README.md').read_text().splitlines()
            if row.startswith(f'| {family} |')]
    places = {
        f'README.md: `{name}` in the row of the family "{family}" of the table of effects':
            any(f'`{name}`' in row for row in rows),
        'test/effect_formulas.py: its law, written independently of the class':
            EFFECTS[name].port == 'robot' or name in FORMULAS or name in SENSED,
        'test/test_diagnosis_names.py: in `WORLDS` a world in which `diagnose` names it':
            name in WORLDS}
    return [place for place, there in places.items() if not there] + configured(name)


def to_do_for_estimator(name: str) -> list[str]:
    """Return what doc/contributing.md asks for an estimator and is not there."""
    there = f'\n| `{name}`' in (ROOT / 'doc' / 'estimators.md').read_text()
    return ([] if there else ['doc/estimators.md: its row of the table']) + configured(name)


@pytest.mark.parametrize('name', EFFECTS)
def test_nothing_is_to_do_for_effect(name: str) -> None:
    left = to_do_for_effect(name)
    assert not left, '\n- '.join([f'still to do for {name}:', *left])


@pytest.mark.parametrize('name', ESTIMATORS)
def test_nothing_is_to_do_for_estimator(name: str) -> None:
    left = to_do_for_estimator(name)
    assert not left, '\n- '.join([f'still to do for {name}:', *left])
