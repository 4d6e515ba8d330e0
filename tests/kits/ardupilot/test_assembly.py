"""The autopilot `ardupilot`: trials of the shipped vehicles under a stand-in for the firmware."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from seatrial import Simulation
from seatrial.cli.making.templates import texts, write
from seatrial.system.profile.profile import load_profile
from tests.command import SEATRIAL, seatrial
from tests.craft.references import shipped

HERE = Path(__file__).parent
NAME = "autopilot.sitl.ardupilot"
ANY_PORT = ("--set", f"{NAME}.link=udpin:127.0.0.1:0")
TRIAL = """
rig     = "sil"
choices = { vehicle = "hydrone", autopilot = "ardupilot" }
stop    = "5 s"
[record]
signals = ["vehicle.motion.*", "autopilot.sitl.ardupilot.pulse.*"]
"""
CHOICES = {
    "hydrone": (),
    "otter": (),
    "bluerov2": (),
    "mariner": (),
    "gloria": ("--choose", "servos=pulse"),
}


@pytest.fixture
def program(tmp_path: Path) -> Path:
    """A program that takes the firmware's options."""
    path = tmp_path / "ardurover"
    path.write_text(f'#!/bin/sh\nexec {sys.executable} {HERE / "peer.py"} "$@"\n')
    path.chmod(0o755)
    return path


