# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The demonstration: conceal an effect, diagnose it, compensate it, estimate K and B again."""

import json
from pathlib import Path
import subprocess
import sys
from typing import Any

import numpy as np

from .command_line import command, new_folder, Parser, require_at_least
from ..exceptions import ContactEstimationError
from ..parameter_files import parameter_sections, read_parameter_file
from ..parameters import build, flatten, without
from ..plant.plant_parameters import PlantNodeParameters, PlantParameters

WORLD = {
    'environment.stiffness': 4800.0, 'environment.damping': 200.0, 'sensors.force_noise': 0.3,
    'sensors.distribution': 'normal', 'sensors.position_noise': 3e-6,
    'sensors.position_quantisation': 1e-6,
}
"""The true wall and the sensors of the demonstration."""

NOMINAL = {'environment.stiffness': 4300.0, 'environment.damping': 260.0}
"""The nominal model of the simulation: other values, no extra physics."""

CONCEALED: tuple[dict[str, float], ...] = (
    {'physics.coulomb_friction.F_c': 6.0},
    {'physics.contact_offset.offset': -0.0006},
    {'physics.quadratic_damping.B_2': 1500.0},
    {'physics.viscoelastic_relaxation.K_1': 900.0, 'physics.viscoelastic_relaxation.tau': 0.2},
    {'physics.force_bias.bias': -4.0},
    {'physics.environment_inertia.M_e': 2.0},
)
"""One of these is concealed, chosen by the seed."""

_ESTIMATOR = {'estimator': 'kalman', 'reference_law': 'pass_through'}


def make_parser() -> Parser:
    """Build the command line of the demonstration."""
    parser = Parser(
        prog='demonstrate',
        description='Conceal an effect in the simulated plant, run the loop, diagnose the '
        'recording, run the loop again with the diagnosed effect compensated, and compare the '
        'estimates.')
    parser.add_argument('--output', required=True, metavar='DIR', help='new folder for results')
    parser.add_argument('--physics', metavar='FILE',
                        help='parameter file with the plant_node physics to conceal (default: '
                        'one effect chosen by the seed)')
    parser.add_argument('--seed', type=int, default=0,
                        help='seed of the effect and of all noise (default: %(default)s)')
    return parser


def run(options: Any) -> int:
    """Run the demonstration and print estimates before and after."""
    require_at_least(options, seed=0)
    concealed = _concealed(options)
    output = new_folder(options.output)
    before = _loop(output, 'before', concealed, {}, options.seed)
    report = _diagnose(output)
    found = read_parameter_file(output / 'corrected.yaml', 'estimator_node')
    after = _loop(output, 'after', concealed, found, options.seed + 1)
    _print(concealed, report, before, after, output)
    return 0


def _concealed(options: Any) -> dict[str, Any]:
    """Return the true world: the physics from the file, or chosen by the seed."""
    if options.physics:
        given = without(PlantNodeParameters, read_parameter_file(options.physics, 'plant_node'))
        build(PlantParameters, given)
        return {**WORLD, **given}
    drawn = np.random.default_rng(options.seed).integers(len(CONCEALED))
    return {**WORLD, **CONCEALED[int(drawn)]}


def _loop(
    output: Path, name: str, plant: dict[str, Any], estimator: dict[str, Any], seed: int
) -> dict[str, Any]:
    """Run the loop in its own processes and return its summary."""
    parameters = output / f'{name}.yaml'
    parameters.write_text(parameter_sections(
        plant_node=plant, estimator_node={**_ESTIMATOR, **estimator}))
    _call('loop', '--experiment', 'rich', '--lockstep',  # a busy machine delays no command
          '--params', str(parameters), '--seed', str(seed), '--output', str(output / name))
    return dict(json.loads((output / name / 'summary.json').read_text()))


def _diagnose(output: Path) -> dict[str, Any]:
    """Diagnose from recording and nominal model alone; return the report."""
    nominal = output / 'nominal.yaml'
    nominal.write_text(parameter_sections(plant_node=NOMINAL))
    _call('diagnose', str(output / 'before' / 'recording'), '--nominal', str(nominal),
          '--json', str(output / 'report.json'), '--html', str(output / 'report.html'),
          '--write-model', str(output / 'corrected.yaml'))
    return dict(json.loads((output / 'report.json').read_text()))


def _call(command: str, *arguments: str) -> None:
    done = subprocess.run([sys.executable, '-m', 'contact_estimation', command, *arguments],
                          stdout=subprocess.DEVNULL)
    if done.returncode:
        raise ContactEstimationError(
            f'{command} ended with exit code {done.returncode}, expected 0; see its message above')


def _print(
    concealed: dict[str, Any], report: dict[str, Any], before: dict[str, Any],
    after: dict[str, Any], output: Path,
) -> None:
    true = {name: value for name, value in flatten(build(PlantParameters, concealed)).items()
            if name.startswith('physics.') and value == value}
    found = {f'physics.{effect["name"]}.{name}': value for effect in report['effects']
             for name, value in effect['parameters'].items()}
    print('concealed: ' + ', '.join(f'{name[8:]} = {value:g}' for name, value in true.items()))
    named = ', '.join(f'{name[8:]} = {value["value"]:.4g} +- {value["std"]:.2g} {value["unit"]}'
                      for name, value in found.items())
    print(f'diagnosed: {report["verdict"]}' + (f'; {named}' if named else ''))
    print(f'{"":<22}{"true":>12}{"before":>12}{"after":>12}')
    for name, label in (('stiffness', 'K_e [N/m]'), ('damping', 'B_e [N s/m]')):
        print(f'{label:<22}{concealed["environment." + name]:>12.1f}{_text(before[name]):>12}'
              f'{_text(after[name]):>12}')
    for name, label in (('stiffness', 'error of K_e [%]'), ('damping', 'error of B_e [%]')):
        key = f'{name}_error_percent'
        print(f'{label:<22}{"":>12}{_text(before[key], "+.2f"):>12}'
              f'{_text(after[key], "+.2f"):>12}')
    print(f'wrote report.html, before/ and after/ in {output}')


def _text(value: float | None, form: str = '.1f') -> str:
    return 'none' if value is None else format(value, form)


main = command(make_parser, run)
