"""Memory and undefined behaviour: all native FMUs by a C program, and the master in C."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest

from seatrial.fmi.compiler import FLAGS, HERE
from seatrial.fmi.components.index import component_class, components
from seatrial_kits.native.carriers import why_refused

from .native_fmus import DRIVER, HEADERS, STEPS, Case, native_names

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux"),
]

CHECKS = ["-g", "-DLINKED", "-fsanitize=address,undefined", "-fno-sanitize-recover"]
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]


def rows_of(output: str) -> list[list[float]]:
    return [[float.fromhex(text) for text in line.split()] for line in output.splitlines()]


# By the class alone: to translate all of them takes seconds of each collection.
@pytest.mark.parametrize(
    "name", [n for n in components().names() if not why_refused(component_class(n))]
)
def test_sanitizers_find_nothing(name: str, tmp_path: Path) -> None:
    """The same sources with the compiler's checks at run time give the same numbers."""
    if name not in native_names():
        pytest.skip("it has no C")
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


MASTER = f"""\
import sys
import pytest
import seatrial.sim.compiled.library as own

plain = own.shared_library
own.shared_library = lambda kind, source, flags: plain(kind, source, (*flags, *{CHECKS!r}))
assert own.library() is not None
sys.exit(pytest.main(["-q", "tests/cosim/test_compiled.py"]))
"""


def test_sanitizers_find_nothing_in_the_master(tmp_path: Path) -> None:
    """Its own tests, with its library compiled with the compiler's checks at run time."""
    runtimes = [
        subprocess.run(
            ["cc", f"-print-file-name={name}"], capture_output=True, text=True, check=True
        ).stdout.strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    # What Python itself keeps until its end is no leak of the master, which allocates nothing.
    checks = {"LD_PRELOAD": " ".join(runtimes), "ASAN_OPTIONS": "detect_leaks=0"}
    own = {"SEATRIAL_CACHE": str(tmp_path), "PYTEST_ADDOPTS": f"--basetemp={tmp_path / 'run'}"}
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST_")}
    run = subprocess.run(
        [sys.executable, "-c", MASTER],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        env=environment | checks | own,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert "runtime error" not in run.stderr
    assert "ERROR: AddressSanitizer" not in run.stderr
