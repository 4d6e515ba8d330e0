"""Ground station as a component: a mission out, how it goes back."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError, SimulationError
from seatrial.links.endpoints.budget import Budget
from seatrial.links.endpoints.endpoint import Channel, Endpoint
from seatrial.links.endpoints.url import check_urls, open_endpoints
from seatrial.links.geodesy import Origin
from seatrial.model.component import Component, Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled
from seatrial.model.waypoints import NED, Place, Waypoints

from ..codec import Codec, Message
from .conversation import ASK_AGAIN_S, Conversation
from .dialects import Dialect
from .errand import LAST, Errand, home_of, mission

SYSTEM, COMPONENT = 255, mavlink.MAV_COMP_ID_MISSIONPLANNER
HEARTBEAT_S = 1.0
_ALARMED = (mavlink.MAV_STATE_CRITICAL, mavlink.MAV_STATE_EMERGENCY)
_STATION, _NO_AUTOPILOT = mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID
_REAL = mavlink.MAV_PARAM_TYPE_REAL32
_ARMED = mavlink.MAV_MODE_FLAG_SAFETY_ARMED
_NOWHERE: Place = (0.0, 0.0, 0.0)
FAILURES = {
    "gnss": (("SIM_GPS1_ENABLE", 0.0, 1.0),),
    "compass": tuple((f"SIM_MAG{number}_FAIL", 1.0, 0.0) for number in (1, 2, 3)),
    "battery": (("SIM_BATT_VOLTAGE", 9.6, 12.6),),
}
"""ArduPilot's simulated instruments: parameter, its value without the instrument, and with it."""


def _check_link(text: str) -> None:
    check_urls(text)
    if len(text.split()) > 1:
        raise InputError(f"link is {text!r}, at most one is needed")


def _by_tcp(address: str) -> str:
    """Return the link to a vehicle that is reached at ``address``."""
    for each in address.split():
        if each.startswith("tcp:"):
            return f"tcpout:{each.removeprefix('tcp:')}"
    raise InputError(f"the vehicle is reached at {address!r}, one link tcpin of it is needed")


