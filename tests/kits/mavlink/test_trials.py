"""Vehicles under a ground station, in simulated time: what the plant does with its orders."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from .voyage import JUMP, LOITER_TURNS, RETURN, WAYPOINT, mission_file, origin_of, voyage

pytestmark = pytest.mark.interop

ROVER = {"manual": 0, "hold": 4, "loiter": 5, "auto": 10, "return": 11, "guided": 15}
SUB = {"depth-hold": 2, "auto": 3, "guided": 4, "loiter": 7, "hold": 16, "manual": 19}
COMPLETE = 5
FIX = 1.1
"""A craft goes on between two fixes, which are 0.2 s apart and late, and have errors."""


@dataclass(frozen=True)
class Craft:
    """A vehicle, and how large its courses are."""

    name: str
    plant: str
    modes: dict
    places: tuple
    """North, east, down of the waypoints, m."""
    radius: float
    at_most: float
    """Simulated time for the mission, s."""
    rms: float
    """Bound of its trial's cross-track error, m."""
    off: float = 0.0
    """What a receiver without corrections may be off by, m."""

    @property
    def near(self):
        """Return the true distance at which it may take a place for reached, m."""
        return self.radius * FIX + self.off


CRAFTS = {
    "hydrone": Craft("hydrone", "vehicle.hull", ROVER, ((20, 0, 0), (20, 15, 0)), 3.0, 100, 2.0),
    "videoray": Craft(
        "videoray", "vehicle.hull", SUB, ((0, 0, 2), (5, 0, 2), (5, 4, 3)), 1.0, 120, 0.5
    ),
    "otter": Craft("otter", "vehicle.hull", ROVER, ((30, 0, 0), (30, 25, 0)), 4.0, 80, 2.0),
    "bluerov2": Craft(
        "bluerov2", "vehicle.hull", SUB, ((0, 0, 2), (5, 0, 2), (5, 4, 3)), 1.0, 120, 0.5
    ),
    "gloria": Craft(
        "gloria", "vehicle.boat", ROVER, ((0, 50, 0), (35, 80, 0)), 8.0, 150, 25.0, 3.0
    ),
    "mariner": Craft(
        "mariner", "vehicle.ship", ROVER, ((2500, 0, 0), (4500, 2000, 0)), 1e3, 1200, 400.0
    ),
}
every = pytest.mark.parametrize(
    "craft",
    [
        pytest.param(
            craft, id=name, marks=pytest.mark.long if name in ("mariner", "bluerov2") else ()
        )
        for name, craft in CRAFTS.items()
    ],
)


def waypoints(places):
    return [(WAYPOINT, 0, 0, 0, place) for place in places]


def at_sea(craft, folder, items=(), **settings):
    """Return a voyage whose vehicle finds a mission in its plan folder."""
    plans = mission_file(folder / "plans", origin_of(craft.name), items)
    given = {"autopilot__mavlink__plan_folder": plans}
    # Half of a run's time goes to the link and to noise that nothing uses, else.
    given["autopilot__mavlink__period"] = "100 ms"
    if craft.name in ("hydrone", "otter"):
        given["vehicle__imu__period"] = "100 ms"
    if craft.name in ("videoray", "bluerov2"):
        given["vehicle__hull__eta_start.z"] = "1 m"
    if craft.name == "gloria":
        given["vehicle__boat__eta_start"] = ["0 m", "0 m", "0 deg", "90 deg"]
    choices = {"step": "20 ms"}
    if craft.name == "mariner":
        choices = {"step": "100 ms", "algorithm": "extrapolated"}
    return voyage(craft.name, craft.plant, choices, **given, **settings)


def completes(v, craft, at_most):
    v.arm()
    v.enter(craft.modes["auto"])
    v.until(lambda: v.received["MISSION_CURRENT"].mission_state == COMPLETE, "the end", at_most)


# ---------------------------------------------------------------------- missions


@every
def test_a_mission_leads_through_its_waypoints(craft, tmp_path):
    with at_sea(craft, tmp_path, waypoints(craft.places)) as v:
        completes(v, craft, craft.at_most)
        assert v.passed(craft.places, craft.near)
        assert 0.0 < v.signal("autopilot.pilot.guidance.cross_track_rms") <= craft.rms
        assert v.position[2] == pytest.approx(craft.places[-1][2], abs=0.35)
        assert v.received["HEARTBEAT"].custom_mode == craft.modes["auto"]


def test_jumps_turns_and_the_way_home_of_a_mission(tmp_path):
    craft = CRAFTS["hydrone"]
    there, back = (15, 0, 0), (10, 8, 0)
    items = [
        *waypoints([there, back]),
        (JUMP, 1, 1, 0, None),
        (LOITER_TURNS, 1, 0, 6, (0, 12, 0)),
        (RETURN, 0, 0, 0, None),
    ]
    with at_sea(craft, tmp_path, items) as v:
        completes(v, craft, 250)
        assert v.passed([there, back, there, back, (6, 12), (0, 18), (0, 0)], craft.near)
        ring = [np.hypot(n, e - 12) for _, n, e, _ in v.track]
        bearings = np.unwrap([np.arctan2(e - 12, n) for _, n, e, _ in v.track])
        near = np.array(ring) < 7.0
        assert np.ptp(bearings[near]) > 2 * np.pi * 0.9


