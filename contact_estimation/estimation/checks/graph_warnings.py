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

"""What the graph of ROS shows: several publishers of a measurement, several nodes of one name."""

from __future__ import annotations

from typing import Mapping, Sequence


def graph_warnings(
    publishers: Mapping[str, Sequence[str]], node: str, nodes: Sequence[str]
) -> dict[str, str]:
    """
    Return warnings by name, the most important first.

    Parameters
    ----------
    publishers : mapping of str to sequence of str
        By topic, the nodes that publish there; of topics that need exactly one.
    node : str
        Name of this node, with its namespace.
    nodes : sequence of str
        Names of all nodes; one as often as there are nodes of it.

    """
    found = {}
    for topic, names in publishers.items():
        if len(names) > 1:
            found[f'several_publishers_{topic.rsplit("/", 1)[-1]}'] = (
                f'{len(names)} publishers on the topic {topic} ({", ".join(sorted(names))}): '
                'their samples mix; stop or remap all but one')
    same = sum(name == node for name in nodes)
    if same > 1:
        found['node_name'] = (
            f'{same} nodes are called {node}: their outputs mix, and services and parameters '
            'reach any of them; start the others as -r __node:=NAME, or stop them')
    return found
