"""Commands to the vehicle's pilot: velocity, wrench and goal, as orders of guidance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from .frames import enu, flu
from .published import MAP, ODOM

_LEAD = math.radians(60.0)
"""The farthest that the heading wanted runs ahead of the vehicle's."""
_FARTHEST = 1e6
"""Goals beyond are no place to go to, m."""


@dataclass(frozen=True)
class Orders:
    """Orders to guidance; see its inputs. {n}, SI, rad."""

    mode: str = "hold"
    manual: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    target_kind: str = "position"
    target_valid: bool = False
    target_position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    target_heading: float = 0.0
    target_speed: float = 0.0
    target_sway: float = 0.0


class VelocityOrders:
    """A Twist as a heading that turns, speeds ahead and abeam, and a depth that changes.

    psi' = -angular.z, z' = -linear.z, from those of the vehicle when the command began; the
    heading wanted is at most 60 degrees ahead of the vehicle's. A pilot that ``sways`` gets
    -linear.y as speed to starboard. Once per instant it is told what is measured; orders may be
    asked for again as commands come.
    """

    def __init__(self, *, sways: bool) -> None:
        self._sways = sways
        self._heading = self._depth = 0.0
        self._begun: tuple[float, float] | None = None
        """Heading and depth wanted at the last instant; None without a command."""
        self._wanted: tuple[float, float] | None = None

    def measured(self, heading: float, depth: float) -> None:
        """Take heading, rad, and depth, m, of an instant."""
        self._heading, self._depth = heading, depth
        self._begun = self._wanted

    def stop(self) -> None:
        """Begin anew with the next command."""
        self._wanted = None

    def orders(self, twist: Any, period: float) -> Orders:
        """Return the orders from an instant, s, after the last measurement on."""
        heading, depth = self._begun or (self._heading, self._depth)
        ahead = math.remainder(heading - self._heading, math.tau) - twist.angular.z * period
        heading = self._heading + min(max(ahead, -_LEAD), _LEAD)
        depth -= twist.linear.z * period
        self._wanted = heading, depth
        return Orders(
            "guided",
            target_kind="body" if self._sways else "heading",
            target_valid=True,
            target_position=(0.0, 0.0, depth),
            target_heading=math.remainder(heading, math.tau),
            target_speed=float(twist.linear.x),
            target_sway=-float(twist.linear.y) if self._sways else 0.0,
        )


def unfollowed(twist: Any, *, sways: bool, dives: bool) -> list[str]:
    """Return why parts of a Twist that are not 0 are not followed."""
    parts = (
        ("linear.y", twist.linear.y and not sways, "no sway"),
        ("linear.z", twist.linear.z and not dives, "no depth"),
        ("angular.x", twist.angular.x, "no roll to turn"),
        ("angular.y", twist.angular.y, "no pitch to turn"),
    )
    return [
        f"{name} is not followed: this pilot has {why}" for name, is_lost, why in parts if is_lost
    ]


def wrench_orders(wrench: Any, full: tuple[float, ...]) -> Orders:
    """Return a Wrench in base_link as shares of manual control; ``full`` is X, Y, Z, N."""
    force, moment = wrench.force, wrench.torque
    x, y, z = flu((force.x, force.y, force.z))
    asked = x, y, z, flu((moment.x, moment.y, moment.z))[2]
    surge, sway, heave, yaw = (
        min(max(a / f, -1.0), 1.0) if f else 0.0 for a, f in zip(asked, full, strict=True)
    )
    return Orders("manual", (surge, sway, yaw, heave))


def goal_orders(goal: Any, prefix: str) -> Orders | str:
    """Return a PoseStamped as a position to go to and stay at, or why it is none."""
    frame = goal.header.frame_id.removeprefix(prefix)
    if frame not in ("", MAP, ODOM):
        return f"goals in the frame {goal.header.frame_id!r} are refused: {MAP} is needed"
    place = goal.pose.position
    position = enu((place.x, place.y, place.z))
    if not all(abs(x) <= _FARTHEST for x in position):
        return "goals farther than 1000 km are refused"
    return Orders("guided", target_valid=True, target_position=position)
