# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which topics and fields the layouts of other viewers read, and what a recording has of them."""

import json
from pathlib import Path
import re
from typing import Any, Iterator
from xml.etree import ElementTree

from contact_estimation.recordings import RecordingReader

CONFIG = Path(__file__).resolve().parent.parent / 'config'


def of_foxglove(layout: str) -> set[tuple[str, str]]:
    """Return topic and field of every path; no field for a panel that shows a whole topic."""
    read = set()
    for panel in json.loads(layout)['configById'].values():
        for path in panel.get('paths', ()):
            topic, _, field = re.sub(r'\.@\w+$', '', path['value']).partition('.')
            read.add((topic, field))
        if 'topicToRender' in panel:
            read.add((panel['topicToRender'], ''))
    return read


def of_plotjuggler(layout: str, topics: list[str]) -> set[tuple[str, str]]:
    """Return topic and field of every series that an equation reads, or the series itself."""
    read = set()
    for snippet in ElementTree.fromstring(layout.encode()).iter('snippet'):
        sources = [snippet.findtext('linked_source') or '']
        sources += [element.text or '' for element in snippet.iterfind('additional_sources/*')]
        for source in sources:
            topic = next((t for t in topics if source.startswith(f'{t}/')), source)
            read.add((topic, source[len(topic) + 1:].replace('/', '.')))
    return read


class RecordedFields:
    """The first message of every topic of a recording, read by rosbags."""

    def __init__(self, recording: Path, typestore: Any) -> None:
        reader = RecordingReader(recording)
        types = reader.topics()
        self._messages: dict[str, Any] = {}
        for topic, _, data in reader.messages():
            if topic not in self._messages:
                self._messages[topic] = typestore.deserialize_cdr(data, types[topic])

    @property
    def topics(self) -> list[str]:
        """Topics with a message, the longest first."""
        return sorted(self._messages, key=len, reverse=True)

    def has(self, topic: str, field: str) -> bool:
        """Return whether there is such a field, of any type where none is given."""
        if topic not in self._messages:
            return False
        value = self._messages[topic]
        names = list(getattr(value, 'name', ()))
        if field.split('.')[0] in names:  # PlotJuggler's name of a joint
            joint, _, quantity = field.partition('.')
            value, field = getattr(value, quantity)[names.index(joint)], ''
        for step in _steps(field):
            try:
                value = value[step] if isinstance(step, int) else getattr(value, step)
            except (AttributeError, IndexError):
                return False
        return not field or isinstance(value, (float, str)) or hasattr(value, '__float__')


def _steps(field: str) -> Iterator[str | int]:
    for name, place in re.findall(r'(\w+)(?:\[(\d+)\])?', field):
        yield name
        if place:
            yield int(place)
