"""Memory and undefined behaviour: all native FMUs by a C program, and the master in C."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest

from seatrial.fmi.native.compiler import FLAGS, HERE

from .native_fmus import DRIVER, HEADERS, STEPS, Case, native_names

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux"),
]

CHECKS = ["-g", "-DLINKED", "-fsanitize=address,undefined", "-fno-sanitize-recover"]
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]


def rows_of(output: str) -> list[list[float]]:
    return [[float.fromhex(text) for text in line.split()] for line in output.splitlines()]


@pytest.mark.parametrize("name", native_names())
def test_sanitizers_find_nothing(name: str, tmp_path: Path) -> None:
    """The same sources with the compiler's checks at run time give the same numbers."""
    case = Case(name)
    with zipfile.ZipFile(case.path) as archive:
        archive.extractall(tmp_path)
    sources = sorted((tmp_path / "sources").glob("*.c"))
    same = [flag for flag in FLAGS if flag not in ("-O2", "-shared", "-fvisibility=hidden")]
    headers = [f"-I{HEADERS}", f"-I{tmp_path / 'sources'}"]
    program = tmp_path / "checked"
    command = ["cc", *same, *headers, *CHECKS, DRIVER, *sources, "-o", program, "-lm"]
    subprocess.run(command, check=True)
    run = subprocess.run([program], input=case.job("-"), capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")
    assert rows_of(run.stdout) == case.python(case.changes)


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
def test_valgrind_finds_nothing(tmp_path: Path) -> None:
    """No memory that is lost or not freed, nothing read that was not written, in any library."""
    jobs, expected = [], []
    for name in native_names():
        case = Case(name)
        fmpy.extract(str(case.path), str(tmp_path / name))
        jobs.append(case.job(f"{tmp_path}/{name}/binaries/linux64/{case.path.stem}.so"))
        expected += case.python(case.changes)
    host = tmp_path / "host"
    subprocess.run(["cc", "-g", f"-I{HEADERS}", DRIVER, "-o", host, "-ldl"], check=True)
    kinds = ["--leak-check=full", "--show-leak-kinds=all", "--errors-for-leak-kinds=all"]
    command = ["valgrind", "--quiet", "--error-exitcode=9", *kinds, host]
    run = subprocess.run(command, input="".join(jobs), capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")
    assert len(expected) == len(native_names()) * STEPS
    assert rows_of(run.stdout) == expected
