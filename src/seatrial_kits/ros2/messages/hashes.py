"""Hashes of types, RIHS01 of REP 2016: nodes from Iron on compare definitions by them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from .definitions import NO_FIELDS, PARTS, fresh_store, of_action, ros_name, type_store
from .interfaces import INTERFACES

_EVENT_INFO = "service_msgs/msg/ServiceEventInfo"


@cache
def type_hash(kind: str) -> str:
    """Return the hash of ``package/msg/Name``, a service, or a part of an action.

    A service has one for its request and response, that of a type of its own: both, and the event
    by which it can be watched.
    """
    return str(_described().hash_rihs01(kind))


@cache
def announced_hash(kind: str) -> str:
    """Return the hash that an endpoint of a type of the store announces, that of its service.

    It is empty for distributions before Iron, which have none.
    """
    if _EVENT_INFO not in type_store().fielddefs:
        return ""
    name = ros_name(kind)
    for part in PARTS:
        name = name.removesuffix(part)
    return type_hash(name)


@cache
def _described() -> Any:
    """Return a store with parts of services and actions by the names that ROS gives them."""
    from rosbags.typesys import get_types_from_msg

    store = fresh_store()
    found: dict[str, Any] = {}
    for kind, text in INTERFACES.items():
        package, group, _ = kind.split("/")
        parts = dict(_texts(kind, text))
        names = {f"{package}/msg/{part}": f"{package}/{group}/{part}" for part in parts}
        for part, fields in parts.items():
            read = get_types_from_msg(fields, f"{package}/msg/{part}")
            found |= _named(read, names)
    store.register(found)
    # A char of ROS is an uint8, of rosbags a type of its own.
    for kind in (_EVENT_INFO, "rmw_dds_common/msg/Gid"):
        store.fielddefs[kind] = _named(store.fielddefs[kind], {"char": "uint8"})
    return store


def _texts(kind: str, text: str) -> Iterator[tuple[str, str]]:
    """Yield all types of a definition, with their fields, as if they were messages."""
    package, group, short = kind.split("/")
    if group == "msg":
        yield short, text
        return
    definitions = of_action(package, short, text) if group == "action" else {short: text}
    for part, fields in definitions.items():
        if "---\n" not in fields:
            yield part, fields or NO_FIELDS
            continue
        for end, half in zip(PARTS, fields.split("---\n"), strict=True):
            yield f"{part}{end}", half or NO_FIELDS
        both = f"{part}_Request[<=1] request\n{part}_Response[<=1] response\n"
        yield f"{part}_Event", f"{_EVENT_INFO} info\n{both}"
        ends = ("request", "response", "event")
        yield part, "".join(f"{part}_{end.capitalize()} {end}_message\n" for end in ends)


def _named(part: Any, names: Mapping[str, str]) -> Any:
    """Return definitions with other names of types."""
    if isinstance(part, str):
        return names.get(part, part)
    if isinstance(part, dict):
        return {names.get(name, name): _named(value, names) for name, value in part.items()}
    return type(part)(_named(e, names) for e in part) if isinstance(part, tuple | list) else part
