"""A person at a ground station who drives ArduPilot's firmware by hand, then sends it to a place.

``python -m tests.kits.ardupilot.orders FIRMWARE ORDERS -- COMMAND...`` starts the command, which runs
the firmware, waits until it can be armed, arms it, gives each order of the JSON list ORDERS, and
interrupts the command. It prints as JSON when each order began and ended (firmware's time, s) and
what the firmware said. An order is ``{"mode": NUMBER, "s": DURATION}`` with ``"hand": [AHEAD, RIGHT,
UP]``, shares of the full stick, or with ``"to": [NORTH, EAST, DEPTH]``, m from its home.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

import pymap3d
from pymavlink import mavutil

from tests.interop.ardupilot_mission import DEPTH_HOLD, Message, Station

_POSITION_ONLY = 0xDF8
_AGAIN_S = 0.2
"""Firmware's time between two messages of a stick: it lets go of what is older than 3 s."""
_NO_CHANNEL = 65535
_ATTEMPTS = 20


class Person(Station):
    """Gives orders one after the other, each for a duration of the firmware's time."""

    def __init__(self, firmware: str) -> None:
        super().__init__(firmware)
        self.is_sub = firmware == "sub"

    def arm(self) -> None:
        """Arm it at rest, again as long as its checks object: waves shake its accelerometers."""
        if self.is_sub:
            self._hand((0.0, 0.0, 0.0))
            assert self._set_mode(DEPTH_HOLD) == 0
        for _ in range(_ATTEMPTS):
            if self.command(mavutil.mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0) == 0:
                return
            self._pass(2.0)
        raise AssertionError(self.texts)

    def order(self, order: dict[str, Any]) -> tuple[float, float]:
        """Give an order, and return when it began and ended."""
        assert self._set_mode(order["mode"]) == 0, self.texts
        if "to" in order:
            self._send_to(order["to"])
        begun = self._time()
        while self._time() < begun + order["s"]:
            if "hand" in order:
                self._hand(order["hand"])
            elif self.is_sub:
                self._hand((0.0, 0.0, 0.0))  # its failsafe wants a pilot
            self._pass(_AGAIN_S)
        return begun, self._time()

    def _pass(self, seconds: float) -> None:
        due = self._time() + seconds
        self.until(60.0, lambda _: self._time() >= due)

    def _time(self) -> float:
        return float(self.newest["ATTITUDE"].time_boot_ms / 1e3)

    def wait_until_ready(self) -> None:
        """Wait until it can be armed, with its attitude 20 times a second as the clock."""
        super().wait_until_ready()
        number = mavutil.mavlink.MAVLINK_MSG_ID_ATTITUDE
        self._link.mav.command_long_send(1, 1, 511, 0, number, 5e4, 0, 0, 0, 0, 0)
        self.until(10.0, lambda message: message.get_type() == "ATTITUDE")

    def _hand(self, shares: Sequence[float]) -> None:
        ahead, right, up = shares
        if self.is_sub:
            axes = (1000 * ahead, 0, 500 + 500 * up, 1000 * right)
            self._link.mav.manual_control_send(1, *map(round, axes), 0)
            return
        steering, throttle = (round(1500 + 400 * share) for share in (right, ahead))
        others = (_NO_CHANNEL,) * 5
        self._link.mav.rc_channels_override_send(1, 1, steering, _NO_CHANNEL, throttle, *others)

    def _send_to(self, place: Sequence[float]) -> None:
        north, east, depth = place
        home: Message = self.newest["HOME_POSITION"]
        origin = (home.latitude / 1e7, home.longitude / 1e7, 0.0)
        latitude, longitude, _ = pymap3d.ned2geodetic(north, east, 0.0, *origin)
        self._link.mav.set_position_target_global_int_send(
            0, 1, 1, mavutil.mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, _POSITION_ONLY,
            round(latitude * 1e7), round(longitude * 1e7), -depth, 0, 0, 0, 0, 0, 0, 0, 0,
        )  # fmt: skip


def main() -> None:
    between = sys.argv.index("--")
    firmware, orders = sys.argv[1], json.loads(sys.argv[2])
    run = subprocess.Popen(sys.argv[between + 1 :], stdout=sys.stderr)
    times: list[tuple[float, float]] = []
    try:
        person = Person(firmware)
        try:
            person.wait_until_ready()
            person.arm()
            times += [person.order(order) for order in orders]
        finally:
            print(json.dumps({"times": times, "texts": person.texts}))
    finally:
        run.send_signal(signal.SIGINT)
        run.wait(60.0)


if __name__ == "__main__":
    main()
