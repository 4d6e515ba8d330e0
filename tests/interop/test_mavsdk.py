"""MAVSDK as a reference tool: one long flight of the Hydrone with each kind of autopilot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .mavsdk_flight import COURSE, CRUISE, SPEEDS, WAIT_S
from .mavsdk_process import flown
from .mavsdk_stages import CLOCK_HZ, RATE_HZ
from .mavsdk_truth import ALWAYS, ANGLES, SILENT, STREAMS, Truth

DIALECTS = ("ardupilotmega", "px4")
RADIUS = 3.0
"""Of acceptance of a waypoint, m."""
DRIFT = 2.0
"""How far guidance lets a boat drift that stays, m."""
GNSS = 0.1
"""By how much the boat may be wrong about its place, m."""


@dataclass
class Flight:
    """What MAVSDK received, and what was true."""

    dialect: str
    truth: Truth
    samples: dict[str, list[Any]]
    marks: dict[str, list[float]]
    notes: dict[str, Any]

    def during(self, stage: str, name: str, last_s: float | None = None) -> Any:
        """Return the truth of a stage, or of its last seconds."""
        began, ended = self.marks[stage]
        began = began if last_s is None else ended - last_s
        return self.truth[name][self.truth.window(began, ended)]


def fly(dialect: str, folder: Path) -> Flight:
    run, received = flown("mavsdk_flight", "hydrone-mission", dialect, folder)
    return Flight(dialect, Truth(run), received["samples"], received["marks"], received["notes"])


# ---------------------------------------------------------------------- assessments


def streams_are_true(flight: Flight) -> None:
    """Every sample is within its errors of what was true about then."""
    assert set(STREAMS) <= set(flight.samples)
    for stream, compared in STREAMS.items():
        samples = flight.samples[stream]
        for name, value, tolerance in compared:
            off = [
                (flight.truth.off(name, value(values), time, angle=name in ANGLES), time)
                for time, values in samples
                if time > 1.0  # before, the GNSS has no fix, and the clock no time
            ]
            assert len(off) > 5, stream
            worst, at = max(off)
            assert worst <= tolerance, f"{stream}, {name}: off by {worst:.4g} at {at:.2f} s"


def the_rest_is_constant_or_silent(flight: Flight) -> None:
    for stream, expected in ALWAYS.items():
        assert flight.samples[stream]
        for _, values in flight.samples[stream]:
            assert expected.items() <= values.items(), (stream, values)
    for stream in SILENT:
        assert not flight.samples.get(stream), stream


def rates_are_obeyed(flight: Flight) -> None:
    began, ended = flight.marks["rates"]
    for stream in ("position", "attitude_quaternion", "fixedwing_metrics", "altitude", "raw_gps",
                   "imu", "scaled_imu", "unix_epoch_time", "odometry", "ground_truth", "in_air",
                   "home", "position_velocity_ned", "attitude_euler"):  # fmt: skip
        rate = CLOCK_HZ if stream == "attitude_euler" else RATE_HZ
        count = sum(began < time <= ended for time, _ in flight.samples[stream])
        wanted = rate * (ended - began)
        assert 0.8 * wanted - 1 <= count <= 1.05 * wanted + 1, f"{stream}: {count}, {wanted:.0f}"


def reached(flight: Flight) -> list[int]:
    """Return the row at which each waypoint is reached, one after the other."""
    truth, rows = flight.truth, []
    began, ended = flight.marks["mission"]
    row, end = truth.window(began, ended).start, truth.window(began, ended).stop
    for north, east in COURSE:
        distance = np.hypot(truth["x"][row:end] - north, truth["y"][row:end] - east)
        (near,) = np.nonzero(distance <= RADIUS + GNSS)
        assert near.size, f"never within {RADIUS} m of {north}, {east}"
        row += int(near[0])
        rows.append(row)
    return rows


def the_mission_is_followed(flight: Flight) -> None:
    """All waypoints in their order, on the lines between them, at the speeds given."""
    truth, rows = flight.truth, reached(flight)
    start = truth.window(*flight.marks["mission"]).start
    errors = []
    corners = [(0.0, 0.0), *COURSE]
    for (n0, e0), (n1, e1), first, last in zip(corners, COURSE, [start, *rows], rows, strict=False):
        length = np.hypot(n1 - n0, e1 - e0)
        north, east = truth["x"][first:last] - n0, truth["y"][first:last] - e0
        errors.append((east * (n1 - n0) - north * (e1 - e0)) / length)
    rms = float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))
    flight.notes["cross-track RMS"] = rms
    assert rms <= 2.0, rms
    for leg, speed in speeds(flight.dialect).items():
        first, last = [start, *rows][leg], rows[leg]
        middle = truth["speed"][first + (last - first) // 2 : last]
        assert np.median(middle) == pytest.approx(speed, abs=0.05), f"leg {leg}"


def speeds(dialect: str) -> dict[int, float]:
    """Return the speed of legs; a Mission's speed counts after its waypoint."""
    first, then = SPEEDS
    return (
        {0: first, 2: then, 3: then}
        if dialect == "ardupilotmega"
        else {0: CRUISE, 1: first, 3: then}
    )


