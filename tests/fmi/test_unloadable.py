"""FMUs whose binaries need what this machine does not have: the message says what."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest

from seatrial.errors import InputError
from seatrial.fmi.loading.load import load_fmu, open_instance

from .native import SLAVES


def _fmu(folder: Path, source: str, *linked: str) -> Path:
    """Return an FMU whose library comes from ``source`` and is linked with others."""
    (folder / "x.c").write_text(source)
    library, path = folder / "x.so", folder / "x.fmu"
    flags = ["-shared", "-fPIC", "-Wl,--no-as-needed", "-Wl,-z,now"]
    subprocess.run(["cc", *flags, folder / "x.c", *linked, "-o", library], check=True, cwd=folder)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", (SLAVES / "fmi2.xml").read_bytes())
        archive.write(library, f"binaries/{fmpy.platform}/fmi2.so")
    return path


@pytest.mark.parametrize(
    ("library", "package"),
    [
        ("libgfortran.so.3", "libgfortran3, which"),
        ("libnautilus.so.7", "libnautilus7"),
        ("libfoam2.so.1", "libfoam2-1"),
        ("libcrypto.so.1.0.0", "libssl1.0.0"),
    ],
)
def test_a_missing_shared_library(library: str, package: str, tmp_path: Path) -> None:
    other = tmp_path / library
    (tmp_path / "other.c").write_text("int other;")
    names = ["-shared", "-fPIC", f"-Wl,-soname,{library}"]
    subprocess.run(["cc", *names, tmp_path / "other.c", "-o", other], check=True)
    path = _fmu(tmp_path, "int own;", f"./{library}")
    other.rename(tmp_path / "elsewhere")
    expected = rf"x\.fmu: .*fmi2\.so cannot be loaded .*: it needs the shared library {library}, .*{package}"
    with pytest.raises(InputError, match=expected):
        open_instance(load_fmu(path), "x")


def test_a_missing_symbol(tmp_path: Path) -> None:
    path = _fmu(tmp_path, "extern int keel(void); int own(void) { return keel(); }")
    with pytest.raises(InputError, match=r"it needs the symbol keel, which none of its libraries"):
        open_instance(load_fmu(path), "x")


def test_what_is_no_library(tmp_path: Path) -> None:
    path = _fmu(tmp_path, "int own;")
    with zipfile.ZipFile(tmp_path / "y.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", (SLAVES / "fmi2.xml").read_bytes())
        archive.write(path, f"binaries/{fmpy.platform}/fmi2.so")
    with pytest.raises(InputError, match=r"fmi2\.so cannot be loaded on this machine: .*ELF|short"):
        open_instance(load_fmu(tmp_path / "y.fmu"), "x")
