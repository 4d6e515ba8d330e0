"""FMUs and SSP packages: archives, model descriptions and system structures of others."""

from __future__ import annotations

import contextlib
import os
import tempfile
import zipfile
from pathlib import Path

from seatrial.errors import InputError
from seatrial.fmi.loading import load
from seatrial.fmi.loading.sources import read_build
from seatrial_kits.interchange.ssp.reading import read_ssp

_DESCRIPTION, _STRUCTURE = "modelDescription.xml", "SystemStructure.ssd"


def one(data: bytes) -> None:
    """Read the bytes as an archive, and as the file of one that says what the rest is."""
    with tempfile.TemporaryDirectory() as folder:
        before = os.environ.get("SEATRIAL_CACHE")
        os.environ["SEATRIAL_CACHE"] = f"{folder}/cache"
        try:
            _read(Path(folder), data)
        finally:
            load._load.cache_clear()
            os.environ.pop("SEATRIAL_CACHE")
            if before is not None:
                os.environ["SEATRIAL_CACHE"] = before
        assert {path.name for path in Path(folder).iterdir()} <= {"cache", "x.fmu", "x.ssp"}


def _read(folder: Path, data: bytes) -> None:
    fmu, ssp = folder / "x.fmu", folder / "x.ssp"
    is_archive = data.startswith(b"PK")
    for path, member in ((fmu, _DESCRIPTION), (ssp, _STRUCTURE)):
        if is_archive:
            path.write_bytes(data)
        else:
            with zipfile.ZipFile(path, "w") as archive:
                archive.writestr(member, data)
    with contextlib.suppress(InputError):
        read_build(load.load_fmu(fmu))
    with contextlib.suppress(InputError):
        read_ssp(ssp)
