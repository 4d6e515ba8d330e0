"""A vehicle under MAVLink in process and a pymavlink station over TCP, in lockstep: minutes at sea in seconds.

The station receives and answers between the steps, so nothing depends on the wall clock. What is
asserted comes from the plant, not from the vehicle's telemetry.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import contextmanager

from pymavlink import mavutil, mavwp

from seatrial.links.geodesy import Origin
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.profile.profile import load_profile

WAYPOINT, LOITER_TURNS, RETURN, JUMP, SPEED = 16, 18, 20, 177, 178
_EVERY_S = 0.5
"""Simulated time between two heartbeats of the station."""
_RELATIVE = 3


class Voyage:
    """``craft`` is the component that moves; ``track`` its true positions, every 0.5 s."""

    def __init__(self, vehicle, craft, choices, settings):
        loaded = load_rig("sil", None, {"vehicle": vehicle, "autopilot": "mavlink", **choices})
        self._system = assemble(loaded, "direct")
        for key, value in {"autopilot.mavlink.links": "tcpin:127.0.0.1:0", **settings}.items():
            self._system.set(key, value, "test")
        self.master = Master(self._system, 0, 10**15)
        self.master.initialise()
        self._craft = craft
        self._places = {f"{c}.{n}": i for i, (c, n) in enumerate(self.master.names)}
        home = load_profile(vehicle).parameters("links.ground")
        self.origin = Origin(home["latitude"], home["longitude"], home["altitude"])
        component = self._system.parts["autopilot.mavlink"].instance.component
        self._system_id = round(home["system_id"])
        self.link = mavutil.mavlink_connection(
            component.urls[0].replace("tcpin", "tcp"), source_system=255, source_component=190
        )
        self.link.target_system, self.link.target_component = self._system_id, 1
        self.track = []
        self.received = {}
        self.texts = []
        self.silent = False

    def close(self):
        self.link.close()
        self._system.free()

    # ------------------------------------------------------------------ time

    @property
    def time(self):
        return self.master.time

    def signal(self, name):
        return self.master.signals[self._places[name]]

    @property
    def position(self):
        return tuple(self.signal(f"{self._craft}.position.{axis}") for axis in "xyz")

    def wait(self, seconds):
        """Let so many seconds pass."""
        end = self.time + seconds - 1e-9
        while self.time < end:
            self._go_on()

    def until(self, condition: Callable[[], bool], what, at_most):
        """Let time pass until the condition holds; fail after ``at_most`` seconds of it."""
        end = self.time + at_most
        while not condition():
            assert self.time < end, f"{what}: not within {at_most} s; {self.texts[-5:]}"
            self._go_on()

    def _go_on(self):
        if not self.silent:
            self.link.mav.heartbeat_send(6, 8, 0, 0, 4)
        for _ in range(round(_EVERY_S / (self.master.step_ns * 1e-9))):
            self.master.step()
        self.track.append((self.time, *self.position))
        while (message := self.link.recv_match()) is not None:
            self.received[message.get_type()] = message
            if message.get_type() == "STATUSTEXT":
                self.texts.append(message.text)

    # ------------------------------------------------------------------ orders

    def command(self, number, *parameters):
        """Give a command until it is answered; fail unless it is accepted."""
        given = [*parameters, *[0.0] * (7 - len(parameters))]
        self.received.pop("COMMAND_ACK", None)
        self.link.mav.command_long_send(self._system_id, 1, number, 0, *given)
        self.until(lambda: "COMMAND_ACK" in self.received, f"answer to command {number}", 5)
        answer = self.received["COMMAND_ACK"]
        assert (answer.command, answer.result) == (number, 0), (answer, self.texts[-3:])

    def enter(self, mode):
        """Change the mode, by ArduPilot's number."""
        self.command(mavutil.mavlink.MAV_CMD_DO_SET_MODE, 1, mode)
        self.until(lambda: self.received["HEARTBEAT"].custom_mode == mode, f"mode {mode}", 3)

    def arm(self):
        """Arm, once there is a position."""
        self.until(lambda: self.received.get("GLOBAL_POSITION_INT"), "a position", 10)
        self.command(mavutil.mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)

    def go_to(self, north, east, down=0.0):
        """Order a position, as a click on the map does."""
        latitude, longitude, altitude = self.origin.geodetic((north, east, down))
        self.received.pop("COMMAND_ACK", None)
        self.link.mav.command_int_send(
            self._system_id,
            1,
            _RELATIVE,
            mavutil.mavlink.MAV_CMD_DO_REPOSITION,
            0,
            0,
            -1,
            1,
            0,
            math.nan,
            round(latitude * 1e7),
            round(longitude * 1e7),
            altitude - self.origin.altitude,
        )
        self.until(lambda: "COMMAND_ACK" in self.received, "answer to DO_REPOSITION", 5)
        assert self.received["COMMAND_ACK"].result == 0

    # ------------------------------------------------------------------ assessment

    def away(self, north, east):
        """Return the true horizontal distance to a place, m."""
        return math.dist(self.position[:2], (north, east))

    def nearest(self, place, since=0.0):
        """Return the least true distance to a place from a time on, m."""
        return min(math.dist(at, place[:2]) for t, *at, _ in self.track if t >= since)

    def passed(self, places, radius):
        """Return whether the true track comes within ``radius`` of all places in their order."""
        left = list(places)
        for _, north, east, _ in self.track:
            if left and math.dist((north, east), left[0][:2]) <= radius:
                del left[0]
        return not left


@contextmanager
def voyage(vehicle, craft, choices, **settings):
    """Give a `Voyage` and end it; settings have two underscores for the point."""
    made = Voyage(
        vehicle,
        craft,
        choices,
        {key.replace("__", "."): value for key, value in settings.items()},
    )
    try:
        yield made
    finally:
        made.close()


def mission_file(folder, origin, items: Sequence[tuple]):
    """Write ``mission.waypoints`` by pymavlink's own writer; return the folder as text.

    Each item is (command, p1, p2, p3, place), the place north, east, down of the origin or None.
    """
    folder.mkdir()
    loader = mavwp.MAVWPLoader()
    for n, (command, p1, p2, p3, place) in enumerate([(WAYPOINT, 0, 0, 0, (0, 0, 0)), *items]):
        latitude, longitude, altitude = origin.geodetic(place) if place else (0.0, 0.0, 0.0)
        height = altitude - origin.altitude if place else 0.0
        loader.add(
            mavutil.mavlink.MAVLink_mission_item_message(
                1, 1, n, _RELATIVE, command, 0, 1, p1, p2, p3, 0, latitude, longitude, height
            )
        )
    loader.save(str(folder / "mission.waypoints"))
    return str(folder)


def origin_of(profile):
    """Return a profile's origin."""
    home = load_profile(profile).parameters("links.ground")
    return Origin(home["latitude"], home["longitude"], home["altitude"])
