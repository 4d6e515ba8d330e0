"""Gateways by URL.

======================================== ====================================================
``socketcand:HOST:PORT``                 a server with socketcand's protocol
``slcan-tcp:HOST:PORT``                  a server with serial adapters' protocol (LAWICEL)
``slcan-pty``                            the same at a pseudo-terminal
``yd-raw-tcp:HOST:PORT``                 a server with Yacht Devices' protocol
``yd-raw-udp:HOST:PORT``                 the same, to one address
``dronecan-multicast:BUS``               DroneCAN's bus over UDP multicast, of this machine alone
``virtual:CHANNEL``                      python-can's bus within this process
``python-can:INTERFACE:CHANNEL:BITRATE`` anything that python-can has; ``:BITRATE`` if it needs
                                         one
======================================== ====================================================

HOST is a name or an IPv4 address: of this machine for servers, whose PORT 0 is any free one.
BUS is 0 to 255. What is beyond the programs of this machine is opened only if it is allowed
(`hardware`).
"""

from __future__ import annotations

import re
from collections.abc import Callable

from seatrial.errors import InputError, unknown
from seatrial.links.endpoints.pseudo_terminal import PseudoTerminal
from seatrial.links.endpoints.tcp import TcpServer
from seatrial.links.endpoints.udp import UdpSender
from seatrial.links.hardware import check_can_bus, check_host, check_listening, resolved

from .dronecan_multicast import DroneCanMulticastGateway
from .gateway import Gateway
from .python_can import PythonCanGateway
from .slcan import SlcanGateway
from .socketcand import SocketcandGateway
from .yd_raw import YdRawGateway

FORMS = {
    "socketcand": "socketcand:127.0.0.1:29536",
    "slcan-tcp": "slcan-tcp:127.0.0.1:29537",
    "slcan-pty": "slcan-pty",
    "yd-raw-tcp": "yd-raw-tcp:127.0.0.1:1457",
    "yd-raw-udp": "yd-raw-udp:127.0.0.1:2002",
    "dronecan-multicast": "dronecan-multicast:0",
    "virtual": "virtual:can0",
    "python-can": "python-can:socketcan:can0:250000",
}
"""Every kind of gateway, with an example of its URL."""
_SHAPES = {
    "socketcand": r"(?P<host>[^:/]+):(?P<port>\d{1,5})",
    "slcan-tcp": r"(?P<host>[^:/]+):(?P<port>\d{1,5})",
    "slcan-pty": r"",
    "yd-raw-tcp": r"(?P<host>[^:/]+):(?P<port>\d{1,5})",
    "yd-raw-udp": r"(?P<host>[^:/]+):(?P<port>\d{1,5})",
    "dronecan-multicast": r"(?P<bus>25[0-5]|2[0-4]\d|1?\d?\d)",
    "virtual": r"(?P<channel>.+)",
    "python-can": r"(?P<interface>[a-z_0-9]+):"
    r"(?P<channel>socket://[^:]+:\d+|[^:]+)(?::(?P<bitrate>\d{4,7}))?",
}


def check_link(url: str) -> None:
    """Raise InputError for a URL that is malformed."""
    _parts(url)


def open_gateway(url: str) -> Gateway:
    """Open the gateway ``url``.

    Raises InputError, with the URL, for one that is malformed or cannot be opened (a port in
    use, no such bus, hardware that is not allowed).
    """
    kind, parts = _parts(url)
    if kind in ("virtual", "python-can"):
        interface, channel = parts.get("interface", "virtual"), parts["channel"]
        check_can_bus(f"gateway {url!r}", interface, channel)
        bitrate = int(parts["bitrate"]) if parts.get("bitrate") else None
        return PythonCanGateway(url, interface, channel, bitrate)
    if kind == "slcan-pty":
        return SlcanGateway(PseudoTerminal())
    return _networked(url, kind, parts)


def _networked(url: str, kind: str, parts: dict[str, str]) -> Gateway:
    what = f"gateway {url!r}"
    try:
        if kind == "dronecan-multicast":
            return DroneCanMulticastGateway(int(parts["bus"]))
        address = (resolved(what, parts["host"]), int(parts["port"]))
        if kind == "yd-raw-udp":
            check_host(what, address[0])
            return YdRawGateway(UdpSender(address))
        check_listening(what, address[0])
        return _SERVERS[kind](TcpServer(address))
    except (OSError, OverflowError) as error:
        cause = getattr(error, "strerror", None) or error
        raise InputError(f"cannot open the gateway {url!r}: {cause}") from None


_SERVERS: dict[str, Callable[[TcpServer], Gateway]] = {
    "socketcand": SocketcandGateway,
    "slcan-tcp": SlcanGateway,
    "yd-raw-tcp": YdRawGateway,
}


def _parts(url: str) -> tuple[str, dict[str, str]]:
    kind, _, rest = url.partition(":")
    if kind not in FORMS:
        raise InputError(f"gateway {url!r}: {unknown('kind of gateway', kind, FORMS)}")
    match = re.fullmatch(_SHAPES[kind], rest)
    if match is None:
        raise InputError(f"gateway {url!r} is not of the form {FORMS[kind]!r}")
    return kind, match.groupdict()
