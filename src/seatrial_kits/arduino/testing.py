"""An Arduino board in a simulation: its UARTs and its pins."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatrial.errors import InputError
from seatrial.testing.line import Line

from .mcus import MCUS
from .wiring import Wire, read_wires

if TYPE_CHECKING:
    from seatrial.api.simulation import Simulation

_READ = {"pulse": ("servo", "pulse.s"), "duty": ("pwm", "duty.p"), "level": ("output", "output.o")}
_SET = {
    "pulse": ("receiver", "receiver.c"),
    "level": ("input", "level.i"),
    "voltage": ("voltage", "voltage.v"),
}


class Board:
    """A board: ``board.send("H60\\n")``, ``board.expect("OK")``, ``board.pin(9).pulse``."""

    def __init__(self, bench: Simulation, name: str) -> None:
        self.simulation, self.name = bench, name
        self.uart = cache(self._uart)

    def send(self, data: bytes | str, uart: int = 0) -> None:
        """Send to a UART, now."""
        self.uart(uart).send(data)

    def expect(self, wanted: bytes | str, within: float | str = "1 s", uart: int = 0) -> bytes:
        """Step until a UART says something; see `Line.expect`."""
        __tracebackhide__ = True
        return self.uart(uart).expect(wanted, within)

    def pin(self, place: int | str) -> Pin:
        """Return a pin by its number or name (9, "A0"). Raises InputError if nothing is at it."""
        mcu = MCUS[str(self.simulation.get(f"{self.name}.mcu"))]
        wires = read_wires(str(self.simulation.get(f"{self.name}.wires")), mcu)
        at = mcu.pin(str(place))
        here = [wire for wire in wires if wire.place == at and wire.number]
        if not here:
            pins = ", ".join(f"{wire.place} {wire.kind}" for wire in wires if wire.number)
            raise InputError(f"{self.name}: nothing is connected to pin {place} (pins: {pins})")
        return Pin(self, here[0])

    def _uart(self, number: int) -> Line:
        return Line(self.simulation, f"{self.name}.rx.uart{number}", f"{self.name}.tx.uart{number}")


class Pin:
    """A pin of a board; SI units.

    Of the sketch: ``pulse``, s, of a servo; ``duty`` of a PWM output; ``level`` of an output. To
    the sketch: ``pulse`` of a receiver's channel, ``level`` of an input, ``voltage``, V.
    """

    def __init__(self, board: Board, wire: Wire) -> None:
        # Past __setattr__, which is for values of the pin.
        self.__dict__.update(_board=board, _wire=wire)

    def __getattr__(self, name: str) -> Any:
        kind, port = _READ.get(name, ("", ""))
        if kind != self._wire.kind:
            self._refuse(name, _READ)
        return self._board.simulation.get(f"{self._board.name}.{port}{self._wire.number}")

    def __setattr__(self, name: str, value: Any) -> None:
        kind, port = _SET.get(name, ("", ""))
        if kind != self._wire.kind:
            self._refuse(name, _SET)
        self._board.simulation.set(f"{self._board.name}.{port}{self._wire.number}", value)

    def _refuse(self, name: str, allowed: dict[str, tuple[str, str]]) -> None:
        wire = self._wire
        known = [each for each, (kind, _) in allowed.items() if kind == wire.kind]
        raise AttributeError(
            f"a pin connected as {wire.kind!r} has no {name!r} here (it has: {', '.join(known)})"
        )


def sketch_rig(path: Path, folder: Path, settings: dict[str, Any]) -> Path:
    """Write a rig of one board that runs a sketch, with parameters of `arduino`; return it."""
    given = {"sketch": str(path.resolve()), **settings}
    step = given.pop("step", "10 ms")
    values = ", ".join(f"{key} = {json.dumps(value)}" for key, value in given.items())
    rig = folder / f"{path.stem}-board.toml"
    rig.write_text(
        f'step = "{step}"\n\n[components]\nboard = {{ fmu = "arduino", set = {{ {values} }} }}\n',
        encoding="utf-8",
    )
    return rig
