"""A stand-in for ArduPilot's end of MAVLink: pymavlink's own parser, and the least that it takes.

`Px4Vehicle` is one for PX4's. As a program it is a firmware too: the physics come from seatrial, and it steers a boat with two
thrusters to its waypoints.
"""

from __future__ import annotations

import math
import socket
import sys

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.kits.ardupilot.peer import Peer

HOME = (-31.78, -52.26)
AUTO = 10
READY_S = 12.0
"""Of the program: its estimator is ready then, and home is where it is then."""
ACK = {"accepted": mavlink.MAV_RESULT_ACCEPTED, "denied": mavlink.MAV_RESULT_DENIED}


class Vehicle:
    """A boat that knows its mission; ``deaf`` names messages that it loses the first time."""

    def __init__(self, address: tuple[str, int], deaf: tuple[str, ...] = ()) -> None:
        self.socket = socket.create_connection(address, timeout=5.0)
        self.socket.setblocking(False)
        self.mav = mavlink.MAVLink(None, 1, 1)
        self.mav.robust_parsing = True
        self.autopilot, self.kind = (
            mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
            mavlink.MAV_TYPE_SURFACE_BOAT,
        )
        self.state, self.mode, self.armed = mavlink.MAV_STATE_STANDBY, 0, False
        self.healthy, self.result, self.arms_after = True, mavlink.MAV_MISSION_ACCEPTED, 0
        self.items: dict[int, mavlink.MAVLink_message] = {}
        self.parameters: dict[str, float] = {}
        self.received: list[mavlink.MAVLink_message] = []
        self.home, self.place, self.ms = HOME, (0.0, 0.0), 0
        """Its home, degrees; where it takes itself to be, m north and east of HOME; its clock."""
        self._count, self._deaf = 0, list(deaf)

    def send(self, message: mavlink.MAVLink_message) -> None:
        data = message.pack(self.mav)
        self.mav.seq = (self.mav.seq + 1) % 256
        self.socket.send(data)

    def say(self, text: str) -> None:
        self.send(mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_CRITICAL, text.encode()))

    def beat(self) -> None:
        """Send what a firmware streams."""
        base = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        base |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED if self.armed else 0
        self.send(
            mavlink.MAVLink_heartbeat_message(
                self.kind, self.autopilot, base, self.mode, self.state, 3
            )
        )
        health = mavlink.MAV_SYS_STATUS_PREARM_CHECK if self.healthy else 0
        self.send(mavlink.MAVLink_sys_status_message(0, 0, health, *(0,) * 10))
        self.estimate()
        at = [round(angle * 1e7) for angle in self.home]
        self.send(mavlink.MAVLink_home_position_message(*at, 0, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0))
        here = [round(angle * 1e7) for angle in geodetic(*self.place)]
        self.send(mavlink.MAVLink_global_position_int_message(self.ms, *here, 0, 0, 0, 0, 0, 0))

    def estimate(self) -> None:
        flags = mavlink.EKF_POS_HORIZ_ABS
        self.send(mavlink.MAVLink_ekf_status_report_message(flags, *(0.0,) * 5))

    def attend(self) -> None:
        """Answer what came."""
        try:
            data = self.socket.recv(65536)
        except BlockingIOError:
            return
        for message in self.mav.parse_buffer(data) or ():
            name = message.get_type()
            assert name != "BAD_DATA"
            self.received.append(message)
            if name in self._deaf:
                self._deaf.remove(name)
            elif hasattr(self, f"on_{name.lower()}"):
                getattr(self, f"on_{name.lower()}")(message)

    def on_mission_count(self, message: mavlink.MAVLink_message) -> None:
        self._count = message.count
        self._request(0)

    def on_mission_item_int(self, message: mavlink.MAVLink_message) -> None:
        self.items[message.seq] = message
        if message.seq + 1 < self._count:
            self._request(message.seq + 1)
        else:
            self.send(mavlink.MAVLink_mission_ack_message(255, 190, self.result, 0))

    def on_command_long(self, message: mavlink.MAVLink_message) -> None:
        result = "accepted"
        if message.command == mavlink.MAV_CMD_COMPONENT_ARM_DISARM:
            self.arms_after -= 1
            result = "denied" if self.arms_after >= 0 else "accepted"
            self.armed = result == "accepted"
        elif message.command == mavlink.MAV_CMD_DO_SET_MODE:
            self.mode = self.mode_of(message)
        self.send(mavlink.MAVLink_command_ack_message(message.command, ACK[result]))

    def mode_of(self, message: mavlink.MAVLink_message) -> int:
        return int(message.param2)

    def on_param_set(self, message: mavlink.MAVLink_message) -> None:
        self.parameters[message.param_id] = message.param_value
        self.send(
            mavlink.MAVLink_param_value_message(
                message.param_id.encode(), message.param_value, message.param_type, 1, 0
            )
        )

    def reach(self, number: int) -> None:
        self.send(mavlink.MAVLink_mission_item_reached_message(number))

    def _request(self, number: int) -> None:
        self.send(mavlink.MAVLink_mission_request_int_message(255, 190, number, 0))


