# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The fleet's table: recordings in order of time, a row for each contact, as Parquet."""

from dataclasses import dataclass, replace
from importlib import import_module
import io
from typing import Any, Iterable, Iterator, NamedTuple, Sequence

from .discovery import FoundRecording
from .one_recording import Outcome
from ..exceptions import MissingPackageError
from ..recordings.bag_folder import natural_order


class Column(NamedTuple):
    """A column of the table."""

    name: str  # in the file
    kind: str  # 'text', 'integer', 'number', 'time', 'texts', 'numbers', 'checks' or 'parameters'
    unit: str  # SI; '' for what has none
    meaning: str  # in words; of an episode or, by default, of the whole recording


COLUMNS = (
    Column('recording', 'text', '', 'path as found'),
    Column('episode', 'integer', '', 'contact, from 1; 0 in the row of a recording without one'),
    Column('group', 'text', '', 'from --group-by'),
    Column('number', 'integer', '', 'place of the recording in time, from 1'),
    Column('start', 'time', 'ns', 'stamp of the first sample'),
    Column('duration_s', 'number', 's', 'from the first sample to the last'),
    Column('begin_s', 'number', 's', 'begin of the episode, since `start`'),
    Column('end_s', 'number', 's', 'end of the episode, since `start`'),
    Column('status', 'text', '', 'of the estimator at the end of the episode'),
    Column('reason', 'text', '', 'for that status, such as why an estimate is withheld'),
    Column('stiffness', 'number', 'N/m', 'K_e estimated on line, at the end of the episode'),
    Column('stiffness_std', 'number', 'N/m', 'standard deviation of `stiffness`'),
    Column('damping', 'number', 'N s/m', 'B_e estimated on line, at the end of the episode'),
    Column('damping_std', 'number', 'N s/m', 'standard deviation of `damping`'),
    Column('model_fit', 'number', '1', 'rms of the residual over that of the noise'),
    Column('verdict', 'text', '', 'of the diagnosis'),
    Column('names', 'texts', '', 'effects named, strongest first'),
    Column('families', 'texts', '', 'family of each name'),
    Column('probabilities', 'numbers', '1', 'that the family of each name is right'),
    Column('shares', 'numbers', '1', 'part of the mismatch that each name explains'),
    Column('shares_low', 'numbers', '1', 'lower end of the 95 % interval of each share'),
    Column('shares_high', 'numbers', '1', 'upper end of the 95 % interval of each share'),
    Column('parameters', 'parameters', 'each its own', 'fitted parameters of the names'),
    Column('remainder_share', 'number', '1', 'part of the mismatch that no name explains'),
    Column('corrected_stiffness', 'number', 'N/m', 'K_e fitted together with the names'),
    Column('corrected_stiffness_std', 'number', 'N/m', 'its standard deviation'),
    Column('corrected_damping', 'number', 'N s/m', 'B_e fitted together with the names'),
    Column('corrected_damping_std', 'number', 'N s/m', 'its standard deviation'),
    Column('recalibrated_stiffness', 'number', 'N/m', 'K_e refitted without names'),
    Column('recalibrated_damping', 'number', 'N s/m', 'B_e refitted without names'),
    Column('noise_floor_n', 'number', 'N', 'noise of the force'),
    Column('force_rmse_nominal_n', 'number', 'N', 'held-out error of the given model'),
    Column('force_rmse_recalibrated_n', 'number', 'N', 'held-out error of the refitted model'),
    Column('force_rmse_corrected_n', 'number', 'N', 'held-out error of the model with names'),
    Column('motion_rmse_nominal_m', 'number', 'm', 'held-out error of the given model'),
    Column('motion_rmse_recalibrated_m', 'number', 'm', 'held-out error of the refitted model'),
    Column('motion_rmse_corrected_m', 'number', 'm', 'held-out error of the model with names'),
    Column('improvement_low', 'number', '1', 'lower end of the 95 % interval of '
           '1 - corrected / recalibrated'),
    Column('improvement_high', 'number', '1', 'its upper end'),
    Column('failed_checks', 'texts', '', 'names of the checks that failed'),
    Column('checks', 'checks', '', 'all checks: name, ok, text'),
    Column('diagnosed_s', 'number', 's', 'length of the part that was diagnosed'),
    Column('page', 'text', '', 'page of the diagnosis, relative to the table'),
    Column('error', 'text', '', 'why there is no result; empty where there is one'),
    Column('version', 'text', '', 'of contact_estimation'),
    Column('sha256', 'text', '', 'of the recording'),
    Column('model_sha256', 'text', '', 'of the parameters of the nominal model'),
)