class GroundStation(Waypoints, Sampled):
    """A person at a ground station, who sends a MAVLink vehicle round a list of waypoints.

    It waits for the vehicle, at ``link`` or else at ``address``, and for its estimator; uploads the
    waypoints by the mission protocol, as NAV_WAYPOINT north and east of ``latitude`` and
    ``longitude``, the origin of {n}, and ``down`` below the vehicle's own home; arms, and starts
    the mission. Everything is repeated until it is answered. What the vehicle takes for its home
    is where it was when its estimator got ready: the waypoints do not depend on that.

    The last waypoint is passed as the others are, or by ``last`` one to "loiter" at
    (NAV_LOITER_UNLIM), or to "land" at (NAV_LAND). A multirotor takes off to the height of the
    first waypoint (NAV_TAKEOFF).

    ``estimate`` is where the vehicle says that it is (GLOBAL_POSITION_INT, at 2 Hz), ``home``
    what it takes for its home, both in {n}, m; ``estimated`` whether it has said either.

    For boats and rovers of ArduPilot and PX4, for submarines and multirotors of ArduPilot, and for
    vehicles that present themselves as such.

    ``failsafe`` is true from the first heartbeat on that says CRITICAL or EMERGENCY, and where
    the vehicle leaves the mission's mode or disarms before its last waypoint.

    ``without`` takes an instrument from ArduPilot's simulated ones, which it makes of the true
    motion: GNSS (SIM_GPS1_ENABLE 0), all compasses (SIM_MAG1_FAIL to SIM_MAG3_FAIL 1), or the
    charge of the battery (SIM_BATT_VOLTAGE 9.6 V of 12.6 V). So do ``position_valid`` and
    ``heading_valid`` where they are false: an outage of the vehicle's own sensors reaches the
    firmware. While it is ``silent`` it sends nothing, as a station that is lost.

    Raises InputError at the start for a link that cannot be, and SimulationError in a step for
    what the vehicle does not do in time, with what it said last, and for one whose home is more
    than 50 km from the origin of {n}. Times are simulated.

    It cannot be rolled back: what was sent has been sent.
    """

    rolls_back = False
    transient = Component.transient | {"_endpoint", "_codec", "_conversation", "_errand"}
    exercised: ClassVar = {"link": "udpin:127.0.0.1:0"}

    period = Parameter(0.1, "s", "period of what it sends and takes in", min=1e-6)
    latitude = Parameter(
        0.0, "rad", "of the origin of {n}, WGS 84", min=-1.5707964, max=1.5707964, role="home"
    )
    longitude = Parameter(
        0.0, "rad", "of the origin of {n}, WGS 84", min=-math.pi, max=math.pi, role="home"
    )
    link = Parameter("", "1", "where the vehicle is; empty: at its address", check=_check_link)

    last = Parameter("waypoint", "1", "what the last waypoint is", choices=LAST)

    address = Input(
        "1", "what the vehicle is reached at, by TCP among others", type=str, optional=True
    )

    without = Input(
        "1", "what ArduPilot's simulation lacks", axes=tuple(FAILURES), type=bool, optional=True
    )

    position_valid = Input(
        "1", "whether the vehicle's GNSS has a fix", type=bool, start=True, optional=True
    )
    heading_valid = Input(
        "1", "whether the vehicle's compass works", type=bool, start=True, optional=True
    )

    silent = Input("1", "whether it sends nothing", type=bool, optional=True)

    connected = Output("1", "whether the vehicle has sent something", type=bool)
    doing = Output("1", "what it waits for", type=str)
    armed = Output("1", "whether the vehicle says that it is armed", type=bool)
    mode = Output("1", "the vehicle's mode, its custom_mode", type=int)
    under_way = Output("1", "whether the mission was started", type=bool)
    reached = Output("1", "number of the last waypoint that the vehicle took for reached", type=int)
    frames_refused = Output("1", "frames received that are no message", type=int)
    failsafe = Output("1", "whether the vehicle had a failsafe or left its mission", type=bool)

    estimated = Output("1", "whether the vehicle has said where it is, and its home", type=bool)
    estimate = Output("m", "where the vehicle says that it is, {n}", axes=NED)
    estimate_time = Output("s", "time of the estimate by the vehicle's clock")
    home = Output("m", "what the vehicle takes for its home, {n}", axes=NED)

    feedthrough: ClassVar = {}
    terminals: ClassVar = {
        "sensors": terminal("position_valid", "heading_valid"),
        "report": terminal("failsafe", "estimated", "estimate", "estimate_time", "home"),
    }

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._endpoint: Endpoint | None = None

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Open the link, if there is one."""
        self.close()
        self._places, self._refused = self.waypoints(), 0
        self._origin = Origin(self.latitude, self.longitude)
        self._channel: Channel | None = None
        self._started: Dialect | None = None
        self._begin()
        try:
            if self.link:
                self._open(self.link)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None

    def sample(self, t: float, k: int) -> None:
        """Publish how it goes."""
        self.connected = bool(self._conversation.system)
        self.doing, self.under_way = self._doing, self._started is not None
        self.armed, self.mode = self._armed, self._mode
        self.reached, self.failsafe = self._reached, self._failsafe
        self.frames_refused = self._refused
        self.estimated = self._estimate is not None and self._home is not None
        self.estimate, self.home = self._estimate or _NOWHERE, self._home or _NOWHERE
        self.estimate_time = self._estimate_time

    def update(self, t: float, k: int) -> None:
        """Take in what came, and go on."""
        try:
            if self._endpoint is None:
                self._open(_by_tcp(self.address))
            self._take_in(t)
            self._greet(t)
            self._go_on()
        except (InputError, SimulationError) as error:
            raise SimulationError(f"{self.name}: {error}") from None
        self._set_instruments(t)

    def close(self) -> None:
        """Close the link."""
        if self._endpoint is not None:
            self._endpoint.close()
        self._endpoint = None

    # ------------------------------------------------------------------ inside

    def _open(self, link: str) -> None:
        (self._endpoint,) = open_endpoints("link", link)
        self._endpoint.budget = Budget.of_raw_bytes()  # many times real time

    def _begin(self) -> None:
        self._codec = Codec(SYSTEM, COMPONENT)
        self._conversation = Conversation(self._send)
        self._errand: Errand = mission(
            self._conversation, self._places, self.radius, self._origin, self.last
        )
        self._doing, self._started = "", None
        self._armed, self._mode, self._reached, self._failsafe = False, 0, 0, False
        self._estimate: Place | None = None
        self._estimate_time = 0.0
        self._home: Place | None = None
        self._given = {name: usual for each in FAILURES.values() for name, _, usual in each}
        self._greeted_at = self._set_at = -math.inf

    def _send(self, message: Message) -> None:
        if self.silent:
            return
        assert self._endpoint is not None
        data = self._codec.encode(message)
        for channel in self._endpoint.channels():
            channel.send(data)

    def _greet(self, t: float) -> None:
        if t - self._greeted_at < HEARTBEAT_S:
            return
        self._greeted_at = t
        active = mavlink.MAV_STATE_ACTIVE
        self._send(mavlink.MAVLink_heartbeat_message(_STATION, _NO_AUTOPILOT, 0, 0, active, 3))
        vehicle = self._conversation.newest.get("HEARTBEAT")
        if vehicle is not None and vehicle.type == mavlink.MAV_TYPE_SUBMARINE:
            # Its failsafe wants a pilot: manual control at rest, as a joystick sends it.
            at_rest = (0, 0, 500, 0)
            self._send(mavlink.MAVLink_manual_control_message(vehicle.get_srcSystem(), *at_rest, 0))

    def _take_in(self, t: float) -> None:
        assert self._endpoint is not None
        self._conversation.now = t
        for channel, data in self._endpoint.poll():
            if self._channel is not None and channel is not self._channel:
                self._begin()  # a vehicle that was started again
                self._conversation.now = t
            self._channel = channel
            before = self._codec.unusable
            messages = self._codec.decode(data)
            self._refused += self._codec.unusable - before
            for message in messages:
                if self._conversation.take(message):
                    self._note(message)

    def _go_on(self) -> None:
        try:
            self._doing = next(self._errand)
        except StopIteration as started:
            if started.value is not None:
                self._doing, self._started = "", started.value

    def _note(self, message: Message) -> None:
        """Note what a message says of the mission."""
        kind = message.get_type()
        if kind == "MISSION_ITEM_REACHED":
            before = 1 if self._started is None else self._started.before
            self._reached = max(self._reached, message.seq - before + 1)
        if kind == "PARAM_VALUE":
            self._given[message.param_id] = message.param_value
        if kind == "GLOBAL_POSITION_INT" and (message.lat or message.lon):  # both 0: no fix yet
            north, east, _ = self._origin.position(message.lat / 1e7, message.lon / 1e7, 0.0)
            self._estimate = (north, east, -message.relative_alt / 1e3)
            self._estimate_time = message.time_boot_ms / 1e3
        if kind == "HOME_POSITION":
            self._home = home_of(message, self._origin)
        if kind != "HEARTBEAT":
            return
        self._armed, self._mode = bool(message.base_mode & _ARMED), message.custom_mode
        if self._started is not None and self._reached < len(self._places):
            left = not self._armed or self._mode != self._started.shown
            self._failsafe = self._failsafe or left or message.system_status in _ALARMED

    def _set_instruments(self, t: float) -> None:
        """Set the parameters of instruments that are not as they should be."""
        if not self._conversation.system:
            return
        fails = (not self.position_valid, not self.heading_valid, False)
        without = [gone or failed for gone, failed in zip(self.without, fails, strict=True)]
        wanted = {
            name: broken if gone else usual
            for gone, settings in zip(without, FAILURES.values(), strict=True)
            for name, broken, usual in settings
        }
        other = [  # a parameter comes back in single precision
            name
            for name, value in wanted.items()
            if not math.isclose(self._given[name], value, rel_tol=1e-6)
        ]
        if not other or t - self._set_at < ASK_AGAIN_S:
            return
        self._set_at = t
        for name in other:
            self._send(
                mavlink.MAVLink_param_set_message(
                    self._conversation.system, 1, name.encode(), wanted[name], _REAL
                )
            )
