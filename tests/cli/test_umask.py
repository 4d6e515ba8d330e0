"""Files and folders have the permissions that the umask leaves, whoever wrote them."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from tests.kit import needs_kits

SEATRIAL = str(Path(sys.executable).with_name("seatrial"))
RIG = 'step = "100 ms"\n[components]\nsail = { fmu = "sail-control" }\n'
TRIAL = 'rig = "rig.toml"\nstop = "300 ms"\n'
CAMPAIGN = 'trials = ["trial.toml"]\n[grid]\nseed = [1, 2]\n'
COMMANDS = (
    ("run", "trial.toml", "--out", "run"),
    ("run", "campaign.toml", "--engine", "direct", "--out", "campaign"),
    ("run", "campaign.toml", "--engine", "direct", "--keep", "all", "--out", "table"),
    ("export", "run", "--parquet"),
    ("fmu", "build", "sail-control", "--out", "fmus"),
)


@pytest.mark.slow
@needs_kits("campaigns", "logs")
@pytest.mark.parametrize("umask", [0o027, 0o002])
def test_the_umask_decides(tmp_path: Path, umask: int) -> None:
    tmp_path.chmod(0o777)
    for name, text in (("rig", RIG), ("trial", TRIAL), ("campaign", CAMPAIGN)):
        (tmp_path / f"{name}.toml").write_text(text, "utf-8")
    given = set(tmp_path.rglob("*"))
    environment = {**os.environ, "SEATRIAL_CACHE": str(tmp_path / "cache")}
    for command in COMMANDS:
        done = subprocess.run(
            [SEATRIAL, *command],
            cwd=tmp_path,
            env=environment,
            umask=umask,
            capture_output=True,
            text=True,
        )
        assert done.returncode in (0, 1), done.stderr
    made = [path for path in tmp_path.rglob("*") if path not in given and "zig" not in path.parts]
    assert {path.parts[len(tmp_path.parts)] for path in made} >= {
        "cache", "campaign", "fmus", "run", "table",
    }  # fmt: skip
    for path in made:
        mode = stat.S_IMODE(path.stat().st_mode)
        most = 0o777 if path.is_dir() or mode & 0o100 else 0o666
        assert mode == most & ~umask, f"{path.relative_to(tmp_path)}: {mode:o}"


@needs_kits("campaigns")
def test_a_folder_that_another_machine_has_packed(tmp_path: Path) -> None:
    from seatrial_kits.campaigns.shipment import pack_folder, unpack_folder

    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "signals.csv").write_text("t\n")
    (tmp_path / "case" / "signals.csv").chmod(0o600)
    (tmp_path / "case").chmod(0o700)
    data, below = pack_folder(tmp_path / "case"), tmp_path / "here"
    before = os.umask(0o027)
    try:
        below.mkdir()
        unpack_folder(data, below)
    finally:
        os.umask(before)
    assert stat.S_IMODE((below / "case").stat().st_mode) == 0o750
    assert stat.S_IMODE((below / "case" / "signals.csv").stat().st_mode) == 0o640
