"""Propulsors that turn together by one steering angle: two outboards on one helm."""

from __future__ import annotations

from collections.abc import Sequence

from seatrial.errors import InputError


def require_steering(
    name: str, turns_with: Sequence[float], ranges: Sequence[Sequence[float]]
) -> list[int]:
    """Return the place of the propulsor that each of ``turns_with`` turns with, its own if none.

    ``ranges`` are those of the angles, from and to. Raises InputError, with the component's
    ``name``, for a number that is no propulsor's or that of one without an angle of its own, and
    for a range that is not read.
    """
    leaders = []
    for place, number in enumerate(turns_with):
        leaders.append(place if number == 0.0 else _leader(name, place, turns_with, ranges))
    return leaders


def _leader(
    name: str, place: int, turns_with: Sequence[float], ranges: Sequence[Sequence[float]]
) -> int:
    number, count = turns_with[place], len(turns_with)
    said = f"{name}.propulsor_turns_with_{place + 1} is {number!r}"
    if number % 1.0 or not 0.0 <= number <= count:
        raise InputError(f"{said}: 0 for none, or the number of a propulsor, 1 to {count}")
    leader = int(number) - 1
    (low, high), own = ranges[leader], ranges[place]
    if turns_with[leader] or not low < high:
        raise InputError(
            f"{said}: that propulsor has no angle of its own: give the number of one with a range "
            "of angles that turns with none"
        )
    if tuple(own) != (0.0, 0.0):
        raise InputError(
            f"{said}: its propulsor_angle_limit_{place + 1} of {own[0]:.4g} to {own[1]:.4g} rad is "
            f"not read, that of propulsor {number:g} is: leave it out"
        )
    return leader
