"""A stand-in for PX4's simulated firmware, after its simulator's documented packets.

It connects, sends HEARTBEAT and asks for HIL_STATE_QUATERNION, takes its clock from HIL_SENSOR of
id 0, and sends HIL_ACTUATOR_CONTROLS while a controller of its runs. As a program it takes the
firmware's options and environment.
"""

from __future__ import annotations

import os
import socket
import sys
import time
from typing import Any

from pymavlink.dialects.v20 import common as mavlink

ARMED = mavlink.MAV_MODE_FLAG_SAFETY_ARMED
CUSTOM = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
Message = Any


class Peer:
    """The firmware's end of the exchange."""

    def __init__(self, port: int, within_s: float = 20.0) -> None:
        self.socket = connected(port, within_s)
        self.mav = mavlink.MAVLink(None, 1, 1)
        self.us = 0
        self.sent: list[Message] = []
        self._rest: list[Message] = []
        px4 = mavlink.MAV_AUTOPILOT_PX4
        self._send(mavlink.MAVLink_heartbeat_message(0, px4, 0, 0, 0, 3))
        wanted = mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION
        interval = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
        self._send(mavlink.MAVLink_command_long_message(0, 0, interval, 0, wanted, 5e3, *(0,) * 5))

    def sense(self, timeout: float = 10.0) -> list[Message]:
        """Return all that has come up to the next HIL_SENSOR, which sets the clock."""
        self.socket.settimeout(timeout)
        found: list[Message] = []
        while True:
            while self._rest:
                message = self._rest.pop(0)
                assert message.get_type() != "BAD_DATA"
                found.append(message)
                if message.get_type() == "HIL_SENSOR" and message.id == 0:
                    assert message.time_usec > self.us, "its clock goes back or stands still"
                    self.us = message.time_usec
                    return found
            data = self.socket.recv(65536)
            if not data:
                raise ConnectionResetError("the simulator has gone")
            self._rest += self.mav.parse_buffer(data) or []

    def act(self, *controls: float, armed: bool = True, us: int | None = None) -> None:
        """Send actuators of the clock's time, or of another."""
        sixteen = [*controls, *[0.0] * (16 - len(controls))]
        mode = CUSTOM | (ARMED if armed else 0)
        at = self.us if us is None else us
        self._send(mavlink.MAVLink_hil_actuator_controls_message(at, sixteen, mode, 1))

    def close(self) -> None:
        self.socket.close()

    def _send(self, message: Message) -> None:
        self.socket.sendall(message.pack(self.mav))


def connected(port: int, within_s: float) -> socket.socket:
    """Connect, trying again as the firmware does."""
    deadline = time.monotonic() + within_s
    while True:
        try:
            opened = socket.create_connection(("127.0.0.1", port), timeout=5.0)
        except OSError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.005)
            continue
        opened.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return opened


def main() -> None:
    """Answer nothing for a second of simulated time, then arm and drive ahead."""
    daemon, instance, number, etc = sys.argv[1:]
    assert (daemon, instance) == ("-d", "-i")
    print("pid", os.getpid())
    print("etc", etc)
    for name in sorted(os.environ):
        if name.startswith("PX4_"):
            print(f"{name}={os.environ[name]}")
    sys.stdout.flush()
    os.makedirs("log/2026-01-01")
    with open("log/2026-01-01/00_00_00.ulg", "wb") as log:
        log.write(b"ULog")
    peer = Peer(4560 + int(number))
    while True:
        peer.sense()
        if peer.us >= 1_000_000:
            peer.act(0.5, 0.0, 0.5)


if __name__ == "__main__":
    main()
