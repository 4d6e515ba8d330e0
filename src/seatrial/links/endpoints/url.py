"""Endpoints by URL.

=========================== =================================================================
``udpout:HOST:PORT``        sends to one address, and receives it alone
``udpin:HOST:PORT``         bound there; sends to all that have sent something
``tcpin:HOST:PORT``         a server with any number of clients
``tcpout:HOST:PORT``        a client, which connects again when the connection is lost
``serial:DEVICE:BAUD``      a serial port
``pty:PATH``                a new pseudo-terminal, which others open as a serial port at PATH
``pty``                     the same at a device of the system's choice
=========================== =================================================================

HOST is a name or an IPv4 address, PORT 0 at ``udpin`` and ``tcpin`` any free one. PATH becomes a
symbolic link to the terminal, for as long as the endpoint is open. What is beyond the programs of
this machine is opened only if it is allowed (`hardware`).
Packages add kinds by entry points; `endpoint` says what they must do.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from ...errors import InputError
from ...plugins import Registry
from ..hardware import check_host, check_listening, check_serial_port, resolved
from ..own_terminals import is_own
from .budget import ALL_RATE, RATE, Budget
from .descriptor import SerialEndpoint
from .endpoint import Endpoint
from .pseudo_terminal import PseudoTerminal
from .tcp import TcpClient, TcpServer
from .udp import UdpListener, UdpSender

_FORMS = {
    "udpout": "udpout:127.0.0.1:14550",
    "udpin": "udpin:127.0.0.1:14551",
    "tcpin": "tcpin:127.0.0.1:5760",
    "tcpout": "tcpout:127.0.0.1:5762",
    "serial": "serial:/dev/ttyUSB0:57600",
    "pty": "pty:/tmp/vehicle",
}
TRANSPORTS = Registry(
    "seatrial.transports", "kind of link", dict.fromkeys(_FORMS, f"{__name__}:opened")
)
_URL = re.compile(r"(?P<kind>[a-z]+):(?P<place>.+):(?P<number>\d{1,9})")


def open_endpoint(url: str) -> Endpoint:
    """Open the endpoint ``url``.

    Raises InputError, with the URL, for one that is malformed or cannot be opened (a port in
    use, an unknown host, no such device, hardware that is not allowed).
    """
    _check(url)
    factory: Callable[[str], Endpoint] = TRANSPORTS.load(_kind(url))
    try:
        return factory(url)
    except OSError as error:
        raise InputError(f"cannot open the link {url!r}: {error.strerror or error}") from None


def opened(url: str) -> Endpoint:
    """Open an endpoint of a shipped kind. Raises InputError, OSError."""
    kind, place, number = _parts(url)
    what = f"link {url!r}"
    if kind == "pty":
        return PseudoTerminal(place)
    if kind == "serial":
        check_serial_port(what, place)
        return SerialEndpoint(url, place, number)
    address = resolved(what, place)
    ask, factory = _BY_ADDRESS[kind]
    ask(what, address)
    return factory((address, number))


_BY_ADDRESS: dict[str, tuple[Callable[[str, str], None], Callable[[tuple[str, int]], Endpoint]]] = {
    "udpout": (check_host, UdpSender),
    "udpin": (check_listening, UdpListener),
    "tcpin": (check_listening, TcpServer),
    "tcpout": (check_host, TcpClient),
}


def open_endpoints(key: str, urls: str) -> list[Endpoint]:
    """Open all ``urls``, separated by spaces, of the parameter ``key``.

    They share what a component takes in: many links flooded at once cost no more than two.

    Raises InputError, with the key, and leaves none open, if one cannot be.
    """
    endpoints: list[Endpoint] = []
    try:
        for url in urls.split():
            endpoints.append(open_endpoint(url))
    except InputError as error:
        for endpoint in endpoints:
            endpoint.close()
        raise InputError(f"{key}: {error}") from None
    if len(endpoints) > ALL_RATE / RATE:
        for endpoint in endpoints:
            endpoint.budget = Budget(ALL_RATE / len(endpoints))
    return endpoints


def reaches_device(url: str) -> bool:
    """Return whether there may be a device, and no run of seatrial, at the other end."""
    return _kind(url) == "serial" and not is_own(_parts(url)[1])


def check_urls(links: str) -> None:
    """Raise InputError for the first of ``links``, separated by spaces, that is malformed.

    Of a kind that a package adds, nothing is known before the link is opened but its name.
    """
    for url in links.split():
        _check(url)


def other_end(url: str) -> str:
    """Return what the other end opens, as pymavlink and MAVProxy write it."""
    kind, _, place = url.partition(":")
    others = {"udpout": "udpin", "udpin": "udpout", "tcpin": "tcp", "tcpout": "tcpin"}
    if kind == "pty":
        return place
    return f"{others[kind]}:{place}" if kind in others else url


def _kind(url: str) -> str:
    return url.partition(":")[0]


def _check(url: str) -> None:
    try:
        TRANSPORTS.target(_kind(url))
    except InputError as error:
        raise InputError(f"link {url!r}: {error}") from None
    if _kind(url) in _FORMS:
        _parts(url)


def _parts(url: str) -> tuple[str, str, int]:
    kind = _kind(url)
    if kind == "pty":
        if url == "pty:":
            raise InputError(f"link {url!r} is not of the form {_FORMS[kind]!r}")
        return kind, url.removeprefix("pty").removeprefix(":"), 0
    match = _URL.fullmatch(url)
    plain = match is not None and (kind == "serial" or not set(match["place"]) & set(":/"))
    if match is None or not plain:
        raise InputError(f"link {url!r} is not of the form {_FORMS[kind]!r}")
    place, number = match["place"], int(match["number"])
    lowest = 0 if kind in ("udpin", "tcpin") else 1
    highest = 65535 if kind != "serial" else 100_000_000
    if not lowest <= number <= highest:
        what = "baud rate" if kind == "serial" else "port"
        raise InputError(f"link {url!r}: the {what} is {number}, allowed {lowest} to {highest}")
    return kind, place, number
