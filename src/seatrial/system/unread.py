"""Parts of rigs inside a rig that a run can do without: nothing reads what they give."""

from __future__ import annotations

from collections.abc import Set

from .joining import Resolver
from .system import System


def leave_out_unread(system: System, named: Set[str]) -> None:
    """Take the parts that nothing reads out of a system, with a note.

    A vehicle brings all its sensors to every autopilot, and an IMU that none of them reads costs
    a quarter of a run. A part goes if it stands in a rig inside another one, feeds nothing, has
    no tie to the world outside, is not shown by the whole rig and not ``named`` by who runs it.
    Who made a package alone knows what its parts are for: they all stay.
    """
    made = (*system.connections, *system.initial)
    kept = {connection.source[0] for connection in made} | named
    kept |= {component for component, _ in system.tuned}
    kept |= {end.component for end in Resolver(system.parts, system.rig.top).shown_outside()}
    unread = [
        name
        for name, part in system.parts.items()
        if name not in kept and part.instance.rolls_back and _is_inside(system, name)
    ]
    if unread:
        system.leave_out(unread)
        system.notes.append(
            f"left out, as nothing reads it: {', '.join(unread)} (a record that names it keeps it)"
        )


def _is_inside(system: System, name: str) -> bool:
    scope = system.rig.components[name].scope
    return bool(scope.path) and not scope.is_open
