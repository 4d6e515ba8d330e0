"""CAN: ports of the components."""

from __future__ import annotations

from functools import partial

from parts import part
from parts.markdown import shown_unit, table
from seatrial.model.component import Component
from seatrial.model.ports import Parameter, Port
from seatrial_kits.can.component import CanBus
from seatrial_kits.can.component_gateway import CanGateway
from seatrial_kits.can.traffic import CanTraffic

_HIDDEN = ("seed", "run-folder")
"""Roles: the master gives these."""


def _start(port: Port) -> str:
    if port.kind == "output":
        return ""
    start = port.start[0]
    return f"`{start}`" if isinstance(start, str) and start else f"{start:g}" if start != "" else ""


def _name(port: Port) -> str:
    if port.axes is None:
        return f"`{port.name}`"
    return f"`{port.name}.{port.axes[0]}` to `{port.axes[-1]}`"


def _kind(port: Port) -> str:
    return "tunable parameter" if isinstance(port, Parameter) and port.tunable else port.kind


def ports(component: type[Component]) -> str:
    """Ports of a component: what they are, unit and start value."""
    return table(
        ("port", "kind", "unit", "start", "meaning"),
        [
            (_name(port), _kind(port), shown_unit(port.unit), _start(port), port.description)
            for port in component.ports.values()
            if port.role not in _HIDDEN
        ],
    )


part("canbus-ports")(partial(ports, CanBus))
part("can-gateway-ports")(partial(ports, CanGateway))
part("can-traffic-ports")(partial(ports, CanTraffic))
