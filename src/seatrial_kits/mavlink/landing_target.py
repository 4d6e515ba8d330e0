"""Companion computer of a drone that reports a landing pad to its autopilot."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError
from seatrial.links.endpoints.endpoint import Endpoint
from seatrial.links.endpoints.url import check_urls, open_endpoints
from seatrial.model.component import Component, Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled
from seatrial.model.waypoints import NED
from seatrial.physics.craft.kinematics import to_body

from .codec import Codec, Message

_COMPONENT = mavlink.MAV_COMP_ID_ONBOARD_COMPUTER
_HEARTBEAT_S = 1.0
_KEPT_S = 0.6
"""How long attitudes are kept: the longest latency of a camera."""


def _check_link(text: str) -> None:
    check_urls(text)
    if len(text.split()) != 1:
        raise InputError(f"link is {text!r}, one is needed")


class LandingTarget(Sampled):
    """Sends each new sight of a landing pad as LANDING_TARGET, as a program beside a camera does.

    With o the sight in {n} (`RelativePose`) and a the drone's attitude at the exposure:

        x, y, z = R(a)^T o,   distance = |o|            m; MAV_FRAME_BODY_FRD, position_valid 1
        angle_x = atan2(y, z),   angle_y = -atan2(x, z)

    forward, right and down. ``time_usec`` is the time of exposure. A sight that is not valid is
    not sent: the autopilot takes the target for lost in its own time. A HEARTBEAT goes out
    once a second, of MAV_COMP_ID_ONBOARD_COMPUTER in the system ``system_id``. Times simulated.

    It cannot be rolled back: what was sent has been sent. Raises InputError at the start for a
    link that cannot be.
    """

    rolls_back = False
    transient = Component.transient | {"_endpoint", "_codec"}
    exercised: ClassVar = {
        "link": "udpin:127.0.0.1:0",
        "sight_valid": True,
        "sight_count": 1,
        "offset": [0.1, 0.2, 2.0],
    }

    period = Parameter(0.01, "s", "period of what it takes in and sends", min=1e-6)
    link = Parameter(
        "tcpout:127.0.0.1:5762", "1", "where the autopilot's port is", check=_check_link
    )
    system_id = Parameter(1.0, "1", "MAVLink number of the drone", min=1.0, max=255.0)

    attitude = Input("rad", "Euler angles of the drone, ZYX", axes=("phi", "theta", "psi"))
    offset = Input("m", "pad from the CG of the drone, {n}", axes=NED)
    exposed = Input("s", "time of the exposure of the last sight")
    sight_valid = Input("1", "whether the last sight due came", type=bool)
    sight_count = Input("1", "number of sights so far", type=int)

    reports = Output("1", "LANDING_TARGET messages sent", type=int)
    frames_refused = Output("1", "frames received that are no message", type=int)

    feedthrough: ClassVar = {}
    terminals: ClassVar = {
        "motion": terminal("attitude"),
        "sight": terminal("offset", "exposed", "sight_valid", "sight_count"),
    }

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._endpoint: Endpoint | None = None

    def reset(self, t: float) -> None:
        """Open the link."""
        self.close()
        self._codec = Codec(round(self.system_id), _COMPONENT)
        self._attitudes: list[tuple[float, tuple[float, ...]]] = []
        self._sights = self._reports = 0
        self._greeted_at = -math.inf
        try:
            (self._endpoint,) = open_endpoints("link", self.link)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None

    def sample(self, t: float, k: int) -> None:
        """Publish the counts."""
        self.reports, self.frames_refused = self._reports, self._codec.unusable

    def update(self, t: float, k: int) -> None:
        """Send what is new."""
        assert self._endpoint is not None
        for _, data in self._endpoint.poll():
            self._codec.decode(data)
        self._attitudes.append((t, tuple(self.attitude)))
        while self._attitudes[0][0] < t - _KEPT_S:
            self._attitudes.pop(0)
        if t - self._greeted_at >= _HEARTBEAT_S:
            self._greeted_at = t
            kind, nobody = mavlink.MAV_TYPE_ONBOARD_CONTROLLER, mavlink.MAV_AUTOPILOT_INVALID
            self._send(mavlink.MAVLink_heartbeat_message(kind, nobody, 0, 0, 4, 3))
        if self.sight_valid and self.sight_count != self._sights:
            self._sights = self.sight_count
            self._reports += 1
            self._send(self._target())

    def close(self) -> None:
        """Close the link."""
        if self._endpoint is not None:
            self._endpoint.close()
        self._endpoint = None

    def _target(self) -> Message:
        """Return the message of the last sight."""
        then = min(self._attitudes, key=lambda kept: abs(kept[0] - self.exposed))[1]
        x, y, z = to_body(then, self.offset)
        distance, level = math.hypot(x, y, z), (1.0, 0.0, 0.0, 0.0)
        return mavlink.MAVLink_landing_target_message(
            time_usec=round(1e6 * self.exposed),
            target_num=0,
            frame=mavlink.MAV_FRAME_BODY_FRD,
            angle_x=math.atan2(y, z),
            angle_y=-math.atan2(x, z),
            distance=distance,
            size_x=0.0,
            size_y=0.0,
            x=x,
            y=y,
            z=z,
            q=level,
            type=mavlink.LANDING_TARGET_TYPE_VISION_FIDUCIAL,
            position_valid=1,
        )

    def _send(self, message: Message) -> None:
        assert self._endpoint is not None
        data = self._codec.encode(message)
        for channel in self._endpoint.channels():
            channel.send(data)
