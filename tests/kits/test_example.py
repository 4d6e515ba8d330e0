"""The example of a kit, installed by pip: it runs without a line of seatrial changed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.interop
EXAMPLE = Path(__file__).parents[2] / "examples" / "kit-skeg"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the kit, installed from a copy: pip builds beside the source."""
    folder = tmp_path_factory.mktemp("kit")
    source = shutil.copytree(EXAMPLE, folder / "source")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps"]
    subprocess.run([*pip, "--target", str(folder / "site"), str(source)], check=True)
    return folder / "site"


def seatrial(site: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(site), "COLUMNS": "200"}
    command = [sys.executable, "-c", "from seatrial.cli import main; main()", *arguments]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("engine", ["direct", "fmu", "native"])
def test_its_trial_runs_with_its_vehicle_sensor_and_term(
    site: Path, tmp_path: Path, engine: str
) -> None:
    done = seatrial(site, tmp_path, "run", "skiff-straight", "--engine", engine, "--out", "run")
    assert done.returncode == 0, done.stderr
    assert "Heel and trim by inclinometer" in (tmp_path / "run/report.html").read_text("utf-8")
    # The bare hull turns by itself (otter-straight): the term is what holds it.
    bare = ("--set", "hull.skeg_area=0 m2", "--out", "bare", "--engine", engine, "--no-report")
    done = seatrial(site, tmp_path, "run", "skiff-straight", *bare)
    assert done.returncode == 1
    assert "FAIL  it goes straight in the end" in done.stdout


def test_its_fault_and_its_function_of_criteria(site: Path, tmp_path: Path) -> None:
    run = ("run", "skiff-straight", "--engine", "direct", "--out", "run", "--no-report")
    done = seatrial(
        site, tmp_path, *run, "--fault", "inclinometer.tilt=coarse, at=10 s, value=1 deg"
    )
    assert done.returncode == 0, done.stderr
    assert "PASS  it keeps its speed" in done.stdout
    rows = (tmp_path / "run/signals.csv").read_text().splitlines()
    place = rows[0].split(",").index("inclinometer.tilt.heel")
    heels = [float(row.split(",")[place]) for row in rows[1:]]
    assert any(heel % 0.0174 for heel in heels[:100])
    assert {round(heel * 57.29577951308232, 9) for heel in heels[101:]} <= {-1.0, 0.0, 1.0}
    refused = seatrial(site, tmp_path, *run, "--fault", "inclinometer.tilt=coarse, value=0 deg")
    assert "a step above 0 is needed, found 0" in refused.stderr


def test_its_command_is_listed_and_agrees_with_the_equation(site: Path, tmp_path: Path) -> None:
    assert "skeg" in seatrial(site, tmp_path, "--help").stdout
    done = seatrial(site, tmp_path, "skeg", "2.0")
    # rho A a u^2 / 2 for a degree: 1025 x 0.12 x 3 x 4 / 2 / 57.296
    assert done.stdout.startswith("12.9 N for each degree")
    assert seatrial(site, tmp_path, "skeg", "--", "-1").returncode == 2


def test_doctor_and_lists_name_it(site: Path, tmp_path: Path) -> None:
    assert "ships, skeg, survey" in seatrial(site, tmp_path, "doctor").stdout
    assert "Heel and trim" in seatrial(site, tmp_path, "fmu", "list").stdout
    assert "skiff-straight" in seatrial(site, tmp_path, "list").stdout
