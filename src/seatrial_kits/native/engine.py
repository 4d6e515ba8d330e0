"""Components of a rig carried by FMUs in C, where there are any."""

from __future__ import annotations

from collections.abc import Callable

from seatrial.errors import InputError
from seatrial.fmi.components.source import ComponentSource, find_source
from seatrial.fmi.direct import DirectInstance
from seatrial.system.part import Part
from seatrial.system.system import System


def carry_natively(
    system: System, progress: Callable[[str], None] = lambda _: None, *, weather: bool = False
) -> dict[str, list[str]]:
    """Let native FMUs carry the components of a system whose engine is "native".

    To be called when all parameters are given: texts among them are built in, and waves, current
    and wind around a plant are those of its parameters then. FMUs come from the user's cache, and
    are built if they are not there. What has no C stays in process; there it is noted why, and
    returned, components by reason. With ``weather`` plants are ready for waves, current and wind,
    which `meet_weather` lets them meet. Raises InputError without a compiler.
    """
    if system.engine != "native":
        return {}
    stay: dict[str, list[str]] = {}
    for part in system.parts.values():
        if isinstance(part.instance, DirectInstance):
            progress(f"{part.name} ({part.fmu}, in C)")
            why = _carry(system, part, weather)
            if why:
                stay.setdefault(why, []).append(part.name)
    system.notes += [f"in Python: {', '.join(names)}: {why}" for why, names in stay.items()]
    return stay


def meet_weather(system: System) -> None:
    """Let plants in C, carried with ``weather``, meet that of their parameters at their next start.

    Raises InputError for a sea, a current or a wind that cannot be.
    """
    from .surroundings import NOTHING, is_surrounded, surround, surroundings_of

    for part in system.parts.values():
        if part.is_sum or isinstance(part.instance, DirectInstance):
            continue
        source = find_source(part.fmu, system.rig.components[part.name].scope.folder)
        if isinstance(source, ComponentSource) and is_surrounded(source):
            values = {name: given.value for name, given in part.given.items()}
            surround(part.instance, surroundings_of(source, values) or NOTHING)


def in_python(system: System) -> dict[str, list[str]]:
    """Return the components in process that no C can carry, by reason; nothing is compiled.

    What stands in an FMU has a carrier of its own, and is left out.
    """
    from .carriers import why_python

    found: dict[str, list[str]] = {}
    for part in system.parts.values():
        if not isinstance(part.instance, DirectInstance):
            continue
        given = {name: each.value for name, each in part.given.items()}
        if why := why_python(type(part.instance.component), given):
            found.setdefault(why, []).append(part.name)
    return found


def _carry(system: System, part: Part, weather: bool) -> str:
    """Let a native FMU carry a component; return why if there is none."""
    from seatrial.fmi.compiler import require_compiler
    from seatrial.fmi.loading.load import load_fmu, open_instance

    from .cached import native_fmu
    from .surroundings import is_surrounded, surround, surroundings_of

    source = find_source(part.fmu, system.rig.components[part.name].scope.folder)
    assert isinstance(source, ComponentSource)
    require_compiler()
    values = {name: given.value for name, given in part.given.items()}
    try:
        around = None if weather else surroundings_of(source, values)
        surrounded = is_surrounded(source) if weather else around is not None
        fmu = load_fmu(native_fmu(source, values, surrounded=surrounded))
    except InputError as error:
        return str(error)
    part.instance.free()
    part.instance, part.sha256 = open_instance(fmu, part.name), fmu.sha256
    if around:
        surround(part.instance, around)
    return ""
