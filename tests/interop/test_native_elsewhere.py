"""All native FMUs, compiled for other machines here and run as those would: Windows, AArch64.

Where their emulator is not installed they are not run: on Debian, `wine64` and `wine`; `qemu-user`
and `libc6-arm64-cross`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

import pytest

from seatrial.fmi.cache import cache_folder
from seatrial.fmi.compiler import HERE, TARGETS, library

from .native_fmus import DRIVER, HEADERS, STEPS, Case, native_names

pytest.importorskip("ziglang")
pytestmark = [
    pytest.mark.long,  # Zig builds the C libraries of other systems first: minutes
    pytest.mark.skipif(HERE != "linux64", reason="compares with libraries of Linux"),
]

ARM = Path("/usr/aarch64-linux-gnu")
WITHIN = 1e-12
"""Of a value, or of 1 if it is smaller: mathematics of another library, 1.3e-13 at most seen."""


def host_for(platform: str, folder: Path) -> Path:
    """Compile the host for a platform."""
    target, host = TARGETS[platform][0], folder / "host.exe"
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, f"-I{HEADERS}"]
    command += [str(DRIVER), "-o", str(host), *([] if platform == "win64" else ["-ldl"])]
    zig = {"ZIG_GLOBAL_CACHE_DIR": str(cache_folder("zig")), "ZIG_LOCAL_CACHE_DIR": str(folder)}
    subprocess.run(command, check=True, env=os.environ | zig)
    return host


def differences(
    platform: str, emulator: Sequence[str], folder: Path, environment: dict[str, str]
) -> dict[str, float]:
    """Return how far each component's trajectory is from Python's at most, by name."""
    cases, jobs = [Case(name) for name in native_names()], []
    for case in cases:
        with zipfile.ZipFile(case.path) as archive:
            sources = {Path(n).name: archive.read(n) for n in archive.namelist() if "sources/" in n}
        path = folder / f"{case.name}{TARGETS[platform][1]}"
        path.write_bytes(library(sources, platform))
        jobs.append(case.job(path.name if platform == "win64" else str(path)))
    run = subprocess.run(
        [*emulator, host_for(platform, folder)],
        input="".join(jobs), capture_output=True, text=True, cwd=folder, env=environment,
    )  # fmt: skip
    assert (run.returncode, run.stderr) == (0, "")
    rows = [[float.fromhex(text) for text in line.split()] for line in run.stdout.splitlines()]
    assert len(rows) == len(cases) * STEPS
    found = {}
    for at, case in enumerate(cases):
        pairs = zip(rows[at * STEPS :], case.python(case.changes), strict=False)
        found[case.name] = max(
            abs(a - b) / max(1.0, abs(b))
            for one, other in pairs
            for a, b in zip(one, other, strict=True)
        )
    print(f"{platform}: {sum(v == 0.0 for v in found.values())} of {len(found)} to the bit")
    return found


@pytest.mark.skipif(shutil.which("wine") is None, reason="wine is not installed")
def test_windows(tmp_path: Path) -> None:
    """Libraries that Wine loads, with Windows' mathematics (its C runtime is Wine's own)."""
    environment = {**os.environ, "WINEPREFIX": str(tmp_path / "wine"), "WINEDEBUG": "-all"}
    subprocess.run(["wineboot", "-i"], env=environment, capture_output=True, check=True)
    try:
        found = differences("win64", ["wine"], tmp_path, environment)
    finally:
        subprocess.run(["wineserver", "-k"], env=environment, check=False)
    assert {name: far for name, far in found.items() if far > WITHIN} == {}


@pytest.mark.skipif(
    shutil.which("qemu-aarch64") is None or not ARM.is_dir(),
    reason="qemu-user or libc6-arm64-cross is not installed",
)
def test_linux_on_arm(tmp_path: Path) -> None:
    """Libraries that an emulated AArch64 loads, with Debian's glibc for it."""
    found = differences(
        "aarch64-linux", ["qemu-aarch64", "-L", str(ARM)], tmp_path, dict(os.environ)
    )
    assert {name: far for name, far in found.items() if far > WITHIN} == {}
