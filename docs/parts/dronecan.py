"""DroneCAN: messages, parameters over the bus and ports of the components."""

from __future__ import annotations

from functools import partial
from typing import Any

from parts import part
from parts.can import ports
from parts.markdown import table
from seatrial_kits.can.dronecan.autopilot import DroneCanAutopilot
from seatrial_kits.can.dronecan.instruments import MagneticField
from seatrial_kits.can.dronecan.navigation import NOT_CONNECTED
from seatrial_kits.can.dronecan.node import Allocation, GetNodeInfo, NodeStatus, RestartNode
from seatrial_kits.can.dronecan.parameters import ExecuteOpcode, GetSet
from seatrial_kits.can.dronecan.peripheral import DroneCanPeripheral


@part("dronecan-peripheral-ports")
def peripheral_ports() -> str:
    """Ports of the peripheral."""
    return ports(DroneCanPeripheral).replace(f"{NOT_CONNECTED:g}", "not connected")


part("dronecan-autopilot-ports")(partial(ports, DroneCanAutopilot))

_ALL = {
    Allocation: "while it has no node ID",
    NodeStatus: "says",
    **dict.fromkeys((GetNodeInfo, RestartNode, ExecuteOpcode, GetSet), "answers"),
}


@part("dronecan-messages")
def messages() -> str:
    """Messages and services, and which node says them."""

    def role(kind: Any, own: Any) -> str:
        if kind in _ALL:
            both = kind is NodeStatus and kind in own.messages
            return f"{_ALL[kind]}, takes in" if both else _ALL[kind]
        if kind is MagneticField and own is DroneCanPeripheral:  # its successor goes out
            return ""
        return "takes in" if kind in own.messages else "says"

    kinds = {*DroneCanPeripheral.messages, *DroneCanAutopilot.messages, *_ALL}
    return table(
        ("number", "message or service", "`dronecan-peripheral`", "`dronecan-autopilot`"),
        [
            (
                str(kind.default_dtid),
                f"`{kind.full_name}`",
                role(kind, DroneCanPeripheral),
                role(kind, DroneCanAutopilot),
            )
            for kind in sorted(kinds, key=lambda kind: (kind.kind, kind.default_dtid))
        ],
    )


@part("dronecan-parameters")
def parameters() -> str:
    """Parameters that others read and set over the bus."""
    rows = []
    for cls, name in (
        (DroneCanPeripheral, "`dronecan-peripheral`"),
        (DroneCanAutopilot, "`dronecan-autopilot`"),
    ):
        node = cls("node")
        node.initialise()
        for setting in node.visible:
            limits = (
                "" if isinstance(setting.default, str) else f"{setting.low:g} to {setting.high:g}"
            )
            kind = setting.field.removesuffix("_value")
            rows.append((f"`{setting.name}`", name, kind, limits))
    return table(("parameter", "of", "type", "allowed"), rows)