def flown(vehicle: str, program: Path, out: str, *more: str) -> Path:
    """Run a vehicle under the program, and return the run's folder."""
    (program.parent / "trial.toml").write_text(TRIAL)
    done = seatrial(
        "run", "trial.toml", "--vehicle", vehicle, "--autopilot", f"ardupilot={program}",
        "--out", out, *ANY_PORT, *CHOICES.get(vehicle, ()), *more,
        cwd=program.parent,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return program.parent / out


def last_row(folder: Path) -> dict[str, float]:
    with (folder / "signals.csv").open(encoding="utf-8") as file:
        return {name: float(value) for name, value in list(csv.DictReader(file))[-1].items()}


def parameters(vehicle: str) -> dict[str, float]:
    """Return what the parameter file of a vehicle's profile has."""
    path = Path(load_profile(vehicle).parameters("links.ardupilot")["defaults"])
    lines = [line.partition("#")[0].split() for line in path.read_text().splitlines()]
    return {name: float(value) for name, value in (line for line in lines if line)}


def has_ended(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


@pytest.mark.slow
def test_a_program_is_started_in_the_run_folder_and_ended_with_it(program: Path) -> None:
    # The stand-in drives off at once, before any firmware could: no line holds it.
    folder = flown("hydrone", program, "run", "--set", "autopilot.mooring.stiffness=0")
    own = folder / NAME
    assert (own / "eeprom.bin").read_bytes() == b"kept"
    pid, options = (own / "output.txt").read_text().splitlines()
    assert has_ended(int(pid.split()[1]))
    defaults = options.partition("--defaults ")[2]
    files = [Path(name) for name in defaults.split(",")]
    assert files[0].name == "hydrone.parm"
    assert files[1:] == [own.resolve() / "instruments.parm"]
    assert "SIM_GPS1_LAG_MS" in files[1].read_text()
    assert "--home -31.780000000,-52.260000000,0,0.000 --rate 100 --speedup 1" in options
    row = last_row(folder)
    assert row["vehicle.hull.position.x"] > 1.0  # it drove ahead when the pulses came
    assert row["vehicle.hull.attitude.psi"] == pytest.approx(0.0, abs=0.01)


@pytest.mark.slow
def test_two_firmwares_in_one_run_have_folders_ports_and_numbers_of_their_own(
    program: Path,
) -> None:
    links = {
        "keeper.firmware.sitl.ardupilot.link": "udpin:127.0.0.1:0",
        "keeper.station.link": "tcpin:127.0.0.1:0",
        "drone.ardupilot.link": "udpin:127.0.0.1:0",
        "drone.station.link": "tcpin:127.0.0.1:0",
        "stop": "0.1 s",
    }
    settings = [word for key, url in links.items() for word in ("--set", f"{key}={url}")]
    done = seatrial(
        "run", "hydrone-drone-ardupilot", "--autopilot", f"ardupilot={program}",
        "--choose", f"copter={program}", "--out", "run", *settings, cwd=program.parent,
    )  # fmt: skip
    assert done.returncode == 1, done.stderr  # it has not landed yet
    said = {}
    for name, rate in (("keeper.firmware.sitl.ardupilot", 100), ("drone.ardupilot", 1000)):
        folder = program.parent / "run" / name
        answers = [json.loads(line) for line in (folder / "answers.jsonl").open()]
        assert [a["timestamp"] for a in answers[:3]] == [0.0, 1.0 / rate, 2.0 / rate]
        said[name] = (folder / "output.txt").read_text()
        assert f"--rate {rate} " in said[name]
    assert "--instance" not in said["keeper.firmware.sitl.ardupilot"]
    assert "--instance 1 --sysid 2" in said["drone.ardupilot"]
    assert "rng_1" in answers[0]
    assert answers[0]["rng_1"] == pytest.approx(0.149, abs=0.05)  # feet of 0.25 m, sensor at 0.1 m


@pytest.mark.slow
def test_both_engines_and_each_run_give_the_same_bytes(program: Path) -> None:
    first, *others = (
        (flown("hydrone", program, f"run{number}", "--engine", engine) / "signals.csv").read_bytes()
        for number, engine in enumerate(("direct", "direct", "fmu"))
    )
    assert others == [first, first]


def test_a_pulse_above_the_middle_turns_the_mariner_to_starboard(program: Path) -> None:
    """ArduPilot steers to starboard by such pulses, unless SERVO1_REVERSED is 1."""
    row = last_row(flown("mariner", program, "run", "--engine", "direct"))
    assert row["autopilot.sitl.ardupilot.pulse.ch1"] == pytest.approx(1700e-6)
    assert row["vehicle.ship.attitude.psi"] > 0.001
    assert parameters("mariner").get("SERVO1_REVERSED", 0.0) == 0.0


@pytest.mark.slow
def test_a_pulse_above_the_middle_turns_gloria_to_port(program: Path) -> None:
    headings = []
    for pulse in (1.45e-3, 1.55e-3):
        with Simulation("vehicles/gloria", choices={"servos": "pulse"}) as gloria:
            gloria.set("servos.sail.pulse", 1.75e-3)
            gloria.set("servos.rudder.pulse", pulse)
            gloria.run(8.0)
            headings.append(gloria.get("boat.attitude.psi"))
    assert headings[1] < headings[0] - 0.1
    assert parameters("gloria")["SERVO1_REVERSED"] == 1.0
    row = last_row(flown("gloria", program, "run", "--engine", "direct"))
    assert row["autopilot.sitl.ardupilot.pulse.ch2"] == pytest.approx(1500e-6)  # no pulse is given


@pytest.mark.slow
@pytest.mark.parametrize(
    ("like", "moved", "least"),
    [
        ("usv", "position.x", 0.5),
        ("rov", "position.y", -0.1),
        ("auv", "attitude.psi", 0.01),
        ("azimuth", "attitude.psi", 0.01),
        ("ship", "attitude.psi", 1e-4),
    ],
)
def test_a_vehicle_of_ones_own_takes_its_pulses(
    like: str, moved: str, least: float, program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Channels 1 and 3 above the middle: thrust; of the rov to port; with rudder to starboard."""
    monkeypatch.chdir(program.parent)
    for kind in (like, f"ardupilot/{like}"):
        write(texts("mine", kind), "", [("", "")])
    options = ("--engine", "direct", "--no-report", "--set", "autopilot.mooring.stiffness=0")
    row = last_row(flown("mine", program, "run", *options))
    assert row[f"{NAME}.pulse.ch1"] == pytest.approx(1700e-6)
    assert row[f"vehicle.hull.{moved}"] / least > 1.0


@pytest.mark.slow
def test_the_auv_stays_at_the_surface_under_a_firmware_that_cannot_dive(
    program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Amidships, its stern planes let it dive by 8 cm/s at 1.6 m/s."""
    monkeypatch.chdir(program.parent)
    for kind in ("auv", "ardupilot/auv"):
        write(texts("mine", kind), "", [("", "")])
    settings = ("--set", "stop=20 s", "--set", "autopilot.mooring.stiffness=0")
    row = last_row(flown("mine", program, "run", "--engine", "direct", "--no-report", *settings))
    assert row["vehicle.hull.velocity.u"] > 0.5
    assert row["vehicle.hull.position.z"] < 0.2


@pytest.mark.parametrize("vehicle", sorted(CHOICES))
def test_parameter_files_have_the_pulses_of_the_profile(vehicle: str) -> None:
    values = parameters(vehicle)
    for actuator in load_profile(vehicle).file.actuators.values():
        servo = f"SERVO{actuator.channel}"
        written = [values[f"{servo}_{end}"] for end in ("MIN", "TRIM", "MAX")]
        pulses = (actuator.pulse_min, actuator.pulse_neutral, actuator.pulse_max)
        assert written == pytest.approx([1e6 * pulse for pulse in pulses])
        assert values[f"{servo}_FUNCTION"] > 0.0


# What ArduSub's frame "vectored, six degrees of freedom" adds to its motors 1 to 8 for each of its
# outputs (AP_Motors6DOF): roll, pitch, yaw, throttle, forward, lateral.
FACTORS = [
    (0, 0, 1, 0, -1, 1),
    (0, 0, -1, 0, -1, -1),
    (0, 0, -1, 0, 1, 1),
    (0, 0, 1, 0, 1, -1),
    (1, -1, 0, -1, 0, 0),
    (-1, -1, 0, -1, 0, 0),
    (1, 1, 0, -1, 0, 0),
    (-1, 1, 0, -1, 0, 0),
]
MEANT = {"roll": 3, "pitch": 4, "yaw": 5, "throttle": 2, "forward": 0, "lateral": 1}
"""Row of the wrench that an output of ArduSub is for; throttle is upwards."""


@pytest.mark.parametrize("output", MEANT)
def test_ardusub_pushes_the_bluerov2_where_it_means_to(output: str) -> None:
    """Its pulses through the shipped thrusters, and what they do to the shipped hull's places."""
    values, column = parameters("bluerov2"), list(MEANT).index(output)
    places = shipped("thruster-matrix-allocation", "bluerov2.allocation").effects()
    wrench = np.zeros(6)
    with Simulation("actuators/bluerov2-curve", step="10 ms") as thrusters:
        for motor, factors in enumerate(FACTORS, 1):
            assert values[f"SERVO{motor}_FUNCTION"] == 32 + motor
            share = 0.5 * values[f"MOT_{motor}_DIRECTION"] * factors[column]
            thrusters.set(f"esc{motor}.pulse", 1.5e-3 + 400e-6 * share)
        thrusters.run(1.0)
        for motor in range(1, 9):
            wrench += np.array(places[motor - 1]) * thrusters.get(f"t{motor}.thrust")
    wanted = -1.0 if output == "throttle" else 1.0
    row = MEANT[output]
    assert wrench[row] * wanted > 5.0 * (0.1 if row > 2 else 1.0)
    # Forward and lateral thrust act 0.085 m below the origin.
    lever = {"forward": 4, "lateral": 3}.get(output)
    others = [i for i in range(6) if i not in (row, lever)]
    np.testing.assert_allclose(wrench[others], 0.0, atol=1e-9)


def test_left_and_right_throttle_turn_the_otter_as_they_should() -> None:
    with Simulation("vehicles/otter") as otter:
        otter.set("port_esc.pulse", 1.7e-3)
        otter.run(3.0)
        assert otter.get("hull.attitude.psi") > 0.05
    values = parameters("otter")
    assert (values["SERVO1_FUNCTION"], values["SERVO3_FUNCTION"]) == (73, 74)


def test_a_program_that_ends_fails_the_run_with_what_it_said(program: Path) -> None:
    program.write_text("#!/bin/sh\necho no such frame\nexit 3\n")
    done = seatrial(
        "run", "under-ardupilot", "--autopilot", f"ardupilot={program}", *ANY_PORT, "--out", "run",
        cwd=program.parent,
    )  # fmt: skip
    assert done.returncode == 3
    assert f"{NAME}: ArduPilot ended with status 3; " in done.stderr
    assert "no such frame" in done.stderr


@pytest.mark.parametrize(
    ("autopilot", "said"),
    [
        ("ardupilot=nowhere/ardurover", "program: there is no file"),
        ("ardupilot=", "NAME or NAME=PROGRAM is needed"),
        ("guidance=/bin/true", "unknown choice 'program'"),
    ],
)
def test_what_cannot_be_started_is_bad_input(tmp_path: Path, autopilot: str, said: str) -> None:
    done = seatrial("run", "under-ardupilot", "--autopilot", autopilot, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.fixture
def waiting(tmp_path: Path):
    """A run that waits for a firmware that nobody starts."""
    command = [SEATRIAL, "run", "under-ardupilot", *ANY_PORT, "--out", "run"]
    process = subprocess.Popen(
        [*command, "--engine", "direct"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    assert process.stderr is not None
    said = process.stderr.readline() + process.stderr.readline()
    yield process, said
    process.kill()
    process.communicate()


@pytest.mark.slow
def test_a_run_that_waits_says_what_to_start_and_can_be_stopped(waiting, tmp_path: Path) -> None:
    process, said = waiting
    assert "start ArduPilot, in a folder of its own:" in said
    assert "ardurover --model JSON:127.0.0.1 --sim-port-out " in said
    process.send_signal(signal.SIGINT)
    begun = time.monotonic()
    assert process.wait(20.0) == 3
    assert time.monotonic() - begun < 5.0
    assert json.loads((tmp_path / "run" / "manifest.json").read_text())["status"] == "stopped"


def test_the_program_ends_when_the_run_is_killed(program: Path) -> None:
    process = subprocess.Popen(
        [
            SEATRIAL,
            "run",
            "under-ardupilot",
            "--autopilot",
            f"ardupilot={program}",
            "--out",
            "run",
            *ANY_PORT,
            "--engine",
            "direct",
        ],
        cwd=program.parent,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    output = program.parent / "run" / NAME / "output.txt"
    deadline = time.monotonic() + 60.0
    while not (output.is_file() and "options" in output.read_text()):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    process.kill()
    process.wait()
    pid = int(output.read_text().splitlines()[0].split()[1])
    while not has_ended(pid):
        assert time.monotonic() < deadline
        time.sleep(0.05)