class Px4Vehicle(Vehicle):
    """PX4's differences: other modes, another message of the estimator, no item of its home."""

    def __init__(self, address: tuple[str, int], deaf: tuple[str, ...] = ()) -> None:
        super().__init__(address, deaf)
        self.autopilot = mavlink.MAV_AUTOPILOT_PX4

    def estimate(self) -> None:
        flags = mavlink.ESTIMATOR_POS_HORIZ_ABS
        self.send(mavlink.MAVLink_estimator_status_message(0, flags, *(0.0,) * 8))

    def mode_of(self, message: mavlink.MAVLink_message) -> int:
        """Return the main mode in the third byte, the sub-mode in the fourth."""
        return int(message.param2) << 16 | int(message.param3) << 24


def radii() -> tuple[float, float]:
    """Return metres per radian of latitude and of longitude at HOME, by the curvature of WGS 84."""
    a, f = 6378137.0, 1.0 / 298.257223563
    latitude, e2 = math.radians(HOME[0]), f * (2.0 - f)
    w = math.sqrt(1.0 - e2 * math.sin(latitude) ** 2)
    return a * (1.0 - e2) / w**3, a / w * math.cos(latitude)


def placed(item: mavlink.MAVLink_message) -> tuple[float, float]:
    """Return an item's place north and east of HOME, m."""
    north, east = (
        math.radians(x / 1e7 - home) * radius
        for x, home, radius in zip((item.x, item.y), HOME, radii(), strict=True)
    )
    return north, east


def geodetic(north: float, east: float) -> tuple[float, float]:
    """Return latitude and longitude, degrees, of a place from HOME, m."""
    latitude, longitude = (
        home + math.degrees(off / radius)
        for home, off, radius in zip(HOME, (north, east), radii(), strict=True)
    )
    return latitude, longitude


def steered(vehicle: Vehicle, north: float, east: float, heading: float, leg: int) -> list[int]:
    """Return the pulses on channels 1 to 3 that lead to waypoint ``leg``."""
    there = placed(vehicle.items[leg])
    wanted = math.atan2(there[1] - east, there[0] - north)
    error = math.remainder(wanted - heading, math.tau)
    turn = max(-120.0, min(120.0, 150.0 * error))
    ahead = 120.0 * max(0.0, math.cos(error))
    return [round(1500 + ahead + turn), 0, round(1500 + ahead - turn)]


def main() -> None:
    options = dict(zip(sys.argv[1::2], sys.argv[2::2], strict=True))
    kind, host, port = options["--serial0"].split(":")
    assert kind == "tcpclient"
    vehicle = Vehicle((host, int(port)))
    peer = Peer(int(options["--sim-port-out"]), 16, int(options["--rate"]))
    leg, pulses, beaten = 1, [], -1.0
    while True:
        answer = peer.exchange(*pulses)
        t = answer.number("timestamp")
        north, east, _ = answer.vector("position")
        vehicle.attend()
        vehicle.place, vehicle.ms = (north, east), round(1e3 * t)
        if t < READY_S:
            vehicle.home, vehicle.healthy = geodetic(north, east), False
        else:
            vehicle.healthy = True
        if t - beaten >= 0.5:
            beaten = t
            vehicle.beat()
        if vehicle.armed and vehicle.mode == AUTO and leg in vehicle.items:
            if math.dist(placed(vehicle.items[leg]), (north, east)) < 1.0:
                vehicle.reach(leg)
                leg += 1
            if leg in vehicle.items:
                pulses = steered(vehicle, north, east, answer.vector("attitude")[2], leg)
            else:
                pulses = [1500, 0, 1500]


if __name__ == "__main__":
    main()
