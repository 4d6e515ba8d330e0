"""Permission to reach more than the programs of this machine: devices, and other hosts.

Every kind of link asks here before it opens anything: one function for each question.
"""

from __future__ import annotations

import ipaddress
import json
import os
import re
import shutil
import socket
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import InputError
from .environment import variables
from .own_terminals import is_own

ALLOWED = "SEATRIAL_HARDWARE"
"""Environment variable that allows devices, if it is 1: components may run in other processes."""
NETWORK_ALLOWED = "SEATRIAL_NETWORK"
"""The same for other hosts."""
_FLAGS = {ALLOWED: "--hardware", NETWORK_ALLOWED: "--network"}
_CONFINED = "confined"
"""Value of both while no more than programs on this machine may be reached."""

_ANSWER_S = 5.0


def allow_devices() -> None:
    """Allow devices, in this process and those that it starts."""
    os.environ[ALLOWED] = "1"


def allow_network() -> None:
    """Allow other hosts, in this process and those that it starts."""
    os.environ[NETWORK_ALLOWED] = "1"


def devices_allowed() -> bool:
    """Return whether devices may be reached."""
    return os.environ.get(ALLOWED) == "1"


def network_allowed() -> bool:
    """Return whether other hosts may be reached."""
    return os.environ.get(NETWORK_ALLOWED) == "1"


@contextmanager
def confined() -> Iterator[None]:
    """Allow neither devices nor other hosts to components that start inside.

    Those in processes of their own keep to that.
    """
    with variables(dict.fromkeys(_FLAGS, _CONFINED)):
        yield


# ---------------------------------------------------------------------- what links ask


def check_serial_port(what: str, device: str) -> None:
    """Raise InputError for a serial port, unless it is a run's own terminal, or devices may be."""
    if not is_own(device):
        _require(ALLOWED, f"{what} reaches {_described(device)}")


def check_host(what: str, address: str) -> None:
    """Raise InputError for an IP address to send to, unless it is of this machine, or allowed."""
    if not is_this_machine(address):
        _require(NETWORK_ALLOWED, f"{what} reaches the host {address}")


def check_listening(what: str, address: str) -> None:
    """Raise InputError for an IP address to listen at that others reach, unless allowed."""
    if not is_this_machine(address):
        _require(NETWORK_ALLOWED, f"{what} listens at {address}, where other hosts reach it")


def check_can_bus(what: str, interface: str, channel: str) -> None:
    """Raise InputError for a bus of python-can's, unless it is proven virtual, or allowed."""
    match interface:
        case "virtual":
            return
        case "slcan" | "serial" if match := re.fullmatch(r"socket://([^:]+):\d+", channel):
            check_host(what, resolved(what, match[1]))
        case "slcan" | "serial":
            check_serial_port(what, channel)
        case "udp_multicast":
            _require(NETWORK_ALLOWED, f"{what} reaches the hosts of the group {channel}")
        case "socketcan" if is_virtual_can(channel):
            return
        case _:
            _require(ALLOWED, f"{what} reaches the bus {channel}, which is not proven virtual")


def is_this_machine(address: str) -> bool:
    """Return whether an IP address is of the loopback interface."""
    return ipaddress.ip_address(address).is_loopback


def is_virtual_can(interface: str) -> bool:
    """Return whether the kernel's driver of a CAN interface is ``vcan``, whatever its name is."""
    tool = shutil.which("ip", path=os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin"]))
    if tool is None:
        return False
    command = [tool, "-details", "-json", "link", "show", "dev", interface]
    try:
        shown = subprocess.run(command, capture_output=True, timeout=_ANSWER_S, check=True)
        return bool(json.loads(shown.stdout)[0]["linkinfo"]["info_kind"] == "vcan")
    except (OSError, subprocess.SubprocessError, ValueError, LookupError):
        return False


def resolved(what: str, host: str) -> str:
    """Return the IPv4 address of a host. Raises InputError for one that is unknown."""
    try:
        found = socket.getaddrinfo(host, None, socket.AF_INET, socket.SOCK_STREAM)
    except (OSError, UnicodeError) as error:
        cause = getattr(error, "strerror", None) or error
        raise InputError(f"{what}: host {host!r}: {cause}") from None
    return str(found[0][4][0])


# ---------------------------------------------------------------------- inside


def _require(variable: str, reaches: str) -> None:
    """Raise InputError unless the person who started this run allowed it."""
    value = os.environ.get(variable)
    if value == "1":
        return
    flag = _FLAGS[variable]
    if value == _CONFINED:
        raise InputError(
            f"{reaches}; a simulation in Python reaches programs on this machine alone; "
            f"run it with seatrial run {flag}"
        )
    raise InputError(
        f"{reaches}; allow it with {flag} (or {variable}=1 in the environment) "
        "if nothing there can do harm"
    )


def _described(device: str) -> str:
    if str(Path(device).resolve()).startswith("/dev/pts/"):
        return f"{device}, a terminal that no run of seatrial has opened: it may lead to a device"
    return f"the device {device}"
