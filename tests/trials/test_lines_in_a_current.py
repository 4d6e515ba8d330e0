"""Vehicles of each kind hold a line across a current, and their place in wind: the truth of it."""

import math

import numpy as np
import pytest

import seatrial
from seatrial.cli.making.templates import texts, write

pytestmark = [pytest.mark.interop, pytest.mark.long]

CURRENT = 0.4
ACROSS = {"usv": 1.5, "rov": 0.5, "auv": 1.0, "azimuth": 1.5, "ship": 10.0}
"""Largest distance from the line, m: the errors of GNSS, or half the beam of the ship."""
LINE = """
rig     = "sil"
choices = {{ vehicle = "boat" }}
stop    = "20 min"
current = {{ speed = "{current} m/s", direction = "90 deg" }}
[set]
"vehicle.hull.position_start"  = [0, 0, "{depth} m"]
"autopilot.course.start_point" = [0, 0, "{depth} m"]
"autopilot.course.waypoint_1"  = ["9 km", 0, "{depth} m"]
"""
HOLD = """
rig     = "sil"
choices = { vehicle = "boat" }
stop    = "20 min"
wind    = { speed = "8 m/s", direction = "90 deg" }
[set]
"autopilot.pilot.guidance.mode" = "hold"
"""


@pytest.fixture
def simulated(tmp_path, monkeypatch):
    """Return what simulates a vehicle of a kind: rows of t, north, east, heading and speed."""
    monkeypatch.chdir(tmp_path)

    def rows(kind, trial, seconds):
        write(texts("boat", kind), "", [("", "")])
        (tmp_path / "t.toml").write_text(trial, "utf-8")
        found = []
        with seatrial.Simulation("t.toml", engine="native") as simulation:
            for t in range(1, seconds + 1):
                simulation.run(float(t))
                north, east, _ = simulation.get("vehicle.hull.position")
                heading = simulation.get("vehicle.hull.attitude")[2]
                speed = simulation.get("autopilot.pilot.guidance.speed")
                found.append([t, north, east, heading, speed])
        return np.array(found)

    return rows


@pytest.mark.parametrize("kind", ACROSS)
def test_it_holds_a_line_across_a_current_with_the_crab_angle_of_its_speed(kind, simulated):
    depth = 3 if kind in ("rov", "auv") else 0
    rows = simulated(
        kind, LINE.format(current=CURRENT, depth=depth), 600 if kind == "ship" else 240
    )
    late = rows[2 * len(rows) // 3 :]
    assert np.abs(late[:, 2]).max() < ACROSS[kind]
    # Through the water u_r ahead, no sway: u_r sin(psi) = -V, u = u_r + V sin(psi) over ground.
    heading, speed = late[:, 3].mean(), late[:, 4].mean()
    through = 0.5 * (speed + math.sqrt(speed**2 + 4.0 * CURRENT**2))
    assert heading == pytest.approx(-math.asin(CURRENT / through), abs=math.radians(2.0))


@pytest.mark.parametrize(("kind", "limit"), [("usv", 2.0), ("azimuth", 4.0)])
def test_it_holds_its_place_in_wind_with_its_bow_to_it_and_stays_there(kind, limit, simulated):
    rows = simulated(kind, HOLD, 300)
    late = rows[200:]
    assert np.hypot(late[:, 1], late[:, 2]).max() < limit + 1.5  # of the errors of GNSS
    off = np.abs(np.degrees(np.remainder(late[:, 3], math.tau) - 1.5 * math.pi))
    assert off.max() < 30.0