@dataclass(frozen=True)
class Entry:
    """A recording and its results."""

    name: str  # path as found
    path: str  # absolute path
    group: str  # robot, wall or day
    sha256: str  # of its content; '' if that could not be read
    outcome: Outcome  # results of a worker
    page: str = ''  # page of its diagnosis, relative to the folder of the run; '' if there is none
    number: int = 0  # place in time, from 1

    @classmethod
    def of(cls, found: FoundRecording, sha256: str, outcome: Outcome, page: str) -> 'Entry':
        """Return the entry of a found recording, without its number."""
        return cls(found.name, found.path, found.group, sha256, outcome, page)

    @property
    def report(self) -> dict[str, Any] | None:
        """Return the diagnosis; None if there is none, or if a check refused the recording."""
        report: dict[str, Any] | None = self.outcome['report']
        refused = report is not None and report['fit']['noise_floor_n'] is None
        return None if refused else report

    @property
    def names(self) -> list[str]:
        """Names of the effects, strongest first."""
        return [effect['name'] for effect in self.effects]

    @property
    def families(self) -> list[str]:
        """Families of the named effects, strongest first."""
        return list(dict.fromkeys(effect['family'] for effect in self.effects))

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Return the named effects."""
        return list(self.report['effects']) if self.report else []

    def corrected(self, name: str) -> tuple[float, float] | None:
        """Return a fitted parameter of the wall."""
        if self.report is None:
            return None
        found = self.report['corrected'][name]
        if found['value'] is None or found['std'] is None:
            return None
        return found['value'], found['std']


def distinct(entries: Iterable[Entry]) -> list[Entry]:
    """Leave out copies: the same content proves nothing a second time."""
    seen: dict[str, Entry] = {}
    for place, entry in enumerate(entries):
        seen.setdefault(entry.sha256 or f'unread {place}', entry)
    return list(seen.values())


def in_time(entries: Iterable[Entry]) -> list[Entry]:
    """Sort recordings by their first stamps, and number them."""
    named = sorted(entries, key=lambda entry: (entry.group, natural_order(entry.name)))
    order = sorted(range(len(named)), key=lambda place: (_start(named, place), place))
    return [replace(named[place], number=number) for number, place in enumerate(order, 1)]


def _start(named: Sequence[Entry], place: int) -> float:
    """Return the first stamp [ns], or that between the neighbours of the group that have one."""
    own: int | None = named[place].outcome['start_ns']
    if own is not None:
        return own
    sides = (range(place - 1, -1, -1), range(place + 1, len(named)))
    stamps = [next((named[k].outcome['start_ns'] for k in side
                    if named[k].group == named[place].group
                    and named[k].outcome['start_ns'] is not None), None) for side in sides]
    known = [stamp for stamp in stamps if stamp is not None]
    return sum(known) / len(known) if known else -1.0


def as_parquet(entries: Sequence[Entry], model_sha256: str) -> bytes:
    """Return the table as the content of a Parquet file."""
    pyarrow = require_pyarrow()
    rows = [row for entry in entries for row in rows_of(entry, model_sha256)]
    table = pyarrow.Table.from_pylist(rows, schema=_schema(pyarrow))
    stream = io.BytesIO()
    import_module('pyarrow.parquet').write_table(table, stream, compression='zstd')
    return stream.getvalue()


def require_pyarrow() -> Any:
    """Import pyarrow."""
    try:
        import pyarrow
    except ModuleNotFoundError as error:
        raise MissingPackageError.of('pyarrow', 'the table of fleet') from error
    except ImportError as error:
        raise MissingPackageError(
            f'the table of fleet needs pyarrow, and the installed one fails: {error}; for numpy '
            '1.26 install one that fits with: pip install "pyarrow<25"') from error
    return pyarrow


def rows_of(entry: Entry, model_sha256: str) -> Iterator[dict[str, Any]]:
    """Yield the rows of a recording."""
    outcome, report = entry.outcome, entry.outcome['report']
    common = {
        'recording': entry.name, 'group': entry.group, 'number': entry.number,
        'start': outcome['start_ns'], 'duration_s': outcome['duration_s'],
        'diagnosed_s': outcome['diagnosed_s'], 'page': entry.page, 'error': outcome['error'],
        'version': outcome['version'], 'sha256': entry.sha256 or None,
        'model_sha256': model_sha256, **(_of_report(report) if report else {}),
    }
    for episode in outcome['episodes'] or [{'episode': 0}]:
        yield {**common, **episode}


_BASE = 'stiffness', 'damping'


def _of_report(report: dict[str, Any]) -> dict[str, Any]:
    effects, fit, checks = report['effects'], report['fit'], report['checks']
    low, high = fit['improvement_interval'] or (None, None)
    return {
        'verdict': report['verdict'],
        **{column: [effect[key] for effect in effects] for column, key in (
            ('names', 'name'), ('families', 'family'), ('probabilities', 'probability'),
            ('shares', 'share'))},
        'shares_low': [effect['share_interval'][0] for effect in effects],
        'shares_high': [effect['share_interval'][1] for effect in effects],
        'parameters': [{'effect': effect['name'], 'name': name, **value}
                       for effect in effects for name, value in effect['parameters'].items()],
        'remainder_share': (report['remainder'] or {}).get('share'),
        **{f'corrected_{which}{end}': report['corrected'][which][part] for end, part in (
            ('', 'value'), ('_std', 'std')) for which in _BASE},
        **{f'recalibrated_{which}': report['recalibrated'][which] for which in _BASE},
        'noise_floor_n': fit['noise_floor_n'],
        **{f'force_rmse_{name}_n': value for name, value in fit['force_rmse_n'].items()},
        **{f'motion_rmse_{name}_m': value
           for name, value in (fit['motion_rmse_m'] or {}).items()},
        'improvement_low': low, 'improvement_high': high,
        'failed_checks': [check['name'] for check in checks if not check['ok']],
        'checks': checks,
    }


def _schema(pyarrow: Any) -> Any:
    text, number = pyarrow.string(), pyarrow.float64()
    kinds = {
        'text': text, 'integer': pyarrow.int32(), 'number': number,
        'time': pyarrow.timestamp('ns', tz='UTC'),
        'texts': pyarrow.list_(text), 'numbers': pyarrow.list_(number),
        'checks': pyarrow.list_(pyarrow.struct(
            [('name', text), ('ok', pyarrow.bool_()), ('text', text)])),
        'parameters': pyarrow.list_(pyarrow.struct(
            [('effect', text), ('name', text), ('value', number), ('std', number),
             ('unit', text)])),
    }
    return pyarrow.schema([
        pyarrow.field(column.name, kinds[column.kind],
                      metadata={'unit': column.unit, 'meaning': column.meaning})
        for column in COLUMNS])
