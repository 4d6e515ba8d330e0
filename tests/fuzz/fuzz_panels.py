"""Files of panel codes: NetCDF by xarray and HDF5, and WAMIT's text."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path

import numpy as np

from seatrial.errors import InputError
from seatrial_kits.panels.panel_files import read_panels


def one(data: bytes) -> None:
    """Read the bytes as a dataset, and as WAMIT's radiation and excitation."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("x.nc", "x.1", "x.3"):
            Path(folder, name).write_bytes(data)
        for name in ("x.nc", "x.1"):
            with contextlib.suppress(InputError):
                tables = read_panels(Path(folder, name), 1025.0, 9.81)
                assert np.isfinite(tables.added).all()
