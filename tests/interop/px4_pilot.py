"""A pilot who drives PX4's submarine by a joystick, in position mode, from place to place.

``python -m tests.interop.px4_pilot NORTH,EAST,DEPTH... -- COMMAND...`` starts the command, which
runs the firmware, arms it, moves it by MANUAL_CONTROL to places (m, from where it began) until it
is within 0.6 m of each by its own estimate, interrupts the command, and prints as JSON when it was
where (firmware's time, s) and what the firmware said. PX4 has no missions for submarines.
"""

from __future__ import annotations

import json
import math
import signal
import subprocess
import sys
import time
from typing import Any

from pymavlink import mavutil

ADDRESS = "udpin:127.0.0.1:14540"
READY_S, PLACE_S = 90.0, 90.0
"""Wall time until it is armed, and for each place."""
NEAR = 0.6
_POSITION_MODE = 3
_PER_METRE = 0.8
_ARMED = mavutil.mavlink.MAV_MODE_FLAG_SAFETY_ARMED

Place = tuple[float, float, float]


class Pilot:
    """The connection, the newest message of each name, and all texts."""

    def __init__(self) -> None:
        self._link = mavutil.mavlink_connection(ADDRESS, source_system=255)
        self.newest: dict[str, Any] = {}
        self.texts: list[str] = []
        self._axes = (0.0, 0.0, 0.0)
        self._beaten = 0.0

    def take_in(self) -> None:
        """Take in a message, and send the axes and a heartbeat from time to time."""
        now = time.monotonic()
        if "HEARTBEAT" in self.newest and now - self._beaten > 0.05:
            self._beaten = now
            station = mavutil.mavlink.MAV_TYPE_GCS
            self._link.mav.heartbeat_send(station, mavutil.mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4)
            ahead, starboard, down = self._axes
            axes = (1000 * ahead, 1000 * starboard, 500 - 500 * down)
            self._link.mav.manual_control_send(1, *map(round, axes), 0, 0)
        message = self._link.recv_match(blocking=True, timeout=0.02)
        if message is not None:
            self.newest[message.get_type()] = message
            if message.get_type() == "STATUSTEXT":
                self.texts.append(message.text)

    def arm(self) -> None:
        """Bring it into position mode, and arm it."""
        deadline, asked = time.monotonic() + READY_S, 0.0
        while not (self._has_all() and self.newest["HEARTBEAT"].base_mode & _ARMED):
            if time.monotonic() > deadline:
                raise TimeoutError(f"it does not arm: {self.texts[-5:]}")
            self.take_in()
            if self._has_all() and time.monotonic() - asked > 2.0:
                asked = time.monotonic()
                self._command(mavutil.mavlink.MAV_CMD_DO_SET_MODE, 1.0, _POSITION_MODE)
                self._command(mavutil.mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 0.0)

    def move(self, place: Place) -> float:
        """Move it to a place; return the firmware's time there, s."""
        deadline = time.monotonic() + PLACE_S
        while time.monotonic() < deadline:
            self.take_in()
            at, heading = self.newest["LOCAL_POSITION_NED"], self.newest["ATTITUDE"].yaw
            north, east, down = place[0] - at.x, place[1] - at.y, place[2] - at.z
            if math.hypot(north, east, down) < NEAR:
                return float(at.time_boot_ms) / 1e3
            c, s = math.cos(heading), math.sin(heading)
            wanted = (c * north + s * east, -s * north + c * east, down)
            x, y, z = (max(-1.0, min(1.0, _PER_METRE * each)) for each in wanted)
            self._axes = (x, y, z)
        raise TimeoutError(f"not at {place}: {self.texts[-5:]}")

    def _has_all(self) -> bool:
        return self.newest.keys() >= {"HEARTBEAT", "LOCAL_POSITION_NED", "ATTITUDE"}

    def _command(self, number: int, first: float, second: float) -> None:
        self._link.mav.command_long_send(1, 1, number, 0, first, second, 0, 0, 0, 0, 0)


def main() -> None:
    between = sys.argv.index("--")
    run = subprocess.Popen(sys.argv[between + 1 :], stdout=sys.stderr)
    try:
        pilot, reached = Pilot(), []
        try:
            pilot.arm()
            for place in sys.argv[1:between]:
                north, east, depth = map(float, place.split(","))
                reached.append(pilot.move((north, east, depth)))
        finally:
            print(json.dumps({"reached": reached, "texts": pilot.texts}))
    finally:
        run.send_signal(signal.SIGINT)
        run.wait(60.0)


if __name__ == "__main__":
    main()
