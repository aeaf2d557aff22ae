# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Descriptions of small arms for simulations: data, and the text that it makes."""

from typing import NamedTuple, Sequence

TIP = 'tip'  # frame at the end of the last link


class Link(NamedTuple):
    """A link and the joint that moves it: where that is, its axis, and a body along `to`."""

    origin: tuple[float, float, float]
    axis: tuple[int, int, int]
    mass: float
    to: tuple[float, float, float]
    radius: float
    reach: float
    effort: float


ARM_MODELS: dict[str, Sequence[Link]] = {
    'planar_3r': (
        Link((0, 0, 0.3), (0, 1, 0), 9.0, (0.45, 0, 0), 0.06, 2.0, 200.0),
        Link((0.45, 0, 0), (0, 1, 0), 5.0, (0.4, 0, 0), 0.05, 2.2, 100.0),
        Link((0.4, 0, 0), (0, 1, 0), 2.0, (0.2, 0.02, 0.02), 0.04, 2.4, 30.0)),
    'elbow_6r': (
        Link((0, 0, 0.2), (0, 0, 1), 12.0, (0, 0.05, 0.2), 0.09, 2.8, 150.0),
        Link((0, 0.1, 0.15), (0, 1, 0), 14.0, (0.02, 0.03, 0.45), 0.08, 1.8, 250.0),
        Link((0, 0, 0.45), (0, 1, 0), 7.0, (0.4, -0.04, 0.02), 0.06, 2.2, 120.0),
        Link((0.2, 0, 0), (1, 0, 0), 3.0, (0.2, 0.02, 0), 0.05, 2.8, 40.0),
        Link((0.2, 0, 0), (0, 1, 0), 2.0, (0.1, 0, 0.03), 0.04, 1.9, 30.0),
        Link((0.1, 0, 0), (1, 0, 0), 0.8, (0.05, 0.02, 0.01), 0.04, 2.8, 15.0)),
    'light_7r': (
        Link((0, 0, 0.33), (0, 0, 1), 5.0, (0, 0.04, -0.1), 0.06, 2.7, 90.0),
        Link((0, 0, 0), (0, 1, 0), 4.0, (0.02, 0, 0.3), 0.06, 1.7, 90.0),
        Link((0, 0, 0.3), (0, 0, 1), 3.2, (0.06, 0.02, 0.05), 0.05, 2.7, 90.0),
        Link((0.08, 0, 0), (0, -1, 0), 3.4, (-0.05, 0.03, 0.3), 0.05, 1.6, 90.0),
        Link((-0.08, 0, 0.38), (0, 0, 1), 2.6, (0, 0.04, -0.15), 0.05, 2.7, 15.0),
        Link((0, 0, 0), (0, -1, 0), 1.6, (0.07, -0.02, 0), 0.04, 1.8, 15.0),
        Link((0.09, 0, 0), (0, 0, -1), 0.8, (0.02, 0.02, 0.12), 0.04, 2.7, 12.0)),
}
"""Arms in a plane, with an elbow and a spherical wrist, and with seven joints."""

PRESSING: dict[str, Sequence[float]] = {
    'planar_3r': (-0.9, 1.3, 0.9), 'elbow_6r': (0.3, 0.3, 0.5, 0.2, 0.9, 0.1),
    'light_7r': (0.2, 0.4, 0.1, 1.2, 0.1, 0.9, 0.3)}
"""Joints with the tip above a table, far from singularities [rad]."""


def arm_description(name: str) -> str:
    """Return the text of a URDF file."""
    rows = [f'<?xml version="1.0"?>\n<robot name="{name}">\n  <link name="base"/>']
    for k, link in enumerate(ARM_MODELS[name], 1):
        length = sum(x * x for x in link.to) ** 0.5
        across = link.mass * (link.radius**2 / 4.0 + length**2 / 12.0)
        along = link.mass * link.radius**2 / 2.0
        main = max(range(3), key=lambda i: abs(link.to[i]))
        xx, yy, zz = (along if i == main else across for i in range(3))
        parent = f'link_{k - 1}' if k > 1 else 'base'
        rows.append(
            f'  <joint name="joint_{k}" type="revolute">\n'
            f'    <parent link="{parent}"/><child link="link_{k}"/>\n'
            f'    <origin xyz="{_text(link.origin)}"/><axis xyz="{_text(link.axis)}"/>\n'
            f'    <limit lower="{-link.reach}" upper="{link.reach}" effort="{link.effort}" '
            f'velocity="2.5"/>\n  </joint>\n'
            f'  <link name="link_{k}">\n    <inertial>\n'
            f'      <origin xyz="{_text(tuple(0.5 * x for x in link.to))}"/>'
            f'<mass value="{link.mass}"/>\n'
            f'      <inertia ixx="{xx:.6g}" ixy="0" ixz="0" iyy="{yy:.6g}" iyz="0" '
            f'izz="{zz:.6g}"/>\n    </inertial>\n  </link>')
    rows.append(
        f'  <link name="{TIP}"/>\n  <joint name="{TIP}_mount" type="fixed">\n'
        f'    <parent link="link_{len(ARM_MODELS[name])}"/><child link="{TIP}"/>\n'
        f'    <origin xyz="{_text(ARM_MODELS[name][-1].to)}"/>\n  </joint>')
    return '\n'.join([*rows, '</robot>\n'])


def _text(numbers: Sequence[float]) -> str:
    return ' '.join(f'{number:g}' for number in numbers)
