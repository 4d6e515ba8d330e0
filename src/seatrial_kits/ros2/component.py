"""The ROS 2 link as a component: measurements out, commands of nodes in."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.earth_field import earth_field
from seatrial.links.geodesy import Origin
from seatrial.links.parameter_validation import start_us
from seatrial.links.unconnected import is_connected
from seatrial.links.vehicle_sensors import read_instruments
from seatrial.model.component import NS
from seatrial.model.sampled import Sampled

from . import faults
from .bag import Bag
from .commands import Commands
from .diagnostics import diagnostics
from .faults import NONE, Faults
from .instruments import Instruments
from .joining import join
from .lockstep import Lockstep, awaited
from .mismatches import Mismatches
from .outlet import Outlet
from .ports import ANGLED, CHANNELS, SHARED, UNITS, Ros2Ports
from .published import Here
from .simulator import Simulator
from .steering import Orders
from .topics import Names
from .transport import Transport

_LOGGER = logging.getLogger("seatrial.ros2")
_LEG_RADIUS = 3.0
"""Distance at which the end of a leg is reached that says none, m."""
_PILOTED = ("piloted_pulse", "piloted_share", "piloted_angle")


class Ros2(Ros2Ports):
    """A vehicle among the nodes of ROS 2, over DDS without a ROS installation, or over rclpy.

    Every ``period`` it writes the clock, the truth and what sensors measured. Topics are below
    ``/NAMESPACE``, unless ``topics`` names them otherwise (`topics`, `published`).

    **Axes** are those of REP 103 and 105: map and odom east-north-up, base_link ahead-left-up in
    the body origin, sensors parallel to it where the profile mounts them. **Stamps** are
    simulated time, from 0 or from the ``date``.

    **Commands** go to single actuators, or to the vehicle's pilot (`Commands`). Older than
    ``timeout`` of simulated time, they are neutral: actuators at rest, the pilot disarmed.
    Numbers that are not finite, and a second publisher of one topic, are ``refused``.

    **Free running** outputs have, at each instant, all commands that came until they are read;
    velocities are added to heading and depth as measured an instant before. In **lockstep** the
    step waits for the commands that are ``awaited`` (`Lockstep`), which are on the outputs from
    the instant after: then every run has the same numbers.

    With ``bag`` = "on" all that it writes is kept as a bag too, NAME in the run's folder.

    **Hosts**: on the loopback interface alone, unless a run is allowed the network.

    Not here: images and point clouds, parameters of nodes.
    It cannot be rolled back: what was written has been read.

    Raises InputError at the start for a domain that cannot be joined, a middleware that is no
    DDS where rclpy cannot be had, and without the packages cyclonedds and rosbags.
    """

    rolls_back = False
    feedthrough: ClassVar = {
        name: _PILOTED if name in ("pulse", "share", "angle") else ()
        for name, port in Ros2Ports.ports.items()
        if port.kind == "output"
    }
    transient = Sampled.transient | {
        "_joined",
        "_outlet",
        "_commands",
        "_lockstep",
        "_simulator",
        "_faults",
        "_fault_service",
        "_names",
        "_mismatches",
        "_bag",
    }

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._joined: Transport | None = None
        self._commands: Commands | None = None
        self._bag: Bag | None = None

    def reset(self, t: float) -> None:
        """Join the domain."""
        self.close()
        try:
            self._names = Names(self.namespace, self.topics)
            node = self.simulator or self._names.full("seatrial")
            self._joined = join(round(self.domain), node, self.transport)
        except InputError as error:
            self.close()
            raise InputError(f"{self.name}: {error}") from None
        boot_us = start_us(self.date)
        self._boot_ns = 1000 * boot_us if self.clock == "date" else 0
        self._origin = Origin(self.latitude, self.longitude, self.altitude)
        place = self.latitude, self.longitude, self.altitude
        self._field = earth_field(*place, 1e-6 * boot_us)
        self._instruments = Instruments(read_instruments(self.instruments))
        self._outlet = Outlet(self._joined, self._names, self._say)
        self._mismatches = Mismatches(self._joined, self._say)
        self._lockstep: Lockstep | None = None
        self._simulator: Simulator | None = None
        if self.simulator:
            entity = self._names.namespace.removeprefix("/")
            self._simulator = Simulator(self._joined, self.simulator, self, entity)
            for lacking in self._simulator.lacking:
                self._say(f"a service is not offered: {lacking}")
        self._faults: Faults | None = None
        self._diagnosed_ns, self._diagnosed = self._boot_ns, ""
        self._orders, self._source, self._reached = Orders(), "none", 0
        self._direct: dict[str, float] | None = None
        self._received = -1.0

    def read(self, references: Sequence[int], kind: type) -> list[Any]:
        """Return outputs that follow what has come by now, as `Component.read`."""
        self._look()
        return super().read(references, kind)

    def reader(self, references: Sequence[int], kind: type) -> Callable[[], list[Any]]:
        """Return what does the same as `read`."""
        own = super().reader(references, kind)

        def read() -> list[Any]:
            self._look()
            return own()

        return read

    def outputs(self, t: float) -> None:
        """Take in what has come, unless it is awaited, and publish."""
        if self._commands is not None and self._instant_ns() == round(t * NS):
            self._receive(self._commands, t)
        super().outputs(t)

    def sample(self, t: float, k: int) -> None:
        """Publish what the vehicle was commanded until now."""
        orders, direct = self._orders, self._direct
        self.source = self._source
        for port, axes in (("pulse", CHANNELS), ("share", SHARED), ("angle", ANGLED)):
            piloted = getattr(self, f"piloted_{port}")
            values = [v if is_connected(v) else 0.0 for v in piloted]
            if direct is not None:
                values = [direct.get(a, v) for a, v in zip(axes, values, strict=True)]
            setattr(self, port, values)
        self.armed = self._source not in ("none", "thrusters")
        self.mode, self.manual = orders.mode, orders.manual
        self.target_kind, self.target_valid = orders.target_kind, orders.target_valid
        self.target_position, self.target_heading = orders.target_position, orders.target_heading
        self.target_speed, self.target_sway = orders.target_speed, orders.target_sway
        self.leg_reached = self._reached
        if self._commands is not None:
            self.refused, self.late = self._commands.refused, self._commands.late
        if self._faults is not None:
            self.failure = [self._faults.acting.get(unit, NONE) for unit in UNITS]
        assert self._joined is not None
        self.reached_at = f"ros2://{self._joined.domain}{self._names.namespace}"

    def update(self, t: float, k: int) -> None:
        """Write what is due; in lockstep wait for the answer."""
        joined = self._joined
        assert joined is not None
        now_ns = self._boot_ns + round(t * NS)
        here = Here(now_ns, self.frame_prefix, self._origin, self._field, self._instruments)
        if self.bag == "on" and self.run_folder and self._bag is None:
            self._bag = self._outlet.bag = Bag(Path(self.run_folder, self.name))
        if self._commands is None:
            self._outlet.open(self, here)
        commands = self._begun()
        joined.announce()
        if self._lockstep is not None:
            self._lockstep.meet(self._outlet.matches)
        self._outlet.write(self, here)
        if self._received != t:  # between two communication points
            self._receive(commands, t)
        heading: Any = self.heading if is_connected(self.heading) else self.true_attitude[2]
        commands.measured(heading, self.depth if is_connected(self.depth) else 0.0)
        if self._lockstep is not None:
            commands.take_newest(t, now_ns, but=self._lockstep.awaited)
            self._lockstep.wait(t, now_ns, self._outlet.write_again)
            self._follow(commands, t)
        self._mismatches.look(commands.read, self._outlet.written, self._outlet.latched)
        self._serve(now_ns)
        self._diagnose(now_ns)
        place = self.position_n if is_connected(*self.position_n) else self.true_position
        if self.leg and math.dist(place[:2], self.leg_to[:2]) <= (self.leg_radius or _LEG_RADIUS):
            self._reached = self.leg

    def hold(self, t: float) -> None:
        """Publish how long it stood still."""
        if self._simulator is not None:
            self.paused = self._simulator.paused_s

    def close(self) -> None:
        """Leave the domain, and finish the bag; a criterion that ends a run is told before."""
        if self._commands is not None and self.verdicts != self._diagnosed:
            self._diagnose(self._boot_ns + self.now_ns)
        if self._bag is not None:
            self._bag.close()
        if self._joined is not None:
            self._joined.close()
        self._joined = self._commands = self._bag = None

    # ------------------------------------------------------------------ inside

    def _begun(self) -> Commands:
        """Return the commands: their readers are made once it is known what the pilot drives."""
        if self._commands is None:
            assert self._joined is not None
            self._commands = Commands(self._joined, self, self._names, self._say)
            sensors = read_instruments(self.instruments)
            self._faults = Faults(sensors, self._commands.actuators)
            name, inject = self._names.full("inject_fault"), self._faults.inject
            self._fault_service = self._joined.service(name, faults.KIND, inject)
            if self.lockstep != "off":
                stamped = self.lockstep == "stamped"
                try:
                    topics = awaited(self.awaited, self._commands.watched, stamped=stamped)
                except InputError as error:
                    raise InputError(f"{self.name}.{error}") from None
                self._lockstep = Lockstep(
                    topics, stamped=stamped, name=self.name, limit=self.wait_limit
                )
        return self._commands

    def _serve(self, now_ns: int) -> None:
        """Answer calls; a simulation that is paused stands still here."""
        self._fault_service.serve()
        if self._simulator is not None:
            self._simulator.serve(now_ns)
            self._simulator.stand_still(now_ns, self._fault_service.serve)

    def _diagnose(self, now_ns: int) -> None:
        """Write the state of link, faults and criteria, once a second and as criteria change."""
        if now_ns < self._diagnosed_ns and self.verdicts == self._diagnosed:
            return
        self._diagnosed_ns, self._diagnosed = now_ns + NS, self.verdicts
        acting = {} if self._faults is None else self._faults.acting
        over = "" if self._joined is None else self._joined.title
        self._outlet.put(
            "diagnostics", diagnostics(self, self._names, now_ns, acting, over), now_ns
        )

    def _look(self) -> None:
        if self._commands is not None and self._lockstep is None and self._commands.arrived():
            self._stale = True

    def _receive(self, commands: Commands, t: float) -> None:
        if self._lockstep is None:
            commands.take_newest(t, self._boot_ns + round(t * NS))
            self._follow(commands, t)
            self._received = t

    def _follow(self, commands: Commands, t: float) -> None:
        before = self._source
        self._direct = commands.direct(t)
        if self._direct is not None:
            self._source, self._orders = "thrusters", Orders()
        else:
            self._source, self._orders = commands.orders(t)
        if self._source != before:
            self.order = f"{t!r} {self._source}"
            if self._source == "none":
                self._say(f"no command for {self.timeout:g} s at {t:g} s: neutral")

    def _say(self, what: str) -> None:
        _LOGGER.warning("%s: %s", self.name, what)
