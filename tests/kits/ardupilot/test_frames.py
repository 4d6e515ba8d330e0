"""Frames and timing of each vehicle's answers to ArduPilot, in every sea, against its record."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from seatrial.trial.records.run_folder import load_run
from tests.command import seatrial
from tests.interop.firmware_matrix import NO_WIND, SEAS, VEHICLES

NAME = "autopilot.sitl.ardupilot"
TRIAL = """
rig     = "sil"
choices = {{ vehicle = "{vehicle}", autopilot = "ardupilot", program = "{program}", step = "{step}" }}
stop    = "{stop} s"
{sea}
[record]
signals = ["vehicle.motion.*"]
"""
GRAVITY = 9.81
EVERY = "all"
"""The sea of each vehicle; the others of the matrix are of one."""


def on_its_sphere(positions: np.ndarray, latitude: float) -> np.ndarray:
    """Return what ArduPilot makes latitude and longitude of, by its own constant, of WGS 84."""
    north, east, down = positions.T
    start = np.degrees(latitude)
    lat, lon, _ = pymap3d.ned2geodetic(north, east, 0.0 * north, start, 0.0, 0.0)
    metres = 1.1131884502145034e-2 * 1e7
    middle = np.cos(np.radians((start + lat) / 2.0))
    return np.transpose([(lat - start) * metres, lon * metres * middle, down])


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("vehicle", "sea"),
    [(vehicle, sea) for vehicle in VEHICLES for sea in SEAS if sea == EVERY or vehicle == "otter"],
)
def test_the_firmware_gets_the_truth_of_its_time(vehicle: str, sea: str, tmp_path: Path) -> None:
    program, options = tmp_path / "firmware", VEHICLES[vehicle]
    peer = Path(__file__).with_name("peer.py")
    program.write_text(f'#!/bin/sh\nexec {sys.executable} {peer} "$@"\n')
    program.chmod(0o755)
    lines = [line for line in SEAS[sea] if vehicle not in NO_WIND or not line.startswith("wind")]
    step = float(options.step.removesuffix(" ms")) * 1e-3
    (tmp_path / "trial.toml").write_text(
        TRIAL.format(
            vehicle=vehicle, program=program, step=options.step, stop=200 * step,
            sea="\n".join(lines),
        )
    )  # fmt: skip
    done = seatrial(
        "run", "trial.toml", "--engine", "direct", "--out", "run",
        "--set", f"{NAME}.link=udpin:127.0.0.1:0", "--set", f"{NAME}.speedup=100",
        cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    run = load_run(tmp_path / "run")
    lines = (tmp_path / "run" / NAME / "answers.jsonl").read_text().splitlines()
    answers = [json.loads(line) for line in lines]
    assert len(answers) == 200
    record = {
        port: np.transpose([run.signals[n] for n in run.signals if f".{port}." in n], axes=None)[
            :200
        ]
        for port in ("position", "velocity", "attitude", "rates", "acceleration")
    }
    got = {
        key: np.array([answer[key] for answer in answers])
        for key in ("timestamp", "position", "velocity", "attitude")
    }
    assert got["timestamp"] == pytest.approx(step * np.arange(200), abs=1e-12)
    latitude = run.manifest["components"][NAME]["parameters"]["latitude"]["value"]
    assert got["position"] == pytest.approx(on_its_sphere(record["position"], latitude), abs=1e-6)
    assert got["attitude"] == pytest.approx(record["attitude"])
    to_ned = Rotation.from_euler("ZYX", record["attitude"][:, ::-1])
    assert got["velocity"] == pytest.approx(to_ned.apply(record["velocity"]), abs=1e-9)
    imu = [answer["imu"] for answer in answers]
    assert np.array([each["gyro"] for each in imu]) == pytest.approx(record["rates"])
    fallen = to_ned.inv().apply([[0.0, 0.0, GRAVITY]] * 200)
    force = np.array([each["accel_body"] for each in imu])
    assert force == pytest.approx(record["acceleration"] - fallen, abs=1e-9)
    if sea != "calm" and vehicle != "mariner":
        assert np.ptp(record["velocity"], axis=0).max() > 1e-4  # something moved it
