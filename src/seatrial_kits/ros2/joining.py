"""Choice of the transport by which the link joins a domain."""

from __future__ import annotations

import logging
import os
from importlib.util import find_spec
from pathlib import Path

from seatrial.errors import InputError

from .dds.dds_transport import DdsTransport
from .rcl.node import RclpyNode
from .reach import domain_of
from .transport import Transport

_LOGGER = logging.getLogger("seatrial.ros2")
TRANSPORTS = ("auto", "dds", "rclpy")
_PACKAGES = "share/ament_index/resource_index/packages"
"""Where a workspace lists its packages."""
_spoken_in: set[int] = set()
"""Processes in which a domain was joined: this one, and one that it was forked from."""


def join(domain: int, node: str, transport: str = "auto") -> Transport:
    """Join a domain as the node ``node``, a name in full; a domain below 0: `domain_of`.

    ``auto`` is DDS, but rclpy where a workspace is sourced that this Python can import, and whose
    middleware is another than rmw_cyclonedds_cpp.

    Raises InputError for a domain or middleware that cannot be, and without the packages.
    """
    number = domain_of(domain)
    _check_process()
    if transport == "rclpy" or (transport == "auto" and _prefers_rclpy()):
        missing = _why_no_rclpy()
        if missing:
            raise InputError(f"rclpy cannot be used: {missing}: source a workspace of ROS 2")
        return RclpyNode(number, node)
    return DdsTransport(number, node)


def _prefers_rclpy() -> bool:
    if os.environ.get("RMW_IMPLEMENTATION") == "rmw_cyclonedds_cpp" and find_spec("cyclonedds"):
        return False
    missing = _why_no_rclpy()
    if missing and os.environ.get("AMENT_PREFIX_PATH"):
        _LOGGER.warning(
            "rclpy cannot be used: %s: the link speaks DDS, whose services nodes of "
            "rmw_cyclonedds_cpp alone can call",
            missing,
        )
    return not missing


def _why_no_rclpy() -> str:
    """Return why rclpy cannot be had, empty if it can.

    It may be of another Python. A middleware that is not there ends the process as rclpy comes.
    """
    named = os.environ.get("RMW_IMPLEMENTATION", "")
    workspace = filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep))
    if named and not any(Path(folder, _PACKAGES, named).is_file() for folder in workspace):
        return f"no sourced workspace has {named}, which RMW_IMPLEMENTATION names"
    try:
        import rclpy  # noqa: F401
    except ImportError as error:
        return f"{error}".partition("\n")[0]
    return ""


def _check_process() -> None:
    """Raise InputError in a fork of a process that joined: a middleware's threads are not here."""
    _spoken_in.add(os.getpid())
    if len(_spoken_in) > 1:
        raise InputError(
            "this process was forked from one that speaks DDS, whose library cannot follow: run "
            "the trial from a process of its own (seatrial run)"
        )
