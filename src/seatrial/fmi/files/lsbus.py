"""FMI-LS-BUS: bus terminals of other people's FMUs as ports of the simulated CAN bus.

Modelica Association, FMI Layered Standard Network Communication (Low-Cut): such a terminal has
data and clock of each direction. Here they are two texts, as our own nodes have them
(`seatrial.links.text`): each operation with the instant at which its clock was active.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...errors import InputError
from ...model.terminals import Terminal
from ..clocks import Clock, Clocks
from ..instance import Variable, Variables
from .modelfile import ModelFile
from .terminals import PLACE, TOOL, attribute
from .xmlfile import read_xml

KINDS = ("org.fmi-ls-bus.network-terminal", "org.fmi-standard.fmi-ls-bus.network-terminal")
"""The second stands in drafts."""
_MEMBERS = ("Rx_Data", "Rx_Clock", "Tx_Data", "Tx_Clock")
MANIFEST = "extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml"
CAN = "application/org.fmi-standard.fmi-ls-bus.can"
ANNOTATION = "port"
"""Of a terminal that our FMUs have for others: as a port of bytes with times it is there too."""


@dataclass(frozen=True)
class BusTerminal:
    """One terminal: what it has in the FMU, and the two ports that it is here."""

    name: str
    rx_data: Variable
    rx_clock: int
    tx_data: Variable
    tx_clock: int
    largest: int | None
    """Bytes that the FMU takes at once; None: any number."""
    receives: str
    """Port with operations for the FMU."""
    sends: str
    """Port with operations from it."""


def read_buses(
    folder: Path, model: ModelFile, variables: Variables, clocks: Clocks
) -> tuple[list[BusTerminal], list[str]]:
    """Return the CAN terminals of an FMU, and notes on those of other buses.

    ``folder`` is where the FMU lies unpacked. Raises InputError for a terminal of CAN that is
    none.
    """
    elements = [one for one in _elements(folder, model, clocks) if not _is_own(one)]
    if not elements:
        return [], []
    called = _called(model)
    binaries = {e.get("name"): dict(e.attrib) for e in model.variables() if e.tag == "Binary"}
    reading = _Reading(binaries, variables, clocks, _is_bus(folder, called))
    found: dict[str, BusTerminal] = {}
    notes = []
    for element in elements:
        name = attribute(element, "name")
        try:
            members = _members(element)
            mime = binaries.get(members["Rx_Data"], {}).get("mimeType", "").partition(";")[0]
            if mime.strip() != CAN:
                notes.append(
                    f"bus terminal {name!r} has {mime or 'no mimeType'}, only {CAN} is known: "
                    "its clocks and data are signals"
                )
                continue
            if name in found:
                raise InputError("two of this name")
            found[name] = reading.terminal(name, members)
        except InputError as error:
            line = element.sourceline
            raise InputError(
                f"{called}: {PLACE}: bus terminal {name!r} (line {line}): {error}"
            ) from None
    return list(found.values()), notes


def without_own(
    folder: Path, model: ModelFile, variables: Variables, clocks: Clocks
) -> tuple[Variables, Clocks]:
    """Return variables and clocks without those that an FMU of ours has for other importers.

    What they are for it has as a port of bytes too, each of which has its own time.
    """
    own = [one for one in _elements(folder, model, clocks) if _is_own(one)]
    beginnings = tuple(f"{one.get('name')}." for one in own)
    if not own:
        return variables, clocks
    left = Clocks(
        {r: c for r, c in clocks.by_reference.items() if not c.name.startswith(beginnings)},
        {name: one for name, one in clocks.signals.items() if not name.startswith(beginnings)},
        {name: some for name, some in clocks.clocked.items() if not name.startswith(beginnings)},
    )
    return Variables({n: v for n, v in variables.items() if not n.startswith(beginnings)}), left


def _elements(folder: Path, model: ModelFile, clocks: Clocks) -> list[Any]:
    if not clocks.by_reference or not (folder / PLACE).is_file():
        return []
    listed = read_xml(folder / PLACE, f"{_called(model)}: {PLACE}")
    return [one for one in listed.iter("Terminal") if one.get("terminalKind") in KINDS]


def _is_own(element: Any) -> bool:
    return element.find(f"Annotations/Annotation[@type='{TOOL}']/{ANNOTATION}") is not None


def _called(model: ModelFile) -> str:
    return model.called.removesuffix(": modelDescription.xml")


def _members(element: Any) -> dict[str, str]:
    members = {
        child.get("memberName", ""): attribute(child, "variableName")
        for child in element.iterfind("TerminalMemberVariable")
    }
    missing = [name for name in _MEMBERS if name not in members]
    if missing:
        raise InputError(f"has no {' and no '.join(missing)}; {', '.join(_MEMBERS)} are needed")
    return members


def _is_bus(folder: Path, called: str) -> bool:
    """Say if the FMU is a bus, to which nodes are connected, and no node of one."""
    if not (folder / MANIFEST).is_file():
        return False
    manifest = read_xml(folder / MANIFEST, f"{called}: {MANIFEST}")
    return manifest.get("isBusSimulationFMU") in ("true", "1")


@dataclass(frozen=True)
class _Reading:
    """What has to be known of the whole FMU to read one of its bus terminals."""

    binaries: Mapping[str, Mapping[str, str]]
    """Attributes of the binary variables by name."""
    variables: Variables
    clocks: Clocks
    is_bus: bool

    def terminal(self, name: str, members: Mapping[str, str]) -> BusTerminal:
        """Return a terminal. Raises InputError for members that do not fit."""
        rx_clock, tx_clock = (self._clock(members[m]) for m in ("Rx_Clock", "Tx_Clock"))
        if rx_clock.is_timed or rx_clock.causality != "input":
            raise InputError(f"Rx_Clock: a triggered input is needed, found {_described(rx_clock)}")
        if not tx_clock.is_timed and tx_clock.causality != "output":
            raise InputError(
                "Tx_Clock: a triggered output or a time-based input is needed, found "
                f"{_described(tx_clock)}"
            )
        largest = self.binaries[members["Rx_Data"]].get("maxSize")
        # As a node has them, a bus has them the other way round.
        receives, sends = ("tx", "rx") if self.is_bus else ("rx", "tx")
        for port in (receives, sends):
            if f"{port}.{name}" in self.variables:
                raise InputError(f"the FMU has a variable of the port's name, {port}.{name}")
        return BusTerminal(
            name,
            self._data(members, "Rx", "input", rx_clock),
            rx_clock.reference,
            self._data(members, "Tx", "output", tx_clock),
            tx_clock.reference,
            None if largest is None else int(largest),
            f"{receives}.{name}",
            f"{sends}.{name}",
        )

    def _clock(self, name: str) -> Clock:
        for clock in self.clocks.by_reference.values():
            if clock.name == name:
                return clock
        raise InputError(f"{name} is no clock")

    def _data(self, members: Mapping[str, str], way: str, causality: str, clock: Clock) -> Variable:
        written = members[f"{way}_Data"]
        found = self.variables.get(written) or self.variables.get(f"{written}[1]")
        if (
            found is None
            or found.type is not bytes
            or found.causality != causality
            or f"{written}[2]" in self.variables
            or clock.reference not in self.clocks.clocked.get(found.name, ())
        ):
            raise InputError(
                f"{way}_Data: one Binary {causality} of the clock {clock.name} is needed, "
                f"found {written}"
            )
        return found


def _described(clock: Clock) -> str:
    return f"the {clock.kind} {clock.causality} {clock.name}"


def with_ports(
    buses: Sequence[BusTerminal], variables: Variables, clocks: Clocks
) -> tuple[Variables, Clocks]:
    """Return variables and clocks with ports in the place of what bus terminals have."""
    references = {reference for bus in buses for reference in (bus.rx_clock, bus.tx_clock)}
    gone = {name for name, reference in clocks.signals.items() if reference in references}
    gone |= {data.name for bus in buses for data in (bus.rx_data, bus.tx_data)}
    left = Variables({name: v for name, v in variables.items() if name not in gone})
    for bus in buses:
        left[bus.receives] = _port(bus.receives, "input", f"operations to {bus.name}")
        left[bus.sends] = _port(bus.sends, "output", f"operations from {bus.name}")
    return left, replace(
        clocks,
        signals={name: one for name, one in clocks.signals.items() if name not in gone},
        clocked={name: some for name, some in clocks.clocked.items() if name not in gone},
    )


def _port(name: str, causality: str, description: str) -> Variable:
    return Variable(
        name, causality, "discrete", str, -1, "", "" if causality == "input" else None,
        None, None, None, description, optional=True,
    )  # fmt: skip


def port_terminals(buses: Sequence[BusTerminal]) -> dict[str, Terminal]:
    """Return the terminals as rigs have them: with the members of a node, or of a bus."""
    return {
        bus.name: Terminal({port.partition(".")[0]: port for port in (bus.receives, bus.sends)})
        for bus in buses
    }
