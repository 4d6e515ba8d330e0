"""Small tables of answers in Parquet."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from seatrial_kits.campaigns.table import arrow


def write_columns(path: Path, columns: Mapping[str, Any], units: Mapping[str, str]) -> None:
    """Write columns (lists or arrays of one length), each with the unit of its numbers if any."""
    pyarrow, parquet = arrow()
    arrays = [pyarrow.array(values) for values in columns.values()]
    fields = [
        pyarrow.field(name, array.type, metadata={"unit": units[name]} if units.get(name) else None)
        for name, array in zip(columns, arrays, strict=True)
    ]
    parquet.write_table(pyarrow.table(arrays, schema=pyarrow.schema(fields)), path)
