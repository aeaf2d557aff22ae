# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The fleet's table: a row for each contact of each recording, as a Parquet file."""

from __future__ import annotations

from importlib import import_module
import io
from typing import Any, Iterator, Sequence

from .columns import COLUMNS
from .entry import Entry
from ..exceptions import MissingPackageError

_NO_EPISODE = {'episode': 0}


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
    for episode in outcome['episodes'] or [_NO_EPISODE]:
        yield {**common, **episode}


def _of_report(report: dict[str, Any]) -> dict[str, Any]:
    effects, fit = report['effects'], report['fit']
    low, high = fit['improvement_interval'] or (None, None)
    checks = report['checks']
    return {
        'verdict': report['verdict'],
        'names': [effect['name'] for effect in effects],
        'families': [effect['family'] for effect in effects],
        'probabilities': [effect['probability'] for effect in effects],
        'shares': [effect['share'] for effect in effects],
        'shares_low': [effect['share_interval'][0] for effect in effects],
        'shares_high': [effect['share_interval'][1] for effect in effects],
        'parameters': [{'effect': effect['name'], 'name': name, **value}
                       for effect in effects for name, value in effect['parameters'].items()],
        'remainder_share': (report['remainder'] or {}).get('share'),
        **_base_parameters(report),
        'noise_floor_n': fit['noise_floor_n'],
        **{f'force_rmse_{name}_n': value for name, value in fit['force_rmse_n'].items()},
        **{f'motion_rmse_{name}_m': value
           for name, value in (fit['motion_rmse_m'] or {}).items()},
        'improvement_low': low, 'improvement_high': high,
        'failed_checks': [check['name'] for check in checks if not check['ok']],
        'checks': checks,
    }


def _base_parameters(report: dict[str, Any]) -> dict[str, float | None]:
    corrected, recalibrated = report['corrected'], report['recalibrated']
    return {
        name: value for which in ('stiffness', 'damping') for name, value in (
            (f'corrected_{which}', corrected[which]['value']),
            (f'corrected_{which}_std', corrected[which]['std']),
            (f'recalibrated_{which}', recalibrated[which]),
        )
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
        for column in COLUMNS
    ])
