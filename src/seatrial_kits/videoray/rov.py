"""A VideoRay Pro 4 at its serial line, as a component."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from seatrial.errors import InputError
from seatrial.links.text import Inbox, Outbox
from seatrial.model.component import NS

from .auto_loop import AutoLoop
from .drive import Drive, share_of_thrust
from .frame import Frame, encode
from .half_duplex import HalfDuplex, LineEnd
from .identity import make_identity
from .node import RovNode
from .parser import Parser
from .power_manager import manage
from .registers import BY_NAME, GAINS, OFF, factory_memory, put, read_settings
from .rov_ports import Pro4RovPorts
from .stream_file import FROM_DEVICE, TO_DEVICE

_MBAR = 100.0
_CELSIUS = 273.15


class Pro4Rov(Pro4RovPorts):
    """The vehicle's end of the Pro 4 protocol: what it receives, does, measures and answers.

    ``rx`` and ``tx`` are bytes with their times (`seatrial.links.text`); `SerialGateway` joins
    them to a pseudo-terminal, a TCP port or a serial port. What requests do is `RovNode`'s.

    **Time.** In the step from t to t + h it receives what ``rx`` has, each byte at its time at
    ``baud``, 10 bits each, and answers what is complete before t + h: the first byte of an answer
    begins ``turnaround`` after the last that it received (`HalfDuplex`), and is on ``tx`` with that
    time at t + h. A cycle of 23 and 42 bytes takes 5.64 ms.

    **Control** runs every ``loop_period`` from the start on, with what the inputs are then:
    auto depth and auto heading (`AutoLoop`), power (`manage`), slew, limits and dead band
    (`Drive`). The auto loops' outputs are added to the targets: heading's to port and taken off
    starboard. ``command`` is what is left when ``motor_dead_band`` is taken off the ``duty``,
    as a share of full thrust, the vertical one positive downwards, whatever ``vertical_ahead``
    is on the line. The captured gains need ``up``.

    **Measurements**: heading, pitch, roll in 0.1 degrees; pressure in mbar,
    surface_pressure + density gravity (depth + depth_offset); specific force, forward, to
    starboard and down, in mm/s2; body rates in mrad/s in the yaw, pitch, roll acceleration
    fields, whose unit no document has (what a public driver takes them for); water temperature
    in 0.01 degrees C, humidity in percent.

    **Watchdog**: when nothing was written to the command block for ``watchdog``, the thrusters
    stop at once and the auto loops rest, until something is. Lights and camera stay.

    **Reboot**: after the answer it is off for ``reboot_time``, then starts with what is stored.

    ``cut`` cuts the line: nothing is received or sent. ``communication_errors`` counts wrong
    checksums and frames that were broken off, as its register does since the last reboot. It
    records its stream in ``run_folder``, ``NAME.stream`` (`StreamLog`).

    Not modelled: collisions, the bootloader's announcement, VideoRay's enumeration, limits on
    changes of thrust (registers 0x52 to 0x57), registers that move servos themselves.

    Raises InputError at the start for an identity, version or register that cannot be.
    """

    transient = LineEnd.transient | {"_node", "_loops", "_drive"}

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Start as after a reboot, with nothing received."""
        super().start(t)
        self._began_ns = self._next_ns = self.now_ns
        self._driven = False
        self._received_ns = 0
        self._changes, self._published = 0, -1
        self._down_until_ns = -1
        self._errors_before = self._counted = 0
        self._run_before = 0.0
        self._power = 1.0
        self._duties = [0.0, 0.0, 0.0]
        self._text = ""
        self._accessory: dict[str, Any] = {}
        self._measure()

    def step(self, t: float, h: float) -> None:
        """Receive, control and answer, in the order of time, until ``t + h``."""
        self._log.open(self.run_folder, self.name)
        end, before = self.now_ns + round(h * NS), self._changes
        self._receive()
        while True:
            frame_ns = self._waiting[0][0] if self._waiting else end
            if min(frame_ns, self._next_ns) >= end:
                break
            self._changes += 1
            self._measure()
            if self._next_ns <= frame_ns:
                self._control(self._next_ns)
                self._next_ns += self._period_ns
            else:
                when, is_response, node, flags, address, payload = self._waiting.pop(0)
                request = Frame(is_response, node, flags, address, bytes.fromhex(payload))
                self._carry_out(when, request)
        if self._driven and not self._commanded(end):
            self._stop()
        if self._changes != before:
            Outbox(self._tx).flush()
            Outbox(self._accessory).flush()

    def outputs(self, t: float) -> None:
        """Publish bytes, commands, lights and camera, if anything has happened."""
        if self._published == self._changes:
            return
        self._published = self._changes
        node = self._node
        self.tx, self.accessory_tx = Outbox(self._tx).text, Outbox(self._accessory).text
        self.duty = self._duties
        bands, down = self.motor_dead_band, -1.0 if self.vertical_ahead == "up" else 1.0
        shares = [share_of_thrust(d, band) for d, band in zip(self._duties, bands, strict=True)]
        self.command = (shares[0], shares[1], down * shares[2] + 0.0)
        self.lights = min(node.value("lights"), 1.0)
        self.camera_tilt = math.radians(min(max(node.value("camera_tilt"), -90.0), 90.0))
        self.camera_focus = min(max(node.value("camera_focus"), -1.0), 1.0)
        self.camera_select = bool(int(node.value("camera_control")) & 2)
        self.camera_buttons = int(node.value("camera_buttons"))
        self.manipulator = node.manipulator
        self.commanded = self._driven
        self.auto_depth = self._driven and node.value("auto_depth_target") != OFF
        self.auto_heading = self._driven and node.value("auto_heading_target") != OFF
        self.node_id, self.requests = node.node_id, node.requests
        self.communication_errors = self._errors

    def _saved(self) -> dict[str, Any]:
        loops = [loop.saved() for loop in self._loops]
        return {"node": self._node.saved(), "loops": loops, "commands": list(self._drive.commands)}

    def _restore(self, parts: Mapping[str, Any]) -> None:
        self._node.restore(parts["node"])
        for loop, saved in zip(self._loops, parts["loops"], strict=True):
            loop.restore(saved)
        self._drive.commands = list(parts["commands"])

    # ------------------------------------------------------------------ inside

    @property
    def _errors(self) -> int:
        return self._parser.checksum_errors + self._parser.broken_off

    def _build(self) -> None:
        try:
            identity = make_identity(self.serial_number, self.boards, self.firmware)
            memory = factory_memory()
            for name, raw in {**GAINS[self.gains], **read_settings(self.registers)}.items():
                put(memory, name, raw)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        place = BY_NAME["version_copy"].address
        memory[place : place + 3] = bytes(identity.firmware)
        self._node = RovNode(identity, memory, commits=self.storing == "commit")
        self._parser = Parser(round(self.byte_timeout * NS))
        self._line = HalfDuplex(self.baud, round(self.turnaround * NS))
        self._loops = [
            AutoLoop("auto_depth", "pressure"),
            AutoLoop("auto_heading", "heading", 360.0),
        ]
        self._drive = Drive(self.loop_period, self.slew_unit, self.compensation == "on")
        self._period_ns = max(1, round(self.loop_period * NS))

    def _receive(self) -> None:
        found = self._parser.expire(self.now_ns)
        text = self.rx
        chunks = Inbox(self._rx).take(text) if text != self._text else []
        self._text = text
        for when, data in chunks:
            if self.cut:
                continue
            self._log.write(when, TO_DEVICE, data)
            self._line.received(when, len(data))
            found += self._parser.feed(data, when, self._line.byte_ns)
        self._waiting += [
            [when, f.is_response, f.id, f.flags, f.address, f.payload.hex()] for when, f in found
        ]
        errors = self._errors - self._errors_before
        if found or errors != self._counted:
            self._changes += 1
            self._counted = errors
            self._node.count_errors(errors)

    def _carry_out(self, when: int, request: Frame) -> None:
        if when < self._down_until_ns:
            return
        node = self._node
        answer = node.handle(request)
        if node.was_commanded:
            node.was_commanded = False
            self._received_ns, self._driven = when, True
        for relayed in node.relayed:
            Outbox(self._accessory).put(when, encode(relayed))
        node.relayed.clear()
        if answer is not None and not self.cut:
            data = encode(answer)
            begin = self._line.transmit(when, len(data))
            self._log.write(begin, FROM_DEVICE, data)
            Outbox(self._tx).put(begin, data)
        if node.wants_reboot:
            self._reboot(when)

    def _reboot(self, when: int) -> None:
        self._run_before = self._node.value("run_time")
        self._node.reboot()
        self._errors_before = self._errors
        self._down_until_ns = max(when, self._line.free_ns) + round(self.reboot_time * NS)
        self._began_ns = self._down_until_ns
        self._stop()

    def _commanded(self, now_ns: int) -> bool:
        limit = round(self.watchdog * NS)
        return not limit or now_ns - self._received_ns < limit

    def _control(self, now_ns: int) -> None:
        node = self._node
        self._power = manage(node, self._power, self.tether_voltage, self.tether_current)
        if not self._driven:
            return
        if not self._commanded(now_ns):
            self._stop()
            return
        vertical, turn = (loop.run(node) for loop in self._loops)
        self._duties = self._drive.run(node, (turn, -turn, vertical))

    def _stop(self) -> None:
        self._driven = False
        self._changes += 1
        for loop in self._loops:
            loop.rest(self._node)
        self._duties = self._drive.stop()

    def _measure(self) -> None:
        node = self._node
        phi, theta, psi = (math.degrees(angle) for angle in self.attitude)
        heading = round(psi * 10.0) % 3600
        if self.heading_range == "half" and heading >= 1800:
            heading -= 3600
        node.measure("heading", heading / 10.0)
        node.measure("pitch", theta)
        node.measure("roll", phi)
        water = self.density * self.gravity * (self.depth + self.depth_offset)
        pressure = (self.surface_pressure + water) / _MBAR
        node.measure("pressure", pressure)
        for part, force in zip(("surge", "sway", "heave"), self.specific_force, strict=True):
            node.measure(f"{part}_acceleration", force)
        for part, rate in zip(("roll", "pitch", "yaw"), self.rates, strict=True):
            node.measure(f"{part}_acceleration", rate * 1000.0)
        for axis, raw in zip("xyz", self.magnetometer, strict=True):
            node.measure(f"magnetometer_{axis}", raw)
        node.measure("water_temperature", self.water_temperature - _CELSIUS)
        node.measure("humidity", self.humidity)
        for name in ("tether_voltage", "bus_voltage", "bus_current"):
            node.measure(name, getattr(self, name))
        running = max(self.now_ns - self._began_ns, 0) / NS
        node.measure("run_time", self._run_before + running)
        node.measure("max_depth", max(node.value("max_depth"), pressure))
        node.measure("max_humidity", max(node.value("max_humidity"), self.humidity))
