"""An Arduino board as a component: a sketch's pins and serial ports on ports of a rig."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.endpoints.endpoint import Endpoint, report
from seatrial.links.endpoints.url import other_end
from seatrial.links.text import Inbox, Outbox
from seatrial.model.component import NS, Component

from .attached.peripherals import Peripherals
from .board import DUTY, EDGE, EEPROM, MESSAGE, MORE, RESET, UART, WIDTH, Board, Event, Inputs
from .build import build_host
from .eeprom import ERASED, read_eeprom, write_eeprom
from .emulator import build_emulator, build_firmware, firmware_file
from .mcus import CLOCK, Mcu
from .measuring import check_ports, field_at_home, measured, signals
from .part import Part, UartPart, part_failed
from .parts.shelf import part_class
from .ports import ArduinoPorts
from .pulses import Pulses
from .real_board import RealBoard
from .sources.boards import board_mcu
from .sources.platformio import project_of
from .sources.sketch import Sketch, find_sketch
from .wiring import STEPPERS, UARTS, open_links, read_uarts, read_wires

_WATCHED = ("servo", "pwm", "output", "step", "direction")
_SOFT = {"soft_rx": "r", "soft_tx": "t"}


class Arduino(ArduinoPorts):
    """An Arduino Mega or Uno with a sketch, in lockstep with the rest, by CPU cycles at 16 MHz.

    **Back ends.** ``host``: the unmodified sketch, compiled by the system's C++ compiler with an
    Arduino API in simulated time; int has 16 bits. ``simavr``: the firmware, compiled by
    avr-gcc with the Arduino core, or ``firmware`` as it is, on an emulated microcontroller.
    ``board``: a real board at serial ports, on the wall clock: nothing but its UARTs, and in runs
    in real time alone. Without a
    sketch or firmware the board is there and does nothing.

    **Wires**: what is connected where. ``PIN servo N`` gives pulse N, ``pwm`` duty, ``output`` and
    ``input`` levels, ``voltage`` an ADC channel (5 V full scale), ``receiver`` a channel of an RC
    receiver (pulses every 20 ms). ``PIN anemometer F``: a square wave of F Hz per m/s of
    ``wind_speed``. ``PIN vane V``: a potentiometer, V volts a full turn, that points to where the
    wind comes from, clockwise from the bow: V (wind_angle + pi) / 2 pi. ``ADDRESS mpu6050`` has
    ``gyro`` and ``accelerometer``, ``hmc5883l`` the ``magnetic_field`` in body axes by
    ``attitude`` (if 0, that of the World Magnetic Model at the home, at the start), ``ms5837``
    (30BA) the pressure at ``depth`` under one atmosphere, ``pixy`` what a camera detects, in pixels
    of 320 over ``view_width``. ``PIN step N`` counts the pulses to the driver of a stepper motor N,
    down while ``PIN direction N`` is low. ``PIN soft_rx N`` and ``PIN soft_tx N``:
    the line of UART N is at these pins, for SoftwareSerial.

    **Time.** Inputs apply from the beginning of the step on. What happens on pins and lines is
    stamped with its cycle; an output at t has what happened before t. Bytes that arrive on
    ``rx`` are put on the line one after the other at the baud rate of ``uarts``, not before
    their time and not before the step that has them; those that a UART sends are on ``tx`` when
    their stop bit is over. A monitor receives what its UART sends, and its input goes to the UART
    with the next step, besides what is on ``rx``. Bytes that come or go while a line is ``cut``
    are lost.

    **Supply.** Below ``supply_min`` the board is off: pins low, lines silent, what arrives lost.
    When it is enough again the sketch begins anew, with the EEPROM as it was.

    The sketch runs in a process of its own. If it crashes, overruns its stack, runs for
    ``patience`` without returning or calling anything, or opens a UART at another rate than
    its line has, the step raises SimulationError that says where. It cannot be rolled back.

    Raises InputError at the start for wires that cannot be, tools that are not installed, and a
    sketch that does not compile or uses what the back end has not.
    """

    feedthrough: ClassVar = {}
    discrete = True
    rolls_back = False
    transient = Component.transient | {
        *("_board", "_eeprom", "_monitors", "_parts", "_measured", "_pulses", "_wires", "_field_n"),
        *("_mcu", "_peripherals"),
    }

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._board: Board | RealBoard | None = None
        self._off = False
        self._peripherals: Peripherals | None = None
        self._monitors: dict[int, Endpoint] = {}
        self._parts: list[Part] = []

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Build what is to run, and connect the wires."""
        self.close()
        try:
            self._mcu = mcu = self._board_mcu()
            self._wires = read_wires(self.wires, mcu)
            there = {*range(mcu.uarts), *(w.number for w in self._wires if w.kind in _SOFT)}
            self._rates = {k: v for k, v in read_uarts(self.uarts).items() if k in there}
            self._eeprom = read_eeprom(self.eeprom, mcu)
            self._field_n = field_at_home(self)
            self._parts = self._made_parts()
            self._peripherals = self._made_peripherals()
            self._begin()
            self._monitors = open_links(self.monitors, "monitors")
        except InputError as error:
            self.close()
            raise InputError(f"{self.name}: {error}") from None
        self._rx: list[dict[str, Any]] = [{} for _ in range(UARTS)]
        self._tx: list[dict[str, Any]] = [{} for _ in range(UARTS)]
        self._sent = self._received = self._resets = 0
        self._steps = [0] * STEPPERS
        self._power_on()

    def step(self, t: float, h: float) -> None:
        """Let the board run from ``t`` to ``t + h``."""
        inputs = Inputs()
        if self._without_supply():
            self._put_bytes(Inputs())  # nobody reads them
            return
        if not self._last:
            self._connect(inputs)
        self._put_bytes(inputs)
        self._put_signals(inputs)
        if self._peripherals:
            self._peripherals.receive(inputs)
        end_ns = round((t + h) * NS) - self._begun_ns
        self._cycle = end_ns * (CLOCK // 1_000_000) // 1000
        if self._board is not None:
            self._take(self._board.run(self._cycle, inputs))
            self._send_packets()
        if self._peripherals:
            self._peripherals.flush()

    def outputs(self, t: float) -> None:
        """Publish pulses, levels and bytes."""
        self.tx = [Outbox(memory).text for memory in self._tx]
        self.can_tx = self._peripherals.can_tx if self._peripherals else ""
        self.reached_at = " ".join(other_end(each.url) for each in self._monitors.values())
        real = self._board if isinstance(self._board, RealBoard) else None
        report(self, [*self._monitors.values(), *(real.endpoints if real is not None else ())])
        self.on_wall_clock, self.connected = real is not None, real is None or real.connected
        self.resets, self.powered, self.steps = self._resets, not self._off, self._steps
        self.bytes_sent, self.bytes_received = self._sent, self._received
        widths, shares, levels = [0.0] * 12, [0.0] * 8, [False] * 8
        for wire in self._wires:
            if wire.kind == "servo":
                widths[wire.number - 1] = self._pulses[wire.place].width(self._cycle)
            elif wire.kind == "pwm":
                shares[wire.number - 1] = self._pulses[wire.place].share(self._cycle)
            elif wire.kind == "output":
                levels[wire.number - 1] = bool(self._pulses[wire.place].level)
        for part in self._parts:
            for output in part.pulses:
                widths[output - 1] = part.pulses[output]
        self.pulse, self.duty, self.output = widths, shares, levels

    def close(self) -> None:
        """End what runs."""
        if self._board is not None or self._off:
            self._end_board()
            self._off = False
            if self.eeprom_after:
                write_eeprom(self.eeprom_after, self._eeprom)
            for part in self._parts:
                part.end()
        if self._peripherals:
            self._peripherals.end()
            self._peripherals = None
        for monitor in self._monitors.values():
            monitor.close()
        self._monitors = {}

    # ------------------------------------------------------------------ inside

    def _found(self) -> Sketch:
        return find_sketch(self.sketch, self.libraries, self.flags, self.environment)

    def _board_mcu(self) -> Mcu:
        return board_mcu(self.sketch, self.environment, self.mcu)

    def _begin(self) -> None:
        mcu = self._mcu
        if self.backend == "board":
            self._board = RealBoard(
                self.name, self.links, self.safe_state, self.timeout, self._wires
            )
            return
        if not self.sketch and not self.firmware:
            return
        if self.backend == "host":
            if self.firmware:
                raise InputError("firmware needs the back end 'simavr'; 'host' runs a sketch")
            sketch = self._found()
            program = build_host(sketch, mcu)
            folder = self._peripherals.folder if self._peripherals else ""
            self._board = Board(self.name, program, str(self.patience), folder, answer=self._answer)
            return
        firmware = firmware_file(self.firmware) if self.firmware else self._built(mcu)
        pins = ",".join(mcu.ports)
        self._board = Board(
            self.name,
            build_emulator(mcu),
            str(self.patience),
            str(firmware),
            mcu.name,
            pins,
            source=firmware,
            answer=self._answer,
        )

    def _power_on(self) -> None:
        """Let cycles count from now on, with nothing on pins and wires yet."""
        self._begun_ns, self._cycle = self.now_ns, 0
        self._last: dict[tuple[str, int], float] = {}
        self._measured: list[dict[str, Any] | None] = [None] * len(self._parts)
        self._pulses = {w.place: Pulses() for w in self._wires if w.kind in _WATCHED}
        drivers = {w.number: w.place for w in self._wires if w.kind == "direction"}
        self._step_pins = {
            w.place: (w.number - 1, drivers.get(w.number)) for w in self._wires if w.kind == "step"
        }

    def _without_supply(self) -> bool:
        """Follow the supply of a simulated board; return whether it is off."""
        off = bool(self.supply < self.supply_min and self.backend != "board")
        if off and not self._off:
            self._end_board()
            self._restart_peripherals()
            self._power_on()
        elif self._off and not off:
            self._begin()
            self._parts = self._made_parts()
            self._power_on()
            self._resets += 1
        self._off = off
        return off

    def _end_board(self) -> None:
        if self._board is not None:
            self._board.close()
            self._board = None

    def _built(self, mcu: Mcu) -> Path:
        return build_firmware(self._found(), mcu)

    def _connect(self, inputs: Inputs) -> None:
        for address, byte in enumerate(self._eeprom):
            if byte != ERASED:
                inputs.put("E", 0, byte, address)
        for wire in self._wires:
            if wire.kind in _WATCHED:
                inputs.put("W", wire.place)
            elif wire.kind in _SOFT:
                inputs.put(_SOFT[wire.kind], wire.number, value=wire.place)
        for index, part in enumerate(self._parts):
            part.connect(index, inputs)
        for uart, rate in self._rates.items():  # at the pins where it is connected
            inputs.put("S", uart, rate)

    def _put_bytes(self, inputs: Inputs) -> None:
        for uart, text in enumerate(self.rx):
            for time_ns, data in Inbox(self._rx[uart]).take(text):
                if self.cut[uart]:
                    continue
                cycle = max(0, time_ns - self._begun_ns) * (CLOCK // 1_000_000) // 1000
                self._received += len(data)
                if part := self._radio(uart):
                    part.time = self._cycle / CLOCK
                    part.arrived(max(cycle, self._cycle) / CLOCK, data)
                    part.flush(inputs)
                    continue
                for byte in data:
                    inputs.put("U", uart, cycle, byte)
        for uart, monitor in self._monitors.items():
            for _, data in monitor.poll():
                for byte in data:
                    inputs.put("U", uart, self._cycle, byte)

    def _put_signals(self, inputs: Inputs) -> None:
        for wire in self._wires:
            for key, value in signals(self, wire, self._mcu):
                if self._last.get(key) != value:
                    self._last[key] = value
                    inputs.put(*key, value)
        self._last[("", 0)] = 0.0  # connected
        self._measure(inputs)

    def _measure(self, inputs: Inputs) -> None:
        """Let each part take in what has changed, and say what it sends."""
        for index, part in enumerate(self._parts):
            values = measured(self, part, self._field_n)
            if values != self._measured[index] or isinstance(part, UartPart):
                self._measured[index] = values
                try:
                    part.update(self._cycle / CLOCK, values, inputs)
                except InputError:
                    raise
                except Exception as error:
                    raise part_failed(self.name, part, error) from error

    def _made_peripherals(self) -> Peripherals | None:
        """Return what an ESP32 has besides; a project's folder ``data`` is in its flash."""
        if self._mcu.family != "esp32" or self.backend != "host":
            for key in ("flash", "flash_after", "network"):
                if found := getattr(self, key):
                    raise InputError(
                        f"{key}: {found!r} is for an ESP32 in the back end host; this board is "
                        f"the {self._mcu.board} in {self.backend}"
                    )
            return None
        file = project_of(Path(self.sketch).expanduser()) if self.sketch else None
        return Peripherals(self, file.parent / "data" if file else None, self._parts)

    def _restart_peripherals(self) -> None:
        if self._peripherals:
            self._peripherals.restart()

    def _made_parts(self) -> list[Part]:
        """Return the parts at the board's places."""
        near = Path(self.sketch or self.firmware or ".").expanduser()
        folder = near if near.is_dir() else near.parent
        parts = []
        for wire in self._wires:
            if wire.at:
                made = part_class(wire.kind, folder)((wire.place, *wire.more), wire.number or 1)
                check_ports(self, made, wire.kind)
                parts.append(made)
        # The board counts those at its buses and pins.
        return sorted(parts, key=lambda part: isinstance(part, UartPart))

    def _answer(
        self, call: int, index: int, value: int, cycle: int, sent: bytes
    ) -> tuple[int, Inputs]:
        part = self._parts[index]
        try:
            return part.answer(call, value, cycle, sent)
        except Exception as error:
            raise part_failed(self.name, part, error) from error

    def _radio(self, uart: int) -> Part | None:
        """Return the part whose packets are at the ports of a UART."""
        return next((part for part in self._parts if part.line and part.line == uart), None)

    def _send_packets(self) -> None:
        for part in self._parts:
            for time, data in part.packets:
                if not self.cut[part.line]:
                    box = Outbox(self._tx[part.line])
                    box.put(self._begun_ns + round(time * NS), data)
                    box.flush()
                    self._sent += len(data)
            part.packets.clear()

    def _received_by_parts(self, uart: int, data: bytes) -> None:
        for part in self._parts:
            if isinstance(part, UartPart) and part.places[0] == uart:
                part.time = self._cycle / CLOCK
                part.received(data)

    def _count_step(self, motor: int, direction: int | None) -> None:
        up = direction is None or self._pulses[direction].level
        self._steps[motor] += 1 if up else -1

    def _take(self, events: list[Event]) -> None:
        received: list[list[Event]] = [[] for _ in range(UARTS)]
        for event in events:
            kind, index, value, cycle = event
            if kind == EDGE:
                if value and index in self._step_pins and not self._pulses[index].level:
                    self._count_step(*self._step_pins[index])
                self._pulses[index].edge(value, cycle)
            elif kind == DUTY:
                self._pulses[index].modulated(value / 65535.0)
            elif kind == WIDTH:
                self._pulses[index].high_for(value / 1e6)
            elif kind == EEPROM:
                self._eeprom[value] = index
            elif kind == RESET:
                self._resets += 1
                self._restart_peripherals()
            elif kind in (MESSAGE, MORE) and self._peripherals:
                self._peripherals.take(event, self._begun_ns)
            elif kind == UART and not self.cut[index]:
                received[index].append(event)
        for uart, events_of_it in enumerate(received):
            if events_of_it:
                data = bytes(event[2] for event in events_of_it)
                box = Outbox(self._tx[uart])
                time_ns = self._begun_ns + events_of_it[0][3] * 1000 // (CLOCK // 1_000_000)
                box.put(time_ns, data)
                box.flush()
                self._sent += len(data)
                self._received_by_parts(uart, data)
                for channel in self._monitors[uart].channels() if uart in self._monitors else ():
                    channel.send(data)
