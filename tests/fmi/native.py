"""Slaves in C, compiled into FMUs with FMPy's headers; and FMUs that differ from them a little."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

import fmpy

from seatrial.fmi.instance import Instance

SLAVES = Path(__file__).parent / "slaves"


def build_native_fmu(name: str, folder: Path) -> Path:
    """Compile ``slaves/NAME.c`` into ``folder/NAME.fmu``, described by ``slaves/NAME.xml``."""
    headers = Path(fmpy.__file__).parent / "c-code"
    folder.mkdir(parents=True, exist_ok=True)
    library, path = folder / f"{name}.so", folder / f"{name}.fmu"
    source = SLAVES / f"{name}.c"
    subprocess.run(
        ["cc", "-shared", "-fPIC", "-O1", "-w", f"-I{headers}", source, "-o", library, "-lm"],
        check=True,
    )
    description = (SLAVES / f"{name}.xml").read_bytes()
    platform = fmpy.platform_tuple if b'fmiVersion="3.0"' in description else fmpy.platform
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(library, f"binaries/{platform}/{name}.so")
    return path


def changed(path: Path, to: Path, *changes: tuple[str, str]) -> Path:
    """Copy an FMU to ``to`` with texts in its model description replaced."""
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(to, "w") as new:
        for member in old.infolist():
            data = old.read(member)
            if member.filename == "modelDescription.xml":
                for before, after in changes:
                    assert before.encode() in data, before
                    data = data.replace(before.encode(), after.encode())
            new.writestr(member, data)
    return to


def described_fmu(path: Path, text: str | bytes) -> Path:
    """Write an FMU that has nothing but a model description."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", text)
    return path


def started(instance: Instance, **values: object) -> Instance:
    """Initialise an instance with start values, and begin."""
    instance.set_start(values)  # type: ignore[arg-type]
    instance.initialise(0.0, 10.0)
    instance.begin()
    return instance


def read(instance: Instance, *names: str) -> list[object]:
    """Return the values of some variables."""
    return instance.reader(names)()
