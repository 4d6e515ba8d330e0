"""How far the link reaches: the domain, and the loopback interface unless a run has the network."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from seatrial.errors import InputError
from seatrial.links.environment import variables
from seatrial.links.hardware import network_allowed

from .confinement import confined_sockets

HIGHEST_DOMAIN = 232
"""Domains above have no ports of their own in DDS."""
LOOPBACK = (
    '<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>60</MaxAutoParticipantIndex>"
    '<Peers><Peer address="127.0.0.1"/></Peers></Discovery>'
)
"""What nodes must have in CYCLONEDDS_URI too, to be found without multicast."""
_OF_CYCLONE = {"CYCLONEDDS_URI": LOOPBACK}
_OF_ROS = {"ROS_LOCALHOST_ONLY": "1", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
"""The first up to Iron, the second from then on."""


def domain_of(given: int) -> int:
    """Return the domain; below 0 that of ROS_DOMAIN_ID, else 0.

    Raises InputError for one that cannot be.
    """
    if given >= 0:
        return given
    written = os.environ.get("ROS_DOMAIN_ID", "") or "0"
    if not written.isdecimal() or int(written) > HIGHEST_DOMAIN:
        raise InputError(f"ROS_DOMAIN_ID is {written!r}, allowed 0 to {HIGHEST_DOMAIN}")
    return int(written)


def reaches_others() -> bool:
    """Return whether other hosts are reached: allowed, and not narrowed by ROS' own variables."""
    narrowed = os.environ.get("ROS_LOCALHOST_ONLY") == "1" or os.environ.get(
        "ROS_AUTOMATIC_DISCOVERY_RANGE", ""
    ).upper() in ("LOCALHOST", "OFF")
    return network_allowed() and not narrowed


@contextmanager
def confined(*, cyclone: bool) -> Iterator[None]:
    """Make a middleware that starts inside stay on the loopback, unless others are reached.

    CycloneDDS reads its configuration as the first participant comes; others read ROS' variables.
    """
    others = reaches_others()
    wanted = {} if others else _OF_CYCLONE if cyclone else _OF_ROS
    with variables(wanted), confined_sockets(others):
        yield
