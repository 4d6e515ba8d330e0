"""Terminals that an FMU of others could show, found by names, units and causality.

Only a proposal, for its user to read: names are how people find signals, not how programs may.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ...errors import InputError
from ...model.units import conversion
from ..instance import Variable, Variables

_FLAG, _TEXT = "flag", "text"


@dataclass(frozen=True)
class Word:
    """A terminal of `seatrial.model.terminals` as FMUs may have it."""

    name: str
    members: Mapping[str, tuple[str, int]]
    """Unit (or that it is a flag or a text) and number of scalars."""
    causalities: tuple[str, ...]
    """That all members may have; ``mixed``: each its own."""
    needs: str = ""
    """The member without which it is none."""


_MOTION = {
    "position": ("m", 3),
    "velocity": ("m/s", 3),
    "attitude": ("rad", 3),
    "rates": ("rad/s", 3),
    "acceleration": ("m/s2", 3),
}
_READING = {
    "position_n": ("m", 3),
    "velocity_n": ("m/s", 3),
    "position_valid": (_FLAG, 1),
    "heading": ("rad", 1),
    "heading_valid": (_FLAG, 1),
    "heel": ("rad", 1),
    "roll_pitch": ("rad", 2),
    "roll_rate": ("rad/s", 1),
    "yaw_rate": ("rad/s", 1),
    "gyro": ("rad/s", 3),
    "gyro_valid": (_FLAG, 1),
    "accelerometer": ("m/s2", 3),
    "imu_valid": (_FLAG, 1),
    "wind_speed": ("m/s", 1),
    "wind_angle": ("rad", 1),
    "wind_valid": (_FLAG, 1),
    "depth": ("m", 1),
    "depth_valid": (_FLAG, 1),
    "pressure": ("Pa", 1),
}
_ATTACHMENT = {"point": ("m", 3), "velocity": ("m/s", 3), "force": ("N", 3)}

WORDS = (
    Word("motion", _MOTION, ("output", "input")),
    Word("wrench", {"force": ("N", 3), "moment": ("N.m", 3)}, ("input", "output"), needs="force"),
    Word("attachment", _ATTACHMENT, ("mixed",), needs="point"),
    Word("reading", _READING, ("output",)),
    Word("sensors", _READING, ("input",)),
    Word("actuators", {f"ch{n}": ("s", 1) for n in range(1, 17)}, ("input",)),
    Word("serial", {"down": (_TEXT, 1), "up": (_TEXT, 1)}, ("mixed",)),
)
"""Those of whose members the word says unit and number; not failures and orders."""


def proposed_terminals(variables: Variables) -> dict[str, dict[str, str]]:
    """Return ports by member of the terminals that ``variables`` could be.

    A port or scalar has the name of the member, in any case, and its quantity; one without a
    unit may be any. A terminal has members of one causality: the first of the word that some have.
    """
    found: dict[str, dict[str, str]] = {}
    called = {name.casefold(): name for name in (*variables.ports, *variables)}
    called |= {name: name for name in (*variables.ports, *variables)}
    for word in WORDS:
        members = next(_members(word, variables, called), {})
        if members:
            found[word.name] = members
    return found


def _members(
    word: Word, variables: Variables, called: Mapping[str, str]
) -> Iterator[dict[str, str]]:
    """Yield the members of each causality that has some."""
    for causality in word.causalities:
        wanted = {"input", "output"} if causality == "mixed" else {causality}
        members = {}
        for member, (quantity, count) in word.members.items():
            name = called.get(member)
            scalars = _scalars(variables, name)
            fits = len(scalars) == count and all(_fits(v, quantity, wanted) for v in scalars)
            if name is not None and fits and len({v.causality for v in scalars}) == 1:
                members[member] = name
        if members and (not word.needs or word.needs in members):
            yield members


def _scalars(variables: Variables, name: str | None) -> list[Variable]:
    if name is None:
        return []
    return [variables[name]] if name in variables else variables.ports[name]


def _fits(variable: Variable, quantity: str, causalities: set[str]) -> bool:
    if variable.causality not in causalities:
        return False
    if quantity in (_FLAG, _TEXT):
        return variable.type is (bool if quantity == _FLAG else str)
    if variable.type is not float:
        return False
    if not variable.unit:
        return True
    try:
        conversion(variable.measure, quantity)
    except InputError:
        return False
    return True
