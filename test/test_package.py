# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import ast
from importlib import import_module
import os
from pathlib import Path
import re
import subprocess
import sys
from typing import Any
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / 'contact_estimation'
# What the source may import, and the rosdep key that brings it.
ROSDEP_KEYS = {
    'diagnostic_msgs': 'diagnostic_msgs',
    'filterpy': 'python3-filterpy-pip',
    'geometry_msgs': 'geometry_msgs',
    'jinja2': 'python3-jinja2',
    'launch': 'launch',
    'launch_ros': 'launch_ros',
    'markupsafe': 'python3-jinja2',  # of which it is part
    'matplotlib': 'python3-matplotlib',
    'mcap': 'mcap-ros2-support',
    'numpy': 'python3-numpy',
    'pinocchio': 'pinocchio',
    'rcl_interfaces': 'rcl_interfaces',
    'rclpy': 'rclpy',
    'rosbags': 'python3-rosbags-pip',
    'tf2_msgs': 'tf2_msgs',
    'scipy': 'python3-scipy',
    'sensor_msgs': 'sensor_msgs',
    'std_msgs': 'std_msgs',
    'std_srvs': 'std_srvs',
    'tqdm': 'python3-tqdm',
    'trajectory_msgs': 'trajectory_msgs',
    'yaml': 'python3-yaml',
}
RUN_BY_USERS = {'ros2launch'}


def package_xml() -> ElementTree.Element:
    return ElementTree.parse(ROOT / 'package.xml').getroot()


def exec_depends() -> set[str]:
    return {element.text or '' for element in package_xml().iter('exec_depend')}


def python_files() -> list[Path]:
    places = (PACKAGE, ROOT / 'doc', ROOT / 'launch', ROOT / 'test')
    return [ROOT / 'setup.py', *(file for place in places for file in place.rglob('*.py'))]


def imported_packages(file: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names.add(node.module or '')
    return {name.partition('.')[0] for name in names}


def test_package_xml_is_a_format_3_ament_python_package() -> None:
    root = package_xml()
    assert root.get('format') == '3'
    assert root.findtext('name') == 'contact_estimation'
    assert root.findtext('export/build_type') == 'ament_python'


def test_version_is_the_same_everywhere(setup_arguments: dict[str, Any]) -> None:
    newest = re.search(r'^(\d+\.\d+\.\d+) \(', (ROOT / 'CHANGELOG.rst').read_text(), re.M)
    assert newest is not None
    versions = {package_xml().findtext('version'), setup_arguments['version'], newest[1]}
    assert len(versions) == 1, versions


def test_every_exec_depend_is_a_known_rosdep_key() -> None:
    assert exec_depends() <= set(ROSDEP_KEYS.values()) | RUN_BY_USERS


def test_package_xml_declares_every_import() -> None:
    files = [*PACKAGE.rglob('*.py'), *(ROOT / 'launch').rglob('*.py')]
    imported = set().union(*(imported_packages(file) for file in files))
    # Only a study uses mujoco, where it is installed; the others are those of the extras `fleet`
    # and `watch`, which pip installs.
    imported -= {'__future__', 'mujoco', 'distributed', 'pyarrow', 'rerun', PACKAGE.name,
                 *sys.stdlib_module_names}
    assert imported <= set(ROSDEP_KEYS)
    assert {ROSDEP_KEYS[name] for name in imported} <= exec_depends()


def output_of(code: str, **environment: str) -> str:
    """Run code in a Python of its own, without this one's choice of threads."""
    # Dask leaves the second one in a process that has started workers.
    chosen = 'OMP_NUM_THREADS', 'OPENBLAS_NUM_THREADS'
    outer = {key: value for key, value in os.environ.items() if key not in chosen}
    done = subprocess.run([sys.executable, '-c', code], env={**outer, **environment}, check=True,
                          capture_output=True, text=True)
    return done.stdout.strip().splitlines()[-1]


@pytest.mark.slow
@pytest.mark.skipif(not Path('/proc/self/status').exists(), reason='counts threads in /proc')
@pytest.mark.parametrize('given, one', [({}, True), ({'OMP_NUM_THREADS': '3'}, False)])
def test_commands_compute_on_one_thread_unless_the_user_chooses(
    given: dict[str, str], one: bool
) -> None:
    code = """
import re, sys
from contact_estimation.executables import simulate
sys.argv[1:] = ['--help']
try:
    simulate()
except SystemExit:
    import numpy, scipy.linalg
    print(re.search(r'Threads:\\s*(\\d+)', open('/proc/self/status').read())[1])
"""
    assert (int(output_of(code, **given)) == 1) == one


def test_every_module_is_installed(setup_arguments: dict[str, Any]) -> None:
    installed = {package.replace('.', '/') for package in setup_arguments['packages']}
    folders = {file.parent.relative_to(ROOT).as_posix() for file in PACKAGE.rglob('*.py')}
    assert folders <= installed, 'these folders lack an __init__.py'


def test_every_data_file_is_installed(setup_arguments: dict[str, Any]) -> None:
    installed = {file for _, files in setup_arguments['data_files'] for file in files}
    files = [path for name in ('config', 'launch') for path in (ROOT / name).rglob('*')]
    expected = {f.relative_to(ROOT).as_posix() for f in files if f.is_file()}
    assert {file for file in expected if '__pycache__' not in file} <= installed


def test_console_scripts_point_to_functions(setup_arguments: dict[str, Any]) -> None:
    for script in setup_arguments['entry_points']['console_scripts']:
        module, function = script.partition(' = ')[2].split(':')
        assert callable(getattr(import_module(module), function)), script


@pytest.mark.parametrize('module', [
    'commands.calibrate_tool', 'commands.convert', 'commands.diagnose', 'commands.fleet',
    'commands.loop', 'commands.replay', 'commands.simulate', 'commands.watch',
    'studies.blind_trials.command', 'studies.reproduce'])
def test_help_of_a_command_explains_every_option(module: str) -> None:
    parser = import_module(f'contact_estimation.{module}').make_parser()
    assert all(action.help for action in parser._actions)
    assert all(option in parser.format_help()
               for action in parser._actions for option in action.option_strings)


@pytest.mark.slow
@pytest.mark.parametrize('name', ['estimator_node', 'simulate'])
def test_help_may_be_cut_off_by_its_reader(name: str) -> None:
    command = [sys.executable, '-m', 'contact_estimation', name, '--help']
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, cwd=ROOT)
    os.close(write)
    assert (done.returncode, done.stderr) == (0, '')


def test_every_file_starts_with_the_copyright_header() -> None:
    header = Path(__file__).read_text().partition('\n\n')[0]
    assert header.startswith('# Copyright 2026 contact_estimation authors\n')
    contents = {file: file.read_text() for file in python_files()}
    lacking = [
        str(file.relative_to(ROOT)) for file, text in contents.items()
        if text and not re.sub(r'\A#!.*\n+', '', text).startswith(header)
    ]
    assert lacking == []


def test_continuous_integration_runs_the_test_command_of_the_readme() -> None:
    blocks = re.findall(r'^```\w*\n(.*)\n```$', (ROOT / 'README.md').read_text(), re.M)
    commands = [line for line in blocks if line.endswith('-m pytest')]
    assert len(commands) == 1
    assert commands[0] in (ROOT / '.ci' / 'run').read_text().splitlines()
