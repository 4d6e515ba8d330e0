"""CAN terminals of components as FMI-LS-BUS 1.0 has them for CAN, in FMUs of FMI 3.0.

A terminal with one text of role ``can`` in and one out is a bus terminal: ``tx`` is the output of
a node, and the input of a bus. The FMU has it once more, ``can_NAME``, with data and triggered
clocks of each direction, for importers with buses; `events.c` says how they pass.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement

from ...errors import InputError
from ...model.component import Component
from ...model.ports import ScalarPort
from ..description import variability
from ..files.lsbus import ANNOTATION, CAN, KINDS, MANIFEST
from ..files.terminals import TOOL, xml_text

_FIRST = 0xFFF << 20
_MEMBERS = 8
"""Of value references: see ``front.h``."""
_RULE = "org.fmi-ls-bus.transceiver"
_MIME = f'{CAN}; version="1.0.0"'
_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
_VERSION = "1.0.0"
_DESCRIPTION = (
    "Layered Standard for the simulation of bus communication on a Physical Signal Abstraction "
    "or Network Abstraction based level."
)
_HELD = {float: "REALS", int: "INTEGERS", bool: "BOOLEANS", str: "STRINGS"}
_RATES = (
    ("bit_rate", "250000.0", "bit/s that the node says of itself at the start; 0: nothing"),
    ("data_bit_rate", "0.0", "bit/s of its data phase of CAN FD, said at the start; 0: nothing"),
)
"""Parameters of nodes by name, start and description."""


@dataclass(frozen=True)
class CanTerminal:
    """A terminal of a component through which it is on a CAN bus."""

    own: str
    """The component's name of it."""
    receives: ScalarPort
    sends: ScalarPort
    is_bus: bool

    @property
    def name(self) -> str:
        """What the terminal of FMI-LS-BUS is called, and what its variables' names begin with."""
        return f"can_{self.own}"


def can_terminals(component: Component) -> list[CanTerminal]:
    """Return the CAN terminals of a component.

    Raises InputError for one whose name in FMI-LS-BUS another terminal or a port has.
    """
    scalars = {scalar.name: scalar for scalar in component.scalars}
    found = []
    for name, terminal in component.terminals.items():
        members = {m: scalars[t] for m, t in terminal.members.items() if t in scalars}
        ends = {m: s for m, s in members.items() if s.port.role == "can"}
        kinds = {scalar.port.kind: scalar for scalar in ends.values()}
        if ends.keys() != {"tx", "rx"} or kinds.keys() != {"input", "output"}:
            continue
        one = CanTerminal(name, kinds["input"], kinds["output"], ends["tx"].port.kind == "input")
        if one.name in component.terminals or one.name in component.ports:
            raise InputError(
                f"{type(component).__name__}: the CAN terminal {name!r} is {one.name!r} in FMI "
                "3.0, and there is another of this name"
            )
        found.append(one)
    return found


def events_header(component: Component | None) -> str:
    """Return ``events.h``: the buses of a component, and its outputs that are not continuous.

    A component without buses has no event mode.
    """
    buses = can_terminals(component) if component is not None else []
    lines = [
        "/* Texts that a component has of buses; and outputs that wait for events. */",
        f"#define BUSES {len(buses)}",
        f"#define BUS_SCALARS {_pairs(buses)}",
        f"#define ARE_BUSES {int(any(bus.is_bus for bus in buses))}",
    ]
    held: dict[type, list[int]] = {kind: [] for kind in _HELD}
    if component is not None and buses:
        for scalar in component.scalars:
            changes = variability(component, scalar).value
            if scalar.port.kind == "output" and changes != "continuous":
                held[scalar.port.type].append(scalar.reference)
    for kind, name in _HELD.items():
        listed = ", ".join(map(str, (*held[kind], 0)))
        lines += [
            f"#define HELD_{name} {len(held[kind])}",
            f"#define HELD_{name}_SCALARS {{{listed}}}",
        ]
    return "\n".join([*lines, ""])


def _pairs(buses: Sequence[CanTerminal]) -> str:
    pairs = [f"{{{bus.receives.reference}, {bus.sends.reference}}}" for bus in buses]
    return "{" + ", ".join((*pairs, "{0, 0}")) + "}"


# ---------------------------------------------------------------------- what describes them


