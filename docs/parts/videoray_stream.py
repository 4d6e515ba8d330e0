"""The VideoRay's serial protocol: its memory map, ports of the components."""

from __future__ import annotations

from functools import partial

from parts import part
from parts.can import ports
from parts.markdown import table
from seatrial.links.serial_gateway import SerialGateway
from seatrial_kits.videoray.m5_thrusters import M5Thrusters
from seatrial_kits.videoray.player import StreamPlayer
from seatrial_kits.videoray.registers import BY_NAME, GAINS, REGISTERS
from seatrial_kits.videoray.rov import Pro4Rov
from seatrial_kits.videoray.topside import Pro4Topside


@part("videoray-registers")
def registers() -> str:
    """Every register of the map."""
    return table(
        ("address", "register", "type", "one is", "written", "stored", "first", "meaning"),
        [
            (
                f"{r.address:02X}",
                f"`{r.name}`",
                f"{'i' if r.signed else 'u'}{8 * r.size}",
                f"{r.scale:g}{'' if r.unit == '1' else f' {r.unit}'}",
                "yes" if r.writable else "",
                "yes" if r.stored else "",
                str(r.default) if r.default else "",
                r.description,
            )
            for r in REGISTERS
        ],
    )


@part("videoray-gains")
def gains() -> str:
    """The named sets."""
    names = sorted({n for given in GAINS.values() for n in given}, key=list(BY_NAME).index)
    rows = [
        (f"`{name}`", *(str(given.get(name, BY_NAME[name].default)) for given in GAINS.values()))
        for name in names
    ]
    return table(("register", *GAINS), rows)


part("pro4-rov-ports")(partial(ports, Pro4Rov))
part("pro4-topside-ports")(partial(ports, Pro4Topside))
part("serial-gateway-ports")(partial(ports, SerialGateway))
part("stream-player-ports")(partial(ports, StreamPlayer))
part("m5-thrusters-ports")(partial(ports, M5Thrusters))
