"""Parquet export, for pandas, Polars, DuckDB, MATLAB and PlotJuggler."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.fmi.cache import write_named
from seatrial.trial.records.run_folder import Run

from .record import columns, nanoseconds

TIME = "time_ns"
"""Column of the simulated time."""
INSTALL = 'pip install "seatrial[parquet]"'


def write_parquet(run: Run, path: Path) -> None:
    """Write the record of a run as a Parquet file: same record, same bytes.

    The first column is the simulated time in whole ns; the others are the signals by their
    names, of their own types, with unit and description in the fields' metadata. The manifest is
    in the file's metadata, under ``seatrial.manifest``. Raises InputError if pyarrow is missing.
    """
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise InputError(f"Parquet needs pyarrow, which is not installed: {INSTALL}") from None

    types: dict[str, Any] = {
        "Real": pa.float64(),
        "Integer": pa.int32(),
        "Boolean": pa.bool_(),
        "String": pa.string(),
        "Binary": pa.binary(),
    }
    fields = [pa.field(TIME, pa.int64(), metadata={"unit": "ns", "description": "simulated time"})]
    values = [pa.array(nanoseconds(run), pa.int64())]
    for signal in columns(run):
        about = {"unit": signal.unit, "description": signal.description}
        fields.append(pa.field(signal.name, types[signal.type], metadata=about))
        values.append(pa.array(signal.values, types[signal.type]))
    about = {"seatrial.manifest": json.dumps(run.manifest, ensure_ascii=False)}
    table = pa.Table.from_arrays(values, schema=pa.schema(fields, metadata=about))
    content = io.BytesIO()
    parquet.write_table(table, content, compression="zstd")
    write_named(path, content.getvalue())
