"""Definitions of messages and services: the store of rosbags, and `interfaces`.

A service ``package/srv/Name`` has two messages, ``package/msg/Name_Request`` and ``..._Response``
in the store, each with the header that rmw_cyclonedds puts before the fields. An action
``package/action/Name`` has the services ``package/action/Name_SendGoal`` and ``..._GetResult``.
"""

from __future__ import annotations

import os
from functools import cache
from typing import Any

from seatrial.errors import InputError, unknown

from .interfaces import INTERFACES

INSTALL = 'pip install "seatrial[ros2]"'
NO_FIELDS = "uint8 structure_needs_at_least_one_member\n"
"""Of a message without any, as rosidl has it."""
_HEADER = "uint64 client_guid\nint64 sequence_number\n"
PARTS = ("_Request", "_Response")
_WITHOUT_NODES = ("ROS2_DASHING", "ROS2_ELOQUENT")
"""Distributions whose nodes are announced otherwise."""


def fresh_store() -> Any:
    """Return a store of the types of ROS_DISTRO, else Humble's, as rosbags has it.

    Raises InputError without the package rosbags, and for a distribution that it has not.
    """
    try:
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(f"ROS 2 needs rosbags, which is not installed: {INSTALL}") from None
    stores = {
        each.value.removeprefix("ros2_"): each
        for each in Stores
        if each.value.startswith("ros2_") and each.name not in _WITHOUT_NODES
    }
    stores["rolling"] = Stores.LATEST
    distribution = os.environ.get("ROS_DISTRO", "") or "humble"
    if distribution not in stores:
        raise InputError(f"ROS_DISTRO: {unknown('distribution', distribution, stores)}")
    return get_typestore(stores[distribution])


@cache
def type_store() -> Any:
    """Return the store of the types of ROS_DISTRO, else Humble's, with those of `INTERFACES`.

    From Iron on, identifiers of nodes have 16 bytes, not 24, and a Range has a variance. Raises
    InputError as `fresh_store`.
    """
    store = fresh_store()
    from rosbags.typesys import get_types_from_msg

    found: dict[str, Any] = {}
    for name, text in INTERFACES.items():
        package, group, short = name.split("/")
        if group == "msg":
            found |= get_types_from_msg(text, name)
            continue
        definitions = of_action(package, short, text) if group == "action" else {short: text}
        for part, fields in definitions.items():
            if "---\n" not in fields:
                found |= get_types_from_msg(fields, f"{package}/msg/{part}")
                continue
            for end, half in zip(PARTS, fields.split("---\n"), strict=True):
                whole = _HEADER + (half or NO_FIELDS)
                found |= get_types_from_msg(whole, f"{package}/msg/{part}{end}")
    store.register(found)
    return store


def of_action(package: str, name: str, text: str) -> dict[str, str]:
    """Return the messages and services of an action, of its three parts."""
    named = f"{package}/msg/{name}"
    own = dict(zip(("_Goal", "_Result", "_Feedback"), text.split("---\n"), strict=True))
    identity = "unique_identifier_msgs/UUID goal_id\n"
    made = {
        **own,
        "_FeedbackMessage": f"{identity}{named}_Feedback feedback\n",
        "_SendGoal": f"{identity}{named}_Goal goal\n---\nbool accepted\n"
        "builtin_interfaces/Time stamp\n",
        "_GetResult": f"{identity}---\nint8 status\n{named}_Result result\n",
    }
    return {f"{name}{part}": fields for part, fields in made.items()}


def service_parts(kind: str) -> tuple[str, str]:
    """Return the names in the store of a service's request and response."""
    package, _, name = kind.split("/")
    return f"{package}/msg/{name}_Request", f"{package}/msg/{name}_Response"


def ros_name(kind: str) -> str:
    """Return the name that ROS has for a type of the store, as ``package/srv/Name_Request``."""
    package, _, name = kind.split("/")
    action = f"{package}/action/{name.partition('_')[0]}" in INTERFACES
    group = "action" if action else "srv" if name.endswith(PARTS) else "msg"
    return f"{package}/{group}/{name}"


def dds_name(kind: str) -> str:
    """Return the name of a type of the store in DDS, ``package::msg::dds_::Name_``."""
    package, group, name = ros_name(kind).split("/")
    return f"{package}::{group}::dds_::{name}_"
