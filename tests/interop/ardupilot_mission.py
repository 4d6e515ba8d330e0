"""A ground station that sends ArduPilot's firmware on a mission, at its own port of this machine.

``python -m tests.interop.ardupilot_mission FIRMWARE NORTH,EAST,DEPTH... -- COMMAND...`` starts the
command, which runs the firmware, uploads the waypoints (m, from the firmware's home), arms, starts
the mission, interrupts the command, and prints as JSON when which waypoint was reached (firmware's
time, s) and what the firmware said.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import pymap3d
from pymavlink import mavutil

AUTO = {"rover": 10, "sub": 3}
DEPTH_HOLD = 2
"""Modes of ArduPilot Rover and ArduSub."""
ADDRESS = "tcp:127.0.0.1:5760"
START_S, READY_S, MISSION_S = 300.0, 600.0, 900.0
"""Wall time for the run to be built, for the estimator to converge, and for the mission."""
_PREARM = mavutil.mavlink.MAV_SYS_STATUS_PREARM_CHECK
_ABSOLUTE_POSITION = mavutil.mavlink.EKF_POS_HORIZ_ABS
_STREAMS = {"SYS_STATUS": 1.0, "SYSTEM_TIME": 2.0, "EKF_STATUS_REPORT": 1.0, "HOME_POSITION": 0.5}
"""All that is sent, Hz of simulated time: a station must keep up with many times real time."""

Message = Any


class Station:
    """The connection, the newest message of each name, and all texts."""

    def __init__(self, firmware: str) -> None:
        self.newest: dict[str, Message] = {}
        self.texts: list[str] = []
        self.reached: dict[int, float] = {}
        self._link = _connected()
        self._auto = AUTO[firmware]
        self._hold = DEPTH_HOLD if firmware == "sub" else None

    def until(self, within_s: float, holds: Callable[[Message], bool]) -> Message:
        """Take messages in until one is as wanted. Raises TimeoutError."""
        deadline = time.monotonic() + within_s
        while time.monotonic() < deadline:
            message = self._link.recv_match(blocking=True, timeout=0.5)
            if message is None:
                continue
            name = message.get_type()
            self.newest[name] = message
            if name == "STATUSTEXT":
                self.texts.append(message.text)
            if name == "MISSION_ITEM_REACHED":
                self.reached[message.seq] = self.newest["SYSTEM_TIME"].time_boot_ms / 1e3
            if holds(message):
                return message
        raise TimeoutError(f"after {self.texts[-5:]}")

    def command(self, number: int, *parameters: float) -> int:
        """Send a command, and return its result."""
        seven = (*parameters, *(0.0,) * (7 - len(parameters)))
        self._link.mav.command_long_send(1, 1, number, 0, *seven)
        answer = self.until(10.0, lambda m: m.get_type() == "COMMAND_ACK" and m.command == number)
        return int(answer.result)

    def wait_until_ready(self) -> None:
        """Wait until nothing speaks against arming."""
        deadline = time.monotonic() + READY_S
        while time.monotonic() < deadline:
            self._link.mav.request_data_stream_send(1, 1, mavutil.mavlink.MAV_DATA_STREAM_ALL, 0, 0)
            for name, rate in _STREAMS.items():
                number = getattr(mavutil.mavlink, f"MAVLINK_MSG_ID_{name}")
                self._link.mav.command_long_send(1, 1, 511, 0, number, 1e6 / rate, 0, 0, 0, 0, 0)
            try:
                self.until(5.0, lambda _: self._is_ready())
            except TimeoutError:
                continue
            return
        raise TimeoutError(f"not ready: {self.texts[-5:]}")

    def upload(self, waypoints: list[tuple[float, float, float]]) -> None:
        """Upload waypoints, with home as item 0."""
        home = self.newest["HOME_POSITION"]
        origin = (home.latitude / 1e7, home.longitude / 1e7, 0.0)
        items = [(0.0, 0.0, 0.0), *waypoints]
        self._link.mav.mission_count_send(1, 1, len(items), 0)
        wanted = ("MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK")
        while (asked := self.until(10.0, lambda m: m.get_type() in wanted)).get_type() != wanted[2]:
            north, east, depth = items[asked.seq]
            latitude, longitude, _ = pymap3d.ned2geodetic(north, east, 0.0, *origin)
            self._link.mav.mission_item_int_send(
                1, 1, asked.seq, mavutil.mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
                mavutil.mavlink.MAV_CMD_NAV_WAYPOINT, 0, 1, 0, 0, 0, 0,
                round(latitude * 1e7), round(longitude * 1e7), -depth, 0,
            )  # fmt: skip
        assert asked.type == mavutil.mavlink.MAV_MISSION_ACCEPTED

    def drive(self, last: int) -> None:
        """Arm, start the mission, and wait until its last item is reached."""
        if self._hold is not None:
            assert self._set_mode(self._hold) == 0
        assert self.command(mavutil.mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0) == 0, self.texts
        assert self._set_mode(self._auto) == 0
        self.until(MISSION_S, lambda _: last in self.reached)

    def _set_mode(self, mode: int) -> int:
        return self.command(mavutil.mavlink.MAV_CMD_DO_SET_MODE, 1.0, mode)

    def _is_ready(self) -> bool:
        if not {*_STREAMS} <= self.newest.keys():
            return False
        health = self.newest["SYS_STATUS"].onboard_control_sensors_health
        return bool(
            health & _PREARM and self.newest["EKF_STATUS_REPORT"].flags & _ABSOLUTE_POSITION
        )


def _connected() -> Any:
    deadline = time.monotonic() + START_S
    while True:
        try:
            link = mavutil.mavlink_connection(ADDRESS, source_system=255, retries=1)
        except OSError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.2)
            continue
        link.wait_heartbeat(timeout=60)
        return link


def main() -> None:
    between = sys.argv.index("--")
    firmware, *places = sys.argv[1:between]
    waypoints = []
    for place in places:
        north, east, depth = (float(part) for part in place.split(","))
        waypoints.append((north, east, depth))
    run = subprocess.Popen(sys.argv[between + 1 :], stdout=sys.stderr)
    try:
        station = Station(firmware)
        try:
            station.wait_until_ready()
            station.upload(waypoints)
            station.drive(len(waypoints))
        finally:
            print(json.dumps({"reached": station.reached, "texts": station.texts}))
    finally:
        run.send_signal(signal.SIGINT)
        run.wait(60.0)


if __name__ == "__main__":
    main()
