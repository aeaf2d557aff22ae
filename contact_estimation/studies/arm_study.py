# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The library on two arms simulated in MuJoCo: tool, stiffness and damping, diagnosis.

Its commands get recordings with the faults of real sensors. Needs the extras `arms` and `tools`.
"""

from collections import Counter
from contextlib import redirect_stderr, redirect_stdout
import io
import json
from pathlib import Path
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from .arm_models import (
    Arm, ARMS, description_of, mujoco, mujoco_model, SENSOR, TIP, TOOL_CENTRE, TOOL_MASS)
from .arm_simulation import ArmSimulation, ENGINE, Run, TIMESTEP, World
from .blind_trials.arm_trials import arm_text, plan_arms, scored
from .blind_trials.running import run_trials
from ..commands import calibrate_tool, diagnose, replay
from ..commands.command_line import command, new_folder, Parser, require_at_least
from ..exceptions import EstimationError, UnknownNameError
from ..figures import BLUE, figure_style, GREY, INK, new_figure, ORANGE
from ..kinematics.robot_model import RobotModel
from ..parameter_files import parameter_sections, read_parameter_file
from ..recordings import RecordingWriter
from ..recordings.encoding import encode_arm, encode_string, TrajectoryEncoder, WrenchEncoder
from ..texts import markdown_table

FORCE_BIAS = (2.0, -1.5, 3.0, 0.05, -0.1, 0.08)  # of force [N] and torque [N m]
_FORCE_NOISE = (0.15,) * 3 + (0.01,) * 3
_POSITION_NOISE, _VELOCITY_NOISE = 5e-6, 5e-4  # [rad], [rad/s]
_BEGIN_NS = 1_000_000_000_000
_POSE_SEEDS = 3
_FRICTION_N = 8.0  # of the joints, as a force along the normal
_NOMINAL = {'stiffness': 1.06, 'damping': 0.8}  # over true
CONCEALED: dict[str, set[str]] = {'nothing': set(), 'joint friction': {'robot'},
                                  'tool mass': {'force_sensor'}}
"""What is concealed, and the ports whose names are then right."""
_CASES: Sequence[tuple[str, str, Callable[[str], bool], list[str]]] = (
    # of each replay: estimator, what is taken out, which parameters of the tool, further options
    ('kalman', 'load and inertia', lambda name: True, []),
    ('kalman', 'load only', lambda name: name.startswith('tool.'), []),
    ('kalman', 'tare only', lambda name: False, ['--tare', '0:2.5']),
    ('kalman', 'none', lambda name: False, []),
    ('rls_adaptive', 'load and inertia', lambda name: True, []),
    ('rls_adaptive', 'none', lambda name: False, []),
    ('rls', 'load and inertia', lambda name: True, []),
)


class StudiedArm:
    """An arm, and the folder of its files."""

    def __init__(self, arm: Arm, folder: Path) -> None:
        self.arm, self._folder, self.urdf = arm, folder, description_of(arm)
        self.path('urdf').write_text(self.urdf)

    def path(self, name: str) -> Path:
        """Return the path of a file."""
        return self._folder / f'{self.arm.name}.{name}'

    def calibrated(self, seed: int) -> dict[str, Any]:
        """Calibrate the tool from 12 poses in free flight."""
        poses = self._recorded(f'poses_{seed}', seed, ArmSimulation(
            self.arm, self.urdf, World()).calibrate(seed))
        return self._called(calibrate_tool.main, f'tool_{seed}.json', [
            str(poses), '--robot-description', str(self.path('urdf')), '--output',
            str(self.path(f'tool_{seed}.yaml'))])

    def touched(self, seed: int, friction: float = 0.0) -> tuple[Run, World, Path]:
        """Simulate and record three touches of a wall; that of seed 0 has 5000 N/m, 80 N s/m."""
        draw = np.random.default_rng(seed)
        wall = {'K_e': draw.uniform(4000.0, 7000.0), 'B_e': draw.uniform(60.0, 140.0)}
        world = World(**(wall if seed else {}), friction=friction)
        run = ArmSimulation(self.arm, self.urdf, world).touch(seed)
        return run, world, self._recorded(f'touch_{seed}_{friction:g}N', seed + 1000, run)

    def estimated(
        self, run: Run, recording: Path, estimator: str = 'kalman',
        known: Callable[[str], bool] = lambda name: True, options: Sequence[str] = (),
    ) -> dict[str, Any]:
        """Replay with those parameters of the calibrated tool that are `known`."""
        tool = {name: value for name, value in self._tool().items() if known(name)}
        return self._called(replay.main, 'replay.json', [
            str(recording), '--estimator', estimator, *options,
            *self._params({**self.parameters(run), **tool})])

    def diagnosed(self, concealed: str, seed: int) -> dict[str, Any]:
        """Conceal friction or the tool, and diagnose with a nominal wall that is off."""
        run, world, recording = self.touched(
            seed, _FRICTION_N if concealed == 'joint friction' else 0.0)
        tool = {**self._tool(), **({'tool.mass': 0.0} if concealed == 'tool mass' else {})}
        self.path('nominal.yaml').write_text(parameter_sections(plant_node={
            'environment': {'stiffness': world.K_e * _NOMINAL['stiffness'],
                            'damping': world.B_e * _NOMINAL['damping'], 'location': run.location},
            'robot': run.impedance}))
        return self._called(diagnose.main, 'diagnosis.json', [
            str(recording), '--nominal', str(self.path('nominal.yaml')), '--seed', str(seed),
            *self._params({**self.parameters(run), **tool})])

    def parameters(self, run: Run) -> dict[str, Any]:
        """Return the parameters of the estimator node for a run, without those of the tool."""
        return {'sample_rate': 1000.0 / self.arm.wrench_period,
                'kinematics.base': self.arm.base, 'kinematics.tip': TIP,
                'contact.normal': run.normal.tolist(), 'force_sensor.frame': SENSOR,
                'environment.location': run.location}

    def _tool(self) -> dict[str, Any]:
        """Read what `calibrate_tool` wrote."""
        return read_parameter_file(self.path('tool_0.yaml'), 'estimator_node')

    def _params(self, values: Mapping[str, Any]) -> list[str]:
        self.path('params.yaml').write_text(parameter_sections(any_node={
            name: [*value] if isinstance(value, tuple) else value
            for name, value in values.items()}))
        return ['--params', str(self.path('params.yaml'))]

    def _called(self, main: Callable[..., int], name: str, words: list[str]) -> dict[str, Any]:
        """Run a command and return its JSON."""
        printed = io.StringIO()
        with redirect_stdout(printed), redirect_stderr(printed):
            if main([*words, '--json', str(self.path(name))]):
                raise EstimationError(f'{" ".join(words)} failed: {printed.getvalue()}')
        found: dict[str, Any] = json.loads(self.path(name).read_text())
        return found

    def _recorded(self, name: str, seed: int, run: Run) -> Path:
        """Record a run: names of the joints in four orders, among them one not of the arm."""
        path, draw = self.path(f'{name}.mcap'), np.random.default_rng(seed)
        joints = (*RobotModel(self.urdf, self.arm.base, TIP).joint_names, 'finger_joint')
        orders = [draw.permutation(len(joints)) for _ in range(4)]
        wrenches, references = WrenchEncoder(SENSOR), TrajectoryEncoder('base', 'normal')
        path.unlink(missing_ok=True)  # of a study with other seeds
        with RecordingWriter.file(path) as writer:
            writer.write('/robot_description', 'std_msgs/msg/String', encode_string(self.urdf),
                         _BEGIN_NS)
            for k, (q, q_dot, wrench) in enumerate(zip(run.q, run.q_dot, run.wrench)):
                stamp = _BEGIN_NS + round(1e9 * k * TIMESTEP)
                if run.reference.x.ndim == 1 and k % 2 == 0:
                    x, v, a = (float(column[k]) for column in run.reference)
                    writer.write('/reference_trajectory', 'trajectory_msgs/msg/JointTrajectory',
                                 references.encode(stamp, x, v, a, 0.0), stamp)
                if k % self.arm.joint_period == 0:
                    order = orders[k // self.arm.joint_period % len(orders)]
                    rows = (np.append(row + noise * draw.normal(size=len(row)), 0.0)[order]
                            for row, noise in ((q, _POSITION_NOISE), (q_dot, _VELOCITY_NOISE)))
                    writer.write('/joint_states', 'sensor_msgs/msg/JointState', encode_arm(
                        stamp, [joints[i] for i in order], *rows, ()), stamp)
                if k % self.arm.wrench_period == 0:
                    measured = wrench + FORCE_BIAS + _FORCE_NOISE * draw.normal(size=6)
                    writer.write('/wrench', 'geometry_msgs/msg/WrenchStamped',
                                 wrenches.encode(stamp, *measured.tolist()), stamp)
        return path


def tool_row(found: Mapping[str, Any]) -> list[str]:
    """Return the errors of mass [g], centre [mm] and force bias [N], as text."""
    centre = 1e3 * np.abs(np.subtract(found['centre_m']['value'], TOOL_CENTRE)).max()
    bias = np.abs(np.subtract(found['force_bias_n']['value'], FORCE_BIAS[:3])).max()
    mass = found['mass_kg']
    return [f'{1e3 * (mass["value"] - TOOL_MASS):+.2f} +- {1e3 * mass["std"]:.2f}',
            f'{centre:.3f} +- {1e3 * max(found["centre_m"]["std"]):.3f}', f'{bias:.3f}']


def contact_row(found: Mapping[str, Any], run: Run, world: World) -> list[str]:
    """Return the errors of K_e [%], B_e [%] and x_e [mm], and the warnings, as text."""
    pairs = ((found[name], found.get(f'{name}_std') or np.nan, true) for name, true in (
        ('stiffness', world.K_e), ('damping', world.B_e)))
    return [*(f'{100.0 * (value / true - 1.0):+.2f} +- {100.0 * std / true:.2f}'
              for value, std, true in pairs),
            f'{1e3 * (found["location"] - run.location):+.2f}',
            ', '.join(dict.fromkeys(one['name'] for one in found['warnings'])) or 'none']


def diagnosis_row(reports: Sequence[Mapping[str, Any]], right: set[str]) -> list[str]:
    """Return how often the first name, and all names, are of the right port."""
    ports = [[effect['port'] for effect in report['effects']] for report in reports]
    names = Counter(effect['name'] for report in reports for effect in report['effects'])
    return [f'{sum(set(one[:1]) == right for one in ports)} of {len(ports)}',
            f'{sum(set(one) == right for one in ports)} of {len(ports)}',
            ', '.join(f'{name} ({count})' for name, count in names.items()) or 'none']


@figure_style()
def plot_frames(path: Path, arm: StudiedArm, run: Run) -> None:
    """Draw the arm at the wall with the frames that the parameters name."""
    data = mujoco().MjData(model := mujoco_model(arm.urdf, TIMESTEP))
    data.qpos[:] = run.q[int(np.argmin(run.force))]
    mujoco().mj_forward(model, data)
    names = [model.body(k).name for k in range(1, model.nbody)]
    chain = [data.body(name).xpos for name in names if name not in ('base', 'ee_link')]
    figure, axis = new_figure((6.0, 5.0), subplot_kw={'projection': '3d'})
    axis.plot(*np.array(chain).T, color=GREY, linewidth=4, solid_capstyle='round')
    for name, link in (('kinematics.base', arm.arm.base), ('force_sensor.frame', SENSOR),
                       ('kinematics.tip', TIP)):
        body = data.body(link)
        for column, color in zip(body.xmat.reshape(3, 3).T, (ORANGE, '#2f855a', BLUE)):
            axis.quiver(*body.xpos, *(0.12 * column), color=color, linewidth=1.5)
        axis.text(*(body.xpos + [0.03, -0.05, 0.0]), name, fontsize=8, color=INK)
    tip, n = data.site(TIP).xpos, run.normal
    axis.quiver(*tip, *(0.24 * n), color=INK, linewidth=2)
    axis.text(*(tip + 0.26 * n), 'contact.normal', fontsize=8, color=INK)
    u, v = np.linalg.svd(n[None])[2][1:, :, None, None] * 0.15
    a, b = np.meshgrid([-1.0, 1.0], [-1.0, 1.0])
    axis.plot_surface(*(tip[:, None, None] + a * u + b * v), color=ORANGE, alpha=0.25)
    axis.view_init(elev=18, azim=-80)
    axis.set_box_aspect(np.ptp([*chain, tip + 0.2 * n], axis=0) + 0.2)
    axis.set(xlabel='x [m]', ylabel='y [m]', zlabel='z [m]',
             title=f'{arm.arm.name} at the wall; axes x orange, y green, z blue')
    figure.savefig(path)


def make_parser() -> Parser:
    """Build the command line of the study."""
    parser = Parser(
        prog='studies arms',
        description='Simulate arms in MuJoCo, with a wrist sensor, a tool of 1.2 kg and a tilted '
        'wall, record them, and compare what the library finds with the truth.')
    parser.add_argument('arms', nargs='*', metavar='ARM', help=f'any of {", ".join(ARMS)} (all)')
    parser.add_argument('--output', required=True, metavar='DIR',
                        help='new folder for recordings, arms.md and pictures')
    parser.add_argument('--seeds', type=int, default=5,
                        help='diagnoses of each concealed effect on each arm '
                        '(default: %(default)s)')
    parser.add_argument('--concealed', type=int, default=0, metavar='N',
                        help='instead, diagnose N worlds on a planar arm, panda and ur5, in '
                        'which a law of a joint, a link or a sensor of torque is concealed from '
                        'diagnose --nominal-robot (default: %(default)s); an interrupted '
                        'study resumes')
    parser.add_argument('--seed', type=int, default=0,
                        help='of --concealed (default: %(default)s)')
    return parser


def run(options: Any) -> int:
    """Run the study, print its tables and write them."""
    for name in options.arms:
        if name not in ARMS:
            raise UnknownNameError.among('arm', name, ARMS)
    require_at_least(options, seeds=1, concealed=0, seed=0)
    if options.concealed:
        folder = Path(options.output)
        folder.mkdir(parents=True, exist_ok=True)
        planned = plan_arms(options.concealed, [options.seed], engine=ENGINE)
        text = arm_text([scored(*one, arm.name) for arm, one in zip(
            planned, run_trials(folder, planned, jobs=1))])
    else:
        folder = new_folder(options.output)
        arms = [StudiedArm(ARMS[name], folder) for name in options.arms or ARMS]
        text = '\n\n'.join(_tables(arms, options.seeds))
    (folder / ('concealed.txt' if options.concealed else 'arms.md')).write_text(text + '\n')
    print(text)
    return 0


def _tables(arms: Sequence[StudiedArm], seeds: int) -> list[str]:
    tools = [[one.arm.name, str(seed), *tool_row(one.calibrated(seed))]
             for one in arms for seed in range(_POSE_SEEDS)]
    contacts = []
    for one in arms:
        run, world, recording = one.touched(0)
        plot_frames(one.path('frames.png'), one, run)
        one.estimated(run, recording, options=['--picture', str(one.path('contact.png'))])
        contacts += [[one.arm.name, estimator, text, *contact_row(
            one.estimated(run, recording, estimator, known, options), run, world)]
            for estimator, text, known, options in _CASES]
    diagnoses = [[one.arm.name, concealed, *diagnosis_row(
        [one.diagnosed(concealed, seed) for seed in range(seeds)], right)]
        for one in arms for concealed, right in CONCEALED.items()]
    return [
        markdown_table(('arm', 'seed', 'error of the mass [g]', 'worst error of the centre [mm]',
                        'worst error of the force bias [N]'), tools),
        markdown_table(('arm', 'estimator', 'taken out of the force', 'error of K_e [%]',
                        'error of B_e [%]', 'error of x_e [mm]', 'warnings'), contacts),
        markdown_table(('arm', 'concealed', 'right first name', 'no other port named',
                        'names (number of seeds)'), diagnoses)]


main = command(make_parser, run)
