"""M5 thrusters on a VRCSR line, as a component."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.text import Inbox, Outbox
from seatrial.model.component import NS, Input, Output, Parameter, terminal

from .frame import VRCSR, Frame, encode
from .half_duplex import HalfDuplex, LineEnd
from .parser import Parser
from .stream_file import FROM_DEVICE, TO_DEVICE
from .vrcsr import Health, ThrusterNode

MOST = 6
"""Thrusters of one line."""
_AXES = tuple(f"t{number}" for number in range(1, MOST + 1))
_CELSIUS = 273.15
OVERTEMPERATURE = 8
"""Fault bit; the others have no public meaning."""


class M5Thrusters(LineEnd):
    """Up to six M5 thrusters: VRCSR in, shares of thrust, rpm, V, A and temperature out.

    ``nodes`` are their node ids; motor ids count from 0 in their order. ``rx`` and ``tx`` are bytes
    with their times (`seatrial.links.text`), timed as `Pro4Rov`'s are; what requests do is
    `ThrusterNode`'s. A power applies for ``watchdog``, 0 for ever (no document has one).

    Between requests, with P the power that applies (0 while ``fault`` is not 0):

        time_constant n' = P - n          n: share of full speed
        rpm = full_speed n,  current = full_current |n|^3
        voltage = supply_voltage - line_resistance (sum of all currents)
        thermal_time T' = water_temperature + thermal_resistance voltage current - T

    ``thrust`` is n |n|, the share of full thrust at rest. Above ``greatest_temperature`` bit 3 of
    the fault is set and the thruster stands still. The numbers are assumed: VideoRay publishes
    none; set those of your data sheet.
    """

    transient = LineEnd.transient | {"_nodes"}

    nodes = Parameter("1 2 3", "1", "node ids, separated by spaces")
    baud = Parameter(115_200.0, "1/s", "baud rate", min=300.0, max=1e7)
    byte_timeout = Parameter(0.05, "s", "gap after which a frame is given up", min=1e-4)
    watchdog = Parameter(1.0, "s", "time for which a power applies, 0 for ever", min=0.0)
    time_constant = Parameter(0.15, "s", "of the speed", min=1e-3)
    full_speed = Parameter(3000.0, "rpm", "speed at full power", min=0.0)
    full_current = Parameter(10.0, "A", "current at full power", min=0.0)
    supply_voltage = Parameter(48.0, "V", "voltage without current", min=0.0)
    line_resistance = Parameter(0.1, "ohm", "of the supply", min=0.0)
    thermal_time = Parameter(120.0, "s", "time constant of the temperature", min=1e-3)
    thermal_resistance = Parameter(0.05, "K/W", "of a thruster to the water", min=0.0)
    greatest_temperature = Parameter(358.15, "K", "temperature at which it stops", min=0.0)

    rx = Input("1", "bytes received", type=str, role="bytes", optional=True)
    fault = Input("1", "fault bits from outside", type=int, axes=_AXES, optional=True)
    water_temperature = Input("K", "temperature of the water", start=288.15, optional=True)

    tx = Output("1", "bytes sent", type=str, role="bytes")
    thrust = Output("1", "share of full thrust, -1 to 1", axes=_AXES)
    speed = Output("rpm", "speed of the shaft", axes=_AXES)
    voltage = Output("V", "voltage of the supply at the thrusters")
    current = Output("A", "current of each", axes=_AXES)
    temperature = Output("K", "of each", axes=_AXES, start=288.15)
    faults = Output("1", "fault bits of each", type=int, axes=_AXES)
    errors = Output("1", "wrong checksums and broken frames", type=int)

    terminals: ClassVar = {"serial": terminal(down="rx", up="tx")}

    def start(self, t: float) -> None:
        """Start at rest, as warm as the water."""
        super().start(t)
        count = len(self._nodes)
        self._speed = [0.0] * count
        self._warmth = [self.water_temperature] * count
        self._tripped = [0] * count
        self._received_ns = [-1] * count

    def step(self, t: float, h: float) -> None:
        """Receive and answer what is complete before ``t + h``, and turn until then."""
        self._log.open(self.run_folder, self.name)
        end = self.now_ns + round(h * NS)
        found = self._parser.expire(self.now_ns)
        for when, data in Inbox(self._rx).take(self.rx):
            self._log.write(when, TO_DEVICE, data)
            self._line.received(when, len(data))
            found += self._parser.feed(data, when, self._line.byte_ns)
        self._waiting += [
            [when, f.is_response, f.id, f.flags, f.address, f.payload.hex()] for when, f in found
        ]
        while self._waiting and self._waiting[0][0] < end:
            when, is_response, node, flags, address, payload = self._waiting.pop(0)
            self._receive(when, Frame(is_response, node, flags, address, bytes.fromhex(payload)))
        self._turn(h, end)
        Outbox(self._tx).flush()

    def outputs(self, t: float) -> None:
        """Publish bytes and motion."""
        self.tx = Outbox(self._tx).text
        idle = (0.0,) * (MOST - len(self._nodes))
        self.thrust = (*(n * abs(n) for n in self._speed), *idle)
        self.speed = (*(self.full_speed * n for n in self._speed), *idle)
        currents = self._currents()
        self.current = (*currents, *idle)
        self.voltage = self._voltage(currents)
        self.temperature = (*self._warmth, *(self.water_temperature for _ in idle))
        faults = [self._fault(number) for number in range(len(self._nodes))]
        self.faults = (*faults, *(0 for _ in idle))
        self.errors = self._parser.checksum_errors + self._parser.broken_off

    def _saved(self) -> dict[str, Any]:
        return {"nodes": [[node.memory.hex(), node.requested] for node in self._nodes]}

    def _restore(self, parts: Mapping[str, Any]) -> None:
        for node, (memory, requested) in zip(self._nodes, parts["nodes"], strict=True):
            node.memory[:], node.requested = bytes.fromhex(memory), requested

    # ------------------------------------------------------------------ inside

    def _build(self) -> None:
        try:
            ids = [int(text) for text in self.nodes.split()]
            if not 1 <= len(set(ids)) == len(ids) <= MOST:
                raise ValueError
            self._nodes = [ThrusterNode(node, motor) for motor, node in enumerate(ids)]
        except ValueError:
            raise InputError(
                f"{self.name}.nodes: 1 to {MOST} different numbers are needed, found {self.nodes!r}"
            ) from None
        except InputError as error:
            raise InputError(f"{self.name}.nodes: {error}") from None
        self._parser = Parser(round(self.byte_timeout * NS), (VRCSR,))
        self._line = HalfDuplex(self.baud, 0)

    def _receive(self, when: int, request: Frame) -> None:
        for number, node in enumerate(self._nodes):
            self._report(number, node)
            answer = node.handle(request)
            if node.requested:
                node.requested = False
                self._received_ns[number] = when
            if answer is not None:
                data = encode(answer, VRCSR)
                begin = self._line.transmit(when, len(data))
                self._log.write(begin, FROM_DEVICE, data)
                Outbox(self._tx).put(begin, data)

    def _report(self, number: int, node: ThrusterNode) -> None:
        currents = self._currents()
        warmth = self._warmth[number] - _CELSIUS
        rpm = self.full_speed * self._speed[number]
        volt, fault = self._voltage(currents), self._fault(number) & 0xFF
        node.report(Health(rpm, volt, currents[number], warmth, fault), self._speed[number])

    def _turn(self, h: float, end: int) -> None:
        currents = self._currents()
        voltage, limit = self._voltage(currents), round(self.watchdog * NS)
        kept, warm = math.exp(-h / self.time_constant), math.exp(-h / self.thermal_time)
        for number, node in enumerate(self._nodes):
            received = self._received_ns[number]
            alive = received >= 0 and (not limit or end - received < limit)
            goal = node.power if alive and not self._fault(number) else 0.0
            self._speed[number] = goal + (self._speed[number] - goal) * kept
            heat = self.thermal_resistance * voltage * currents[number]
            rest = self.water_temperature + heat
            self._warmth[number] = rest + (self._warmth[number] - rest) * warm
            if self._warmth[number] > self.greatest_temperature:
                self._tripped[number] = OVERTEMPERATURE

    def _currents(self) -> list[float]:
        return [self.full_current * abs(n) ** 3 for n in self._speed]

    def _voltage(self, currents: list[float]) -> float:
        drop: float = self.line_resistance * sum(currents)
        return float(max(self.supply_voltage - drop, 0.0))

    def _fault(self, number: int) -> int:
        return int(self.fault[number]) | self._tripped[number]
