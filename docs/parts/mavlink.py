"""MAVLink: streams and modes, as the services have them."""

from __future__ import annotations

from pymavlink.dialects.v20 import all as mavlink

from parts import part
from parts.markdown import shown_number, table
from seatrial_kits.mavlink import node  # noqa: F401  brings all services
from seatrial_kits.mavlink.modes import dialect
from seatrial_kits.mavlink.service import Service


@part("mavlink-streams")
def streams() -> str:
    """Return the messages that every link gets, by interval."""
    intervals = {k: v for service in Service.__subclasses__() for k, v in service.streams.items()}
    rows = []
    for interval in sorted(set(intervals.values())):
        names = sorted(
            f"`{mavlink.mavlink_map[number].msgname}`"
            for number, each in intervals.items()
            if each == interval
        )
        rows.append((f"{shown_number(interval)} s", ", ".join(names)))
    return table(("every", "messages"), rows)


@part("mavlink-modes")
def modes() -> str:
    """Return the modes, and what each kind of vehicle calls them."""
    kinds = {
        "boat": dialect("ardupilotmega", submerged=False),
        "submarine": dialect("ardupilotmega", submerged=True),
        "boat, PX4": dialect("px4", submerged=False),
        "submarine, PX4": dialect("px4", submerged=True),
    }
    names = dict.fromkeys(mode.name for kind in kinds.values() for mode in kind.modes)
    rows = []
    for name in names:
        found = [kind.mode(name) for kind in kinds.values()]
        shown = [f"{mode.shown} ({mode.custom_mode})" if mode else "" for mode in found]
        rows.append((f"`{name}`", *shown))
    return table(("mode", *kinds), rows)
