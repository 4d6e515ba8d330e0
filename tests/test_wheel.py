"""The wheel in an empty environment: a trial from an empty folder."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.interop
@pytest.mark.parametrize("downloads", [False, pytest.param(True, marks=pytest.mark.long)])
def test_the_wheel_alone_runs_a_trial(downloads: bool, tmp_path: Path) -> None:
    """Its requirements are those of this environment, or as a user's pip finds them."""
    build = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--quiet"]
    subprocess.run([*build, "--wheel-dir", str(tmp_path), str(ROOT)], check=True)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    for shipped in (
        "docs/core.md",
        "fmus/index.toml",
        "harness/trials/hydrone-landing.toml",
        "harness/vehicles/hydrone/vehicle.toml",
        "harness/vehicles/hydrone/pilot.toml",
        "hil_profiles/hydrone.toml",
        "harness/kits/videoray/vehicles/tether/vehicle.toml",
    ):
        assert f"seatrial/_shipped/{shipped}" in names
    for name in (
        "py.typed",
        "physics/sail_naca0015.csv",
    ):
        assert f"seatrial/{name}" in names
    for template in sorted((ROOT / "src/seatrial/templates").rglob("*")):
        assert template.is_dir() or template.relative_to(ROOT / "src").as_posix() in names
    environment = tmp_path / "environment"
    subprocess.run([sys.executable, "-m", "venv", str(environment)], check=True)
    pip = [str(environment / "bin" / "python"), "-m", "pip", "install", "--quiet"]
    if downloads:
        subprocess.run([*pip, str(wheel)], check=True)
    else:
        subprocess.run([*pip, "--no-deps", str(wheel)], check=True)
        (packages,) = environment.glob("lib/python*/site-packages")
        # By this line alone: the .pth file there that names this source is not read.
        (packages / "requirements.pth").write_text(sysconfig.get_path("purelib") + "\n", "utf-8")
    where = [str(environment / "bin" / "python"), "-c", "import seatrial; print(seatrial.__file__)"]
    imported = subprocess.run(where, check=True, capture_output=True, text=True).stdout
    assert imported.startswith(str(environment))
    empty = tmp_path / "empty"
    empty.mkdir()
    done = subprocess.run(
        [str(environment / "bin" / "seatrial"), "run", "hydrone-landing", "--out", "run"],
        cwd=empty, capture_output=True, text=True, check=False,
        env={**os.environ, "SEATRIAL_CACHE": str(tmp_path / "cache")},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr  # it heels too far, as published
    assert "roll stays below 10 degrees" in done.stdout
    assert (empty / "run" / "report.html").stat().st_size > 1_000_000
