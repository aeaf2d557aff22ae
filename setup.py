# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from glob import glob
import sys

from setuptools import find_packages, setup
from setuptools.command.install import install

package_name = 'contact_estimation'


class Install(install):
    """Leave setup.cfg's place for executables to colcon; pip < 23.1 calls `install` too."""

    def finalize_options(self) -> None:
        if '--install-headers' in sys.argv:  # only pip gives this one, and it wants them on PATH
            self.install_scripts = None
        super().finalize_options()


setup(
    name=package_name,
    version='0.1.0',
    description='On-line estimation of contact stiffness and damping for ROS 2.',
    author='contact_estimation authors',
    maintainer='contact_estimation maintainers',
    maintainer_email='maintainers@example.com',
    license='Apache-2.0',
    packages=find_packages(include=[package_name, package_name + '.*']),
    package_data={
        package_name: ['py.typed', '__init__.pyi'],
        package_name + '.diagnosis.fit': ['*.json'],
        package_name + '.diagnosis.report': ['*.css', '*.html'],
        package_name + '.fleet': ['*.html'],
    },
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/config', sorted(glob('config/*'))),
        ('share/' + package_name + '/launch', sorted(glob('launch/*.launch.*'))),
    ],
    entry_points={
        'ament_copyright.license': [
            'apache2_spdx = contact_estimation.ament_licence:APACHE_2_SPDX',
        ],
        'console_scripts': [
            f'{name} = contact_estimation.executables:{name}' for name in (
                'blind_trials', 'calibrate_tool', 'convert', 'diagnose', 'estimator_node', 'fleet',
                'loop', 'managed_estimator_node', 'plant_node', 'recorder_node', 'replay',
                'reproduce', 'simulate', 'watch')
        ],
    },
    python_requires='>=3.10',
    # Lower bounds of numpy, scipy, PyYAML and tqdm: Ubuntu 24.04, the platform of Jazzy.
    install_requires=[
        'filterpy>=2.0',
        'jinja2>=3.1',
        'markupsafe>=2.0',
        'mcap>=1.1',
        'numpy>=1.26',
        'pyyaml>=6.0',
        'scipy>=1.11',
        'tqdm>=4.66',
    ],
    extras_require={
        'doc': [
            'furo',
            'matplotlib>=3.6',
            'myst-parser>=3.0',
            'numpydoc>=1.7',
            'sphinx>=7.3',
        ],
        # Test arms of `python -m contact_estimation.studies arms`; the descriptions are 130 MB.
        'arms': ['example-robot-data', 'mujoco>=3.2', 'pin>=3.2'],
        # Kinematics of arms. The wheels need numpy 2; with ROS 2 Jazzy use ros-jazzy-pinocchio.
        'robots': ['pin>=3.2'],
        'fleet': [
            'distributed>=2023.12',
            'matplotlib>=3.6',
            'pyarrow>=14.0',
            'rosbags>=0.11',
        ],
        # The Jazzy line on PyPI; on a machine with /opt/ros leave this extra out.
        'ros': [
            'ros-jazzy-rclpy[fastrtps]==7.1.6',
            'ros-jazzy-diagnostic-msgs==5.3.6',
            'ros-jazzy-geometry-msgs==5.3.6',
            'ros-jazzy-rcl-interfaces==2.0.3',
            'ros-jazzy-sensor-msgs==5.3.6',
            'ros-jazzy-std-msgs==5.3.6',
            'ros-jazzy-std-srvs==5.3.6',
            'ros-jazzy-trajectory-msgs==5.3.6',
        ],
        'tools': [
            'matplotlib>=3.6',
            'rosbags>=0.11',
        ],
        # Needs numpy 2, for which the message packages of an installed ROS 2 Jazzy are not built.
        'watch': ['rerun-sdk>=0.28'],
        # The linters are those of ament_flake8, ament_pep257 and ament_mypy.
        'test': [
            'distributed>=2023.12',
            'flake8>=6.0',
            'flake8-blind-except',
            'flake8-builtins',
            'flake8-class-newline',
            'flake8-comprehensions',
            'flake8-deprecated',
            'flake8-import-order>=0.19',
            'flake8-quotes',
            'hypothesis>=6.100',
            'matplotlib>=3.6',
            'mypy>=1.9',
            'pin>=3.2',  # arms
            'pydocstyle>=6.3',
            'pytest>=7.4',
            'pytest-xdist>=3.7',
            'pyarrow>=14.0',
            'rerun-sdk>=0.28',
            'rosbags>=0.11',
            'setuptools',
            'types-PyYAML',
        ],
    },
    zip_safe=False,
    cmdclass={'install': Install},
)