@pytest.mark.long
def test_gloria_sails_a_long_mission_in_gusts(tmp_path):
    craft = CRAFTS["gloria"]
    # Off the wind, dead upwind, round a place, and home: the wind blows north.
    places = ((0, 150, 0), (-60, 200, 0))
    items = [*waypoints(places), (LOITER_TURNS, 1, 0, 60, (0, 100, 0)), (RETURN, 0, 0, 0, None)]
    gusts = {"vehicle__wind__intensity": "15 %", "vehicle__wind__direction_deviation": "8 deg"}
    with at_sea(craft, tmp_path, items, **gusts) as v:
        completes(v, craft, 2500)
        assert v.passed([*places, (0, 0)], craft.near)
        assert v.signal("autopilot.pilot.guidance.cross_track_rms") <= craft.rms


# ---------------------------------------------------------------------- orders


def test_the_hydrone_goes_returns_and_is_held_when_the_station_is_lost(tmp_path):
    craft = CRAFTS["hydrone"]
    with at_sea(craft, tmp_path, waypoints(craft.places)) as v:
        v.arm()
        v.enter(craft.modes["guided"])
        v.go_to(10, -10)
        v.until(lambda: v.away(10, -10) < craft.near, "the position", 60)
        v.enter(craft.modes["return"])
        v.until(lambda: v.away(0, 0) < craft.near, "home", 60)
        v.enter(craft.modes["auto"])
        v.wait(8)
        v.silent = True
        v.until(lambda: v.received["HEARTBEAT"].custom_mode == craft.modes["hold"], "failsafe", 10)
        north, east, _ = v.position
        v.wait(20)
        assert v.away(north, east) < 3.0


def test_the_videoray_dives_by_manual_control_and_goes_to_a_depth(tmp_path):
    craft = CRAFTS["videoray"]
    with at_sea(craft, tmp_path) as v:
        v.arm()
        v.enter(craft.modes["depth-hold"])
        end = v.time + 8.0
        while v.time < end:  # z is 0 to 1000 upwards, 500 in the middle
            v.link.mav.manual_control_send(3, 0, 0, 0, 0, 0)
            v.wait(0.5)
        assert v.position[2] == pytest.approx(1.0 + 8.0 * 0.2, abs=0.4)
        v.enter(craft.modes["guided"])
        v.go_to(3, 0, 4)
        v.until(lambda: v.away(3, 0) < craft.near, "the position", 60)
        v.until(lambda: abs(v.position[2] - 4) < 0.3, "the depth", 60)


def test_gloria_lies_to_goes_and_is_steered_by_hand(tmp_path):
    craft = CRAFTS["gloria"]
    with at_sea(craft, tmp_path) as v:
        v.arm()
        v.wait(15)
        assert v.away(0, 0) < 15.0
        assert abs(v.signal("vehicle.boat.velocity.u")) < 0.5  # she lies to
        v.enter(craft.modes["guided"])
        v.go_to(20, 60)
        v.until(lambda: v.away(20, 60) < craft.near, "the position", 90)
        v.enter(craft.modes["manual"])
        heading = v.signal("vehicle.boat.attitude.psi")
        end = v.time + 5.0
        while v.time < end:  # to starboard, the sheet half hauled in
            v.link.mav.manual_control_send(2, 0, 1000, 500, 0, 0)
            v.wait(0.5)
        assert v.signal("vehicle.boat.attitude.psi") > heading + 0.05
        assert v.signal("vehicle.servos.rudder.angle") == pytest.approx(-np.radians(12))
        v.command(400, 0)
        v.wait(2)
        assert v.signal("vehicle.servos.rudder.angle") == 0.0


@pytest.mark.long
def test_gloria_holds_in_a_current_and_loiters(tmp_path):
    craft = CRAFTS["gloria"]
    with at_sea(craft, tmp_path, vehicle__boat__current=["0 m/s", "0.15 m/s"]) as v:
        v.arm()
        v.wait(600)
        assert max(np.hypot(n, e) for _, n, e, _ in v.track) < 110.0
        v.enter(craft.modes["loiter"])
        north, east, _ = v.position
        v.wait(800)
        bearings = np.unwrap([np.arctan2(e - east, n - north) for t, n, e, _ in v.track if t > 650])
        assert bearings[-1] - bearings[0] > 2 * np.pi


@pytest.mark.long
def test_the_mariner_keeps_her_heading_in_hold_and_turns_by_her_rudder(tmp_path):
    craft = CRAFTS["mariner"]
    with at_sea(craft, tmp_path) as v:
        v.arm()
        v.wait(120)
        heading = v.signal("vehicle.ship.attitude.psi")
        assert abs(heading) < np.radians(2)
        assert v.position[0] > 900  # she does not stop
        v.enter(craft.modes["manual"])
        end = v.time + 60.0
        while v.time < end:
            v.link.mav.manual_control_send(4, 0, 300, 0, 0, 0)
            v.wait(0.5)
        turned = v.signal("vehicle.ship.attitude.psi")
        assert turned > np.radians(10)
        v.enter(craft.modes["hold"])
        v.wait(240)
        # As wide as a ship needs to stop turning, and no way back but for what she swings.
        assert turned - 0.04 < v.signal("vehicle.ship.attitude.psi") < turned + np.radians(25)
        assert abs(v.signal("vehicle.ship.rates.r")) < np.radians(0.1)
