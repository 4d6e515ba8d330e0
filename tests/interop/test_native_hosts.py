"""All native FMUs in other people's hosts: the numbers of Python, to the bit.

Inputs change between steps, three times; those of text (faults, modes) once.
"""

from __future__ import annotations

import json
import logging
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_manipulation_toolbox.checker import OperationGenericCheck, OperationSemanticCheck
from fmu_manipulation_toolbox.operations import FMU

from seatrial.fmi.compiler import HERE

from .native_fmus import CHANGES, DRIVER, HEADERS, STEPS, Case, H, native_names

pytestmark = pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux")

Rows = list[list[float]]


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    return [Case(name) for name in native_names()]


def in_hosts_of_their_own(host: str, cases: list[Case], folder: Path) -> dict[str, Rows]:
    """Run all FMUs in one process, beside each other."""
    slaves = [
        {
            "name": case.name.replace("-", "_"),
            "path": shutil.copy(case.path, folder),
            "changes": [
                [it.step, it.type.__name__, it.name, it.reference, it.value] for it in case.changes
            ],
            "outputs": [[s.port.type.__name__, s.name, s.reference] for s in case.outputs],
        }
        for case in cases
    ]
    # ecos needs the library of the package tbb, which lies in the environment's lib.
    libraries = {"LD_LIBRARY_PATH": str(Path(sys.prefix) / "lib"), "TMPDIR": str(folder)}
    run = subprocess.run(
        [sys.executable, Path(__file__).with_name("native_host_run.py"), host],
        input=json.dumps({"step": H, "steps": STEPS, "slaves": slaves}),
        capture_output=True,
        text=True,
        env=os.environ | libraries,
        cwd=folder,
    )
    assert run.returncode == 0, run.stderr
    rows = json.loads(run.stdout.splitlines()[-1])
    return {case.name: rows[case.name.replace("-", "_")] for case in cases}


@pytest.mark.parametrize("host", ["libcosim", "ecos", "fmucontainer"])
def test_hosts_of_many(
    host: str, cases: list[Case], tmp_path: Path, subtests: pytest.Subtests
) -> None:
    found = in_hosts_of_their_own(host, cases, tmp_path)
    for case in cases:
        with subtests.test(component=case.name):
            assert found[case.name] == case.python(case.changes)


def signals(case: Case, changes: list[Any]) -> np.ndarray | None:
    """Return the table of inputs that FMPy reads: a row for each time, two where one changes."""
    if not changes:
        return None
    types = {it.name: it.type for it in changes}
    now = dict(zip(types, case.starts(list(types)), strict=True))
    rows = []
    for k in range(STEPS + 1):
        rows.append((k * H, *now.values()))
        now |= {it.name: it.value for it in changes if it.step == k}
        if k in CHANGES:
            rows.append((k * H, *now.values()))
    return np.array(rows, dtype=[("time", float), *types.items()])


def test_fmpy(cases: list[Case], subtests: pytest.Subtests) -> None:
    """FMPy's inputs are tables of numbers: those of text stay as they start."""
    for case in cases:
        changes = [it for it in case.changes if it.type is not str]
        names = [s.name for s in case.outputs]
        table = signals(case, changes)
        result = fmpy.simulate_fmu(
            str(case.path), stop_time=STEPS * H, output_interval=H, input=table, output=names
        )
        with subtests.test(component=case.name):
            expected = case.python(changes)
            assert [[float(row[name]) for name in names] for row in result[1:]] == expected
            assert len({tuple(row) for row in expected}) > 1


@pytest.mark.skipif(shutil.which("bwrap") is None, reason="bubblewrap is not installed")
def test_a_c_program_where_there_is_glibc_and_nothing_else(
    cases: list[Case], tmp_path: Path, subtests: pytest.Subtests
) -> None:
    """With the state saved half-way, restored and run again."""
    image = tmp_path / "image"
    jobs, libraries = [], []
    for case in cases:
        fmpy.extract(str(case.path), str(image / case.name))
        libraries.append(image / case.name / "binaries" / "linux64" / f"{case.path.stem}.so")
        jobs.append(case.job(f"/fmu/{libraries[-1].relative_to(image)}"))
    host = image / "host"
    flags = ["-Wall", "-Wextra", "-Werror", f"-I{HEADERS}"]
    subprocess.run(["cc", *flags, DRIVER, "-o", host, "-ldl"], check=True)
    ldd = subprocess.run(["ldd", host, *libraries], capture_output=True, text=True, check=True)
    # The loader's folder is /lib64; the C library's depends on the system.
    needed = sorted({word for word in ldd.stdout.split() if word.startswith("/lib")})
    names = {Path(each).name for each in needed}
    assert names == {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"}
    bound = [a for each in needed for a in ("--ro-bind", each, each)]
    inside = ["bwrap", "--unshare-all", "--clearenv", *bound, "--ro-bind", image, "/fmu"]
    run = subprocess.run(
        [*inside, "/fmu/host"], input="".join(jobs), capture_output=True, text=True
    )
    if "Operation not permitted" in run.stderr or "namespace" in run.stderr:
        pytest.skip("this system gives its users no namespaces")
    assert (run.returncode, run.stderr) == (0, "")
    rows = [[float.fromhex(text) for text in line.split()] for line in run.stdout.splitlines()]
    for at, case in enumerate(cases):
        with subtests.test(component=case.name):
            assert rows[at * STEPS : (at + 1) * STEPS] == case.python(case.changes)


def test_checkers_have_nothing_to_say(
    cases: list[Case], caplog: pytest.LogCaptureFixture, subtests: pytest.Subtests
) -> None:
    """FMPy's, and what `fmutool -check` runs."""
    caplog.set_level(logging.WARNING)
    for case in cases:
        with subtests.test(component=case.name):
            assert validate_fmu(str(case.path)) == []
            fmu = FMU(str(case.path))
            for check in (OperationGenericCheck(), OperationSemanticCheck()):
                fmu.apply_operation(check)
            assert caplog.text == ""
