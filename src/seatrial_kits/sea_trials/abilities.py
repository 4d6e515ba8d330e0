"""Abilities of a vehicle, by its rig: the manoeuvres of sea trials that apply to it."""

from __future__ import annotations

from functools import lru_cache

from seatrial.control.guidance import RESTING
from seatrial.system.assembling.assembly import assemble
from seatrial.system.part import Part
from seatrial.system.system import System
from seatrial.trial.files.trial import Trial

from .orders import DIVES, MOORED, NEEDS, PITCHES, STAYS, STEERS, STOPS

_LACKING = {
    STEERS: "its pilot takes no order of speed: the wind drives it, or its buoyancy",
    STOPS: "no command reaches its propulsion",
    STAYS: "its pilot keeps it under way: it does not turn or stay without speed",
    DIVES: "its pilot holds no depth",
    PITCHES: "its pilot does not dive by pitch",
    MOORED: "its [mooring] has no line, or fins alone hold its pitch, which need speed",
}
"""Why a vehicle without an ability is not put through a manoeuvre."""


def reason_against(trial: Trial) -> str | None:
    """Return why the manoeuvre of a trial does not apply to its vehicle; None if it does.

    Guidance tells: whether speed orders go on from it, ``staying``, and ``depth_control``. A pilot
    with ``depth-by-pitch`` pitches, and has no bollard pull: without speed its fins hold neither
    pitch nor depth. A line with a stiffness moors. Raises InputError for a rig that does not go
    together.
    """
    choices = dict(trial.file.choices)
    needed = NEEDS.get(choices.pop("manoeuvre", ""), STEERS)
    sources = tuple(source.sha256 for source in (trial.rig.read_from, *trial.rig.sources))
    able = _able(_Rig(trial, (sources, trial.file.variant, *sorted(choices.items()))))
    return None if needed in able else _LACKING[STEERS if STEERS not in able else needed]


class _Rig:
    """A trial as far as it decides what its vehicle can do."""

    def __init__(self, trial: Trial, key: object) -> None:
        self.trial, self._key = trial, key

    def __hash__(self) -> int:
        return hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Rig) and self._key == other._key


@lru_cache(maxsize=16)
def _able(rig: _Rig) -> frozenset[str]:
    system = assemble(rig.trial.rig, "direct", variant=rig.trial.file.variant)
    try:
        return abilities(system)
    finally:
        system.discard()


def abilities(system: System) -> frozenset[str]:
    """Return what the vehicle of a rig can do, among the abilities of `orders`."""
    if any(_is_driven(part) for part in system.parts.values()):
        return frozenset()
    found = {STEERS}
    for part in system.parts.values():
        if part.fmu == "depth-by-pitch":
            found.add(PITCHES)
        elif part.fmu == "mooring" and _value(part, "stiffness") not in (0.0, None):
            found.add(MOORED)
        elif part.fmu == "guidance":
            sources = {c.source for c in system.connections}
            if (part.name, "direct.surge") in sources:
                found.add(STOPS)
            if _value(part, "depth_control") == "on":
                found.add(DIVES)
            if _value(part, "staying") in RESTING:
                found.add(STAYS)
    without = {STAYS, MOORED} if STOPS not in found else {MOORED} if PITCHES in found else set()
    return frozenset(found - without)


def _is_driven(part: Part) -> bool:
    """Return whether a pilot has that part whose craft is driven by wind or buoyancy."""
    return part.fmu == "sailing-guidance" or (
        part.fmu == "helm" and _value(part, "surge_limit") == 0.0
    )


def _value(part: Part, name: str) -> object:
    """Return the value that a parameter starts with."""
    if name in part.given:
        return part.given[name].value
    return part.instance.variables[name].start
