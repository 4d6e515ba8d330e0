"""Files of values over time, CSV and Parquet."""

from __future__ import annotations

import contextlib
import math
import tempfile
from pathlib import Path

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.components.source import table_source


def one(data: bytes) -> None:
    """Read the bytes as each kind of file; what is read plays finite values, or refuses."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("x.csv", "x.parquet"):
            path = Path(folder) / name
            path.write_bytes(data)
            with contextlib.suppress(InputError, SimulationError):  # between 1e308 and -1e308
                _play(path)


def _play(path: Path) -> None:
    component = table_source(path).component_class()("x")
    component.set("beyond", "hold")
    component.setup(0.0)
    component.initialise()
    component.begin()
    component.advance(0.0, 0.5)
    reals = [v for v in component.values if isinstance(v, float)]
    assert all(map(math.isfinite, reals))
