"""Classes of the workspace, by the names of types; checked against the definitions of rosbags."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any

from seatrial.errors import InputError

from ..messages.definitions import type_store

_OF_ACTION = {
    "FeedbackMessage": "FeedbackMessage",
    "SendGoal": "SendGoalService",
    "GetResult": "GetResultService",
}


@cache
def interface(kind: str) -> Any:
    """Return the class of a message or service, ``package/msg/Name``, or of a part of an action.

    Raises ImportError where the workspace has no such package or type.
    """
    package, group, name = kind.split("/")
    name, _, part = name.partition("_")
    module = import_module(f"{package}.{'action' if part else group}")
    found = getattr(module, name, None)
    if found is None:
        raise ImportError(f"{package} has no {name}")
    if part in _OF_ACTION:
        return getattr(found.Impl, _OF_ACTION[part])
    return getattr(found, part) if part else found


def lacks(kind: str) -> str:
    """Return why the workspace has no such type, empty if it has."""
    try:
        interface(kind)
    except ImportError as error:
        return f"{kind} is not in this workspace: {error}"
    return ""


@cache
def message_type(kind: str) -> Any:
    """Return the class of a message.

    Raises InputError where its fields are not those of the definition that makes its bytes.
    """
    from rosbags.interfaces import Nodetype

    found = interface(kind)
    fields = [name for name, _ in type_store().fielddefs[kind][1]]
    theirs = list(found.get_fields_and_field_types())
    if theirs != fields:
        raise InputError(
            f"{kind} has the fields {', '.join(theirs)} in this workspace, in the definitions of "
            f"ROS_DISTRO {', '.join(fields)}: set ROS_DISTRO to the workspace's distribution"
        )
    for _, (sort, what) in type_store().fielddefs[kind][1]:
        while sort in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            sort, what = what[0]
        if sort == Nodetype.NAME:
            message_type(what)
    return found
