"""Links to UARTs: texts such as ``0=serial:/dev/ttyACM0:115200 2=pty:/tmp/radio``."""

from __future__ import annotations

from seatrial.errors import InputError
from seatrial.links.endpoints.budget import Budget
from seatrial.links.endpoints.endpoint import Endpoint
from seatrial.links.endpoints.url import check_urls, open_endpoints

from .wiring import UARTS


def read_links(text: str, key: str = "links") -> dict[int, str]:
    """Return the URL of each UART. Raises InputError for a ``key`` that is not UART=URL."""
    found: dict[int, str] = {}
    for link in text.split():
        uart, _, url = link.partition("=")
        if not (uart.isdecimal() and int(uart) < UARTS and url):
            raise InputError(
                f"{key}: {link!r} is not UART=URL, as 0=serial:/dev/ttyACM0:115200 or 0=pty:/tmp/0"
            )
        if int(uart) in found:
            raise InputError(f"{key}: {link!r}: UART {uart} has a link already")
        try:
            check_urls(url)
        except InputError as error:
            raise InputError(f"{key}: {error}") from None
        found[int(uart)] = url
    return found


def read_monitors(text: str) -> dict[int, str]:
    """`read_links` of the key ``monitors``."""
    return read_links(text, "monitors")


def open_links(text: str, key: str = "links") -> dict[int, Endpoint]:
    """Open the links of a text. Raises InputError, and leaves none open, if one cannot be."""
    links = read_links(text, key)
    ports = open_endpoints(key, " ".join(links.values()))
    for port in ports:
        port.budget = Budget.of_raw_bytes()
    return dict(zip(links, ports, strict=True))