def _names(bus: CanTerminal) -> dict[str, str]:
    """Return the variables of a terminal by the names of members."""
    return {
        member: f"{bus.name}.{member}" for member in ("Rx_Data", "Rx_Clock", "Tx_Data", "Tx_Clock")
    }


def _notifies(bus: CanTerminal) -> str:
    return f"{bus.name}.Configuration.BusNotifications"


def bus_variables(buses: Sequence[CanTerminal]) -> Iterator[Element]:
    """Yield the variables of bus terminals."""
    for number, bus in enumerate(buses):
        first, names = _FIRST + number * _MEMBERS, _names(bus)
        for way, causality, place in (("Rx", "input", 0), ("Tx", "output", 2)):
            said = {"causality": causality, "variability": "discrete"}
            data = {"name": names[f"{way}_Data"], "valueReference": str(first + place), **said}
            text = "operations to it" if way == "Rx" else "operations from it"
            data |= {"description": f"{bus.own}: {text}", "clocks": str(first + place + 1)}
            variable = Element("Binary", {**data, "mimeType": _MIME})
            if way == "Rx":
                SubElement(variable, "Start", {"value": ""})
            yield variable
            clock = {"name": names[f"{way}_Clock"], "valueReference": str(first + place + 1)}
            yield Element("Clock", {**clock, **said, "intervalVariability": "triggered"})
        if bus.is_bus:
            said = {"name": _notifies(bus), "valueReference": str(first + 4)}
            said |= {"description": "whether nodes are notified of what happens to their frames"}
            said |= {"causality": "output", "variability": "constant", "start": "true"}
            yield Element("Boolean", said)
            continue
        for place, (name, start, text) in enumerate(_RATES, start=5):
            said = {"name": f"{bus.name}.{name}", "valueReference": str(first + place)}
            said |= {"description": text, "causality": "parameter", "variability": "fixed"}
            yield Element("Float64", {**said, "min": "0", "start": start})


def add_bus_outputs(structure: Element, buses: Sequence[CanTerminal]) -> None:
    """Add the outputs of bus terminals: none depends on an input at once.

    Clocks are among the unknowns of the initialisation.
    """
    outputs, unknowns = len(structure.findall("Output")), len(structure)
    for number, bus in enumerate(buses):
        first = _FIRST + number * _MEMBERS
        for reference in (first + 2, first + 3, *([first + 4] if bus.is_bus else ())):
            said = {"valueReference": str(reference), "dependencies": ""}
            structure.insert(outputs, Element("Output", said))
            outputs, unknowns = outputs + 1, unknowns + 1
        said = {"valueReference": str(first + 3), "dependencies": ""}
        structure.insert(unknowns, Element("InitialUnknown", said))
        unknowns += 1


def add_bus_terminals(terminals: Element, buses: Sequence[CanTerminal]) -> None:
    """Add the terminals of buses to those of a file; our importer takes the component's own."""
    for bus in buses:
        element = SubElement(
            terminals,
            "Terminal",
            {"name": bus.name, "matchingRule": _RULE, "terminalKind": KINDS[0]},
        )
        _add_members(element, _names(bus))
        if bus.is_bus:
            inner = {"name": "Configuration", "matchingRule": "bus"}
            inner["terminalKind"] = f"{KINDS[0]}.configuration"
            _add_members(
                SubElement(element, "Terminal", inner), {"BusNotifications": _notifies(bus)}
            )
        note = SubElement(SubElement(element, "Annotations"), "Annotation", {"type": TOOL})
        SubElement(note, ANNOTATION, {"terminal": bus.own})


def _add_members(terminal: Element, variables: dict[str, str]) -> None:
    for member, variable in variables.items():
        said = {"variableName": variable, "memberName": member, "variableKind": "signal"}
        SubElement(terminal, "TerminalMemberVariable", said)


def manifest(buses: Sequence[CanTerminal]) -> dict[str, bytes]:
    """Return FMI-LS-BUS's manifest by its path in the FMU, nothing without buses."""
    if not buses:
        return {}
    root = Element(
        "fmiLayeredStandardManifest",
        {
            "xmlns:fmi-ls": _NAMESPACE,
            "fmi-ls:fmi-ls-name": "org.fmi-standard.fmi-ls-bus",
            "fmi-ls:fmi-ls-version": _VERSION,
            "fmi-ls:fmi-ls-description": _DESCRIPTION,
            "isBusSimulationFMU": str(buses[0].is_bus).lower(),
        },
    )
    return {MANIFEST: xml_text(root)}