def the_mission_waits(flight: Flight) -> None:
    rows = reached(flight)
    north, east = COURSE[1]
    truth, leaves = flight.truth, rows[2]
    distance = np.hypot(truth["x"][rows[1] : leaves] - north, truth["y"][rows[1] : leaves] - east)
    stayed = truth.time[rows[1] : leaves][distance <= RADIUS + GNSS]
    assert stayed[-1] - stayed[0] >= WAIT_S


def progress_counts_up(flight: Flight) -> None:
    currents, totals = zip(*flight.notes["progress"], strict=True)
    assert list(currents) == sorted(currents)
    assert currents[-1] == totals[-1]


def it_stays(flight: Flight, stage: str) -> None:
    """Within the drift limit of where it was sent, in the mode hold."""
    assert set(modes(flight, stage)) == {"hold"}
    x, y = flight.during(stage, "x"), flight.during(stage, "y")
    away = np.hypot(x - x[0], y - y[0])
    assert away.max() <= DRIFT + 2.0  # it must brake first, and comes back
    assert away[-1] <= DRIFT + 0.5


def modes(flight: Flight, stage: str) -> list[str]:
    rows = flight.truth.window(*flight.marks[stage])
    recorded = flight.truth.run.signals["autopilot.mavlink.mode"]
    return list(recorded[rows.start + 2 : rows.stop - 2])


def it_goes_to(flight: Flight, stage: str, north: float, east: float) -> None:
    x, y = flight.during(stage, "x")[-1], flight.during(stage, "y")[-1]
    assert np.hypot(x - north, y - east) <= 2.0 + 0.5, (x, y)


def it_is_steered(flight: Flight) -> None:
    """Set-points are what the boat does, once it has come to it."""
    ned = [flight.during("velocity north-east", axis).mean() for axis in ("vn", "ve")]
    assert ned == pytest.approx([0.4, 0.4], abs=0.1)
    assert flight.during("velocity ahead", "u").mean() == pytest.approx(0.6, abs=0.1)
    assert np.ptp(flight.during("velocity ahead", "psi")) < np.radians(10.0)
    turning = np.degrees(flight.during("turn", "r"))
    assert turning.mean() == pytest.approx(8.0, abs=1.0)
    assert flight.during("turn", "u").mean() == pytest.approx(0.5, abs=0.1)
    heading = np.degrees(flight.during("attitude", "psi"))
    assert np.abs((heading + 90.0 + 180.0) % 360.0 - 180.0).max() < 10.0
    assert flight.during("attitude", "u").mean() == pytest.approx(0.5, abs=0.1)
    it_goes_to(flight, "position", *flight.notes["position"])


def it_has_the_helm(flight: Flight) -> None:
    rows = flight.truth.window(*flight.marks["manual"])
    surge, yaw = (
        flight.truth.run.signals[f"autopilot.mavlink.manual.{a}"] for a in ("surge", "yaw")
    )
    later = slice(rows.start + 20, rows.stop - 5)
    assert surge[later] == pytest.approx(0.6, abs=1e-3)
    assert yaw[later] == pytest.approx(0.3, abs=1e-3)
    assert flight.during("manual", "u", 3.0).min() > 0.3
    assert flight.during("manual", "r", 3.0).min() > 0.02


def it_goes_slower(flight: Flight) -> None:
    assert np.median(flight.during("slower", "speed", 4.0)) == pytest.approx(0.4, abs=0.05)


CHECKS = {
    "streams": streams_are_true,
    "constants": the_rest_is_constant_or_silent,
    "rates": rates_are_obeyed,
    "mission": the_mission_is_followed,
    "wait": the_mission_waits,
    "progress": progress_counts_up,
    "pause": lambda flight: it_stays(flight, "pause"),
    "slower": it_goes_slower,
    "goto": lambda flight: it_goes_to(flight, "goto", 12.0, 9.0),
    "hold": lambda flight: it_stays(flight, "hold"),
    "return": lambda flight: it_goes_to(flight, "return", *flight.notes["return"]),
    "set-points": it_is_steered,
    "manual": it_has_the_helm,
}


def check(dialect: str, folder: Path, subtests: pytest.Subtests) -> None:
    flight = fly(dialect, folder)
    for name, holds in CHECKS.items():
        with subtests.test(name):
            holds(flight)


# As PX4 a vehicle is flown in every run too: it dives, in test_mavsdk_submarine.py.
@pytest.mark.parametrize(
    "dialect", [DIALECTS[0], pytest.param(DIALECTS[1], marks=pytest.mark.long)]
)
def test_a_flight(dialect: str, tmp_path: Path, subtests: pytest.Subtests) -> None:
    check(dialect, tmp_path, subtests)


@pytest.mark.long
@pytest.mark.parametrize("again", range(1, 20))
@pytest.mark.parametrize("dialect", DIALECTS)
def test_the_same_flight_again(
    dialect: str, again: int, tmp_path: Path, subtests: pytest.Subtests
) -> None:
    """With `test_a_flight`, twenty in a row."""
    check(dialect, tmp_path, subtests)
