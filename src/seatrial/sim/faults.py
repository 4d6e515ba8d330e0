"""Faults as written, resolved against an assembled system: what they act on, in its units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

from ..errors import InputError, unknown
from ..fmi.instance import Variable
from ..model.component import NS, seconds
from ..model.faults import operators
from ..model.faults.catalogue import FAILURES, kinds
from ..model.faults.operators import Draw, Operator, drawing
from ..model.faults.text import fault_text
from ..system.fault_entry import FaultEntry, check_entry
from ..system.references.values import port_names, port_scalars
from ..system.rig import duration_ns
from ..system.system import System
from .fault_schedule import Fault, Stepped
from .fault_settings import Settings
from .streams import Stream, is_stream

Target = tuple[str, Variable]
"""A component and one of its variables."""


def resolved(system: System, entry: FaultEntry, number: int, now_ns: int, origin: str) -> Fault:
    """Return the fault that an entry means, the ``number``-th of its run, from ``now_ns`` on.

    Raises InputError, naming ``origin``, for anything that does not fit.
    """
    check_entry(entry, origin)
    begin = now_ns if entry.at is None else duration_ns(entry.at, f"{origin}.at")
    lasts = None if entry.for_ is None else duration_ns(entry.for_, f"{origin}.for")
    grows = 0 if entry.grows_over is None else duration_ns(entry.grows_over, f"{origin}.grows_over")
    if lasts is not None and lasts <= 0:
        raise InputError(f"{origin}.for: {entry.for_!r} is no time: leave it out for good")
    acts: list[tuple[str, str, Operator]] = []
    components: list[str] = []
    for place in entry.places:
        found = _located(system, place, origin)
        on = _what_it_acts_on(system, entry, found, place, origin)
        if on == "component":
            components += [component for component, _ in found]
        elif on in ("device", "measurement", "bus"):
            acts += _of_devices(system, entry, found, begin, grows, origin)
        else:
            for component, scalars in found:
                _refuse_fixed(system, component, scalars, place, origin)
                acts += _of_signals(system, entry, component, scalars, number, origin)
    restarts = components if entry.what in ("crash", "power-loss") and lasts is not None else []
    for component in restarts:
        if not system.parts[component].instance.restarts:
            raise InputError(f"{origin}.for: {component} cannot start anew: leave `for` out")

    def acts_on(master: Stepped) -> list[tuple[str, str, Operator]]:
        whole = [
            each
            for component in components
            for each in _of_component(master, entry.what, component, f"{number}")
        ]
        return [*acts, *whole]

    end = None if lasts is None else begin + lasts
    key = f"{number}: {entry.what}"
    return Fault(key, begin, end, grows, acts_on, tuple(restarts))


def components_of(system: System, entry: FaultEntry, origin: str) -> set[str]:
    """Return the components that a fault acts on. Raises InputError."""
    located = (each for place in entry.places for each in _located(system, place, origin))
    return {component for component, _ in located}


def _located(system: System, place: str, origin: str) -> list[tuple[str, list[Variable]]]:
    """Return the components that a place means, with the scalars; all of a whole component."""
    where = f"{origin}.where"
    if place in system.parts:
        return [(place, [])]
    if "." not in place:
        system.located(f"{place}.", where)  # says which components there are
    found = []
    for part, port in system.located(place, where):
        variables = part.instance.variables
        scalars = port_scalars(variables, port) or _of_axis(variables, port)
        if not scalars:
            known = port_names(variables)
            raise InputError(f"{where}: {part.name}: {unknown('port', port, known)}")
        found.append((part.name, scalars))
    return found


def _of_axis(variables: Any, axis: str) -> list[Variable]:
    """Return the input of faults of one node of a bus: ``can.n2`` for ``can.fault.n2``."""
    return [variables[name] for name in variables.of_role("fault") if name.endswith(f".{axis}")]


def _what_it_acts_on(
    system: System,
    entry: FaultEntry,
    found: Sequence[tuple[str, list[Variable]]],
    place: str,
    origin: str,
) -> str:
    """Return on which of `catalogue.On` the fault acts here. Raises InputError."""
    kind = kinds()[entry.what]
    component, scalars = found[0]
    if not scalars:
        device = system.parts[component].instance.variables.of_role("fault")
        for on in ("measurement" if entry.of else "device", "component"):
            if on in kind.on and (on == "component" or len(device) == 1):
                return on
        whole = [name for name, one in kinds().items() if "component" in one.on]
        if len(device) == 1:
            whole = [*FAILURES, *whole]
        hint = "; with `of`, one of its measurements" if "measurement" in kind.on and device else ""
        raise InputError(
            f"{origin}.where: {entry.what} acts on a port, {place}.PORT{hint}; a whole {place} "
            f"takes {', '.join(whole)}"
        )
    if entry.of:
        raise InputError(f"{origin}.of: {place} is a port already; write the component alone")
    if scalars[0].role == "fault":
        inputs = system.parts[component].instance.variables.of_role("fault")
        role = "device" if len(inputs) == 1 else "bus"
        if role not in kind.on:
            takes = ", ".join(name for name, one in kinds().items() if role in one.on)
            raise InputError(f"{origin}.what: {place} takes {takes}, found {entry.what}")
        return role
    for on in ("signal", "stream"):
        if on in kind.on:
            return on
    raise InputError(
        f"{origin}.where: {entry.what} acts on a whole {' or '.join(kind.on)}, found {place}"
    )


def _refuse_fixed(
    system: System, component: str, scalars: Sequence[Variable], place: str, origin: str
) -> None:
    first = scalars[0]
    if (component, first.name) in {one.target for one in system.initial}:
        raise InputError(f"{origin}.where: {place} has its value from the start, it cannot change")
    changes = first.causality in ("output", "input") or first.variability == "tunable"
    if not changes:
        raise InputError(
            f"{origin}.where: {place} is neither an output nor an input nor a tunable parameter"
        )


# ---------------------------------------------------------------------- signals, streams


def _of_signals(
    system: System,
    entry: FaultEntry,
    component: str,
    scalars: list[Variable],
    number: int,
    origin: str,
) -> list[tuple[str, str, Operator]]:
    presets = system.parts[component].presets
    settings = Settings(entry, scalars, origin, presets)
    acts = []
    for index, variable in enumerate(scalars):
        draw = drawing(system.seed, f"{number}/{entry.what}/{component}.{variable.name}")
        make = _stream if "stream" in kinds()[entry.what].on else _signal
        acts.append((component, variable.name, make(settings, index, variable, draw)))
    return acts


_OF_ANY = ("fixed", "stuck", "dropout", "delay")
"""Faults of texts and truth values too; the others are of numbers."""


def _signal(settings: Settings, index: int, variable: Variable, draw: Draw) -> Operator:
    """Return the operator of one scalar. Raises InputError."""
    what = settings.entry.what
    if (make := kinds()[what].make) is not None:
        if variable.type is not float:
            raise settings.refused("what", f"{what} is of real numbers, {variable.name} is none")
        return cast(Operator, make(settings, index, draw))
    if (
        variable.type not in (float, int)
        and what not in _OF_ANY
        and not (variable.type is bool and what == "bias")
    ):
        raise settings.refused("what", f"{what} is of numbers, {variable.name} is none")
    match what:
        case "fixed":
            return operators.Fixed(settings.exactly("value", index))
        case "bias":
            made: Operator = operators.Bias(settings.level("value", index))
        case "drift":
            made = operators.Drift(settings.rate("rate", index))
        case "scale":
            return operators.Scale(settings.number("factor"))
        case "noise":
            made = operators.Noise(settings.every(), draw, settings.level("value", index))
        case "deviation":
            made = operators.Deviation(settings.coefficients())
        case "stuck":
            return operators.Stuck()
        case "dropout":
            return operators.Dropout(settings.every(), draw, settings.probability())
        case "garbage":
            return operators.Garbage(settings.every(), draw, *settings.ends(index))
        case "delay":
            return operators.Delay(settings.duration("time"))
        case "lag":
            return operators.Lag(seconds(settings.duration("time")))
        case "rate-limit":
            return operators.Slow(settings.rate("rate", index, positive=True))
        case "limit":
            return operators.Limit(*settings.ends(index))
        case "runaway":
            rate = settings.rate("rate", index, positive=True)
            return operators.Runaway(settings.level("value", index), rate)
        case _:
            if variable.type is not float:
                raise settings.refused("what", f"nan is of real numbers, {variable.name} is none")
            return operators.NotANumber()
    range_ = settings.range()
    return operators.Wrapped(made, *range_) if range_ else made


def _stream(settings: Settings, index: int, variable: Variable, draw: Draw) -> Operator:
    if variable.type is not str:
        what = settings.entry.what
        raise settings.refused("what", f"{what} is of streams, {variable.name} is no text")
    match settings.entry.what:
        case "loss":
            return Stream(draw, loss=settings.probability())
        case "latency":
            time, jitter = settings.duration("time", 0), settings.duration("jitter", 0)
            if not time and not jitter:
                raise settings.refused("time", "latency needs a time or a jitter above 0")
            return Stream(draw, time_ns=time, jitter_ns=jitter)
        case "reorder":
            return Stream(draw, reorder=settings.probability(), held_ns=settings.duration("time"))
        case "duplicate":
            return Stream(draw, duplicate=settings.probability())
        case _:
            return Stream(draw, bit_errors=settings.probability())


# ---------------------------------------------------------------------- devices, components


def _of_devices(
    system: System,
    entry: FaultEntry,
    found: Sequence[tuple[str, list[Variable]]],
    begin_ns: int,
    grows_ns: int,
    origin: str,
) -> list[tuple[str, str, Operator]]:
    """Return what writes the fault, as a text, to the inputs of devices that take faults."""
    acts: list[tuple[str, str, Operator]] = []
    for component, scalars in found:
        variables = system.parts[component].instance.variables
        inputs = [v.name for v in scalars] or variables.of_role("fault")
        text = entry.what
        if entry.of is not None:
            measured = port_scalars(variables, entry.of)
            if not measured or not port_scalars(variables, f"{entry.of}_noise"):
                known = [
                    name.removesuffix("_noise")
                    for name in variables.ports | dict(variables)
                    if name.endswith("_noise")
                ]
                raise InputError(
                    f"{origin}.of: {component} measures {', '.join(known) or 'nothing'}, "
                    f"found {entry.of!r}"
                )
            presets = system.parts[component].presets
            settings = Settings(entry, measured, origin, presets)
            text = fault_text(
                entry.what, entry.of, settings.numbers(), begin_ns / NS, grows_ns / NS
            )
        elif entry.settings:
            key = next(iter(entry.settings))
            raise InputError(
                f"{origin}.{key}: of a whole {component}, {entry.what} takes no settings; "
                f"write {component}.PORT for one of its ports"
            )
        acts += [(component, name, operators.Fixed(text)) for name in inputs]
    return acts


def _of_component(
    master: Stepped, what: str, component: str, name: str
) -> list[tuple[str, str, Operator]]:
    """Return what becomes of all outputs and connected inputs of a component."""
    variables = master.system.parts[component].instance.variables
    fed = master.system.feeders(component)
    acts: list[tuple[str, str, Operator]] = []
    for variable in variables.values():
        is_output = variable.causality == "output"
        if what == "nan":
            if is_output and variable.type is float:
                acts.append((component, variable.name, operators.NotANumber()))
        elif is_output or (variable.causality == "input" and variable.name in fed):
            acts.append((component, variable.name, _silent(master, component, variable, what)))
    return acts


def _silent(master: Stepped, component: str, variable: Variable, what: str) -> Operator:
    (value,) = master.values(component, [variable.name])
    if variable.type is str and is_stream(value):
        return Stream(drawing(0, "silence"), loss=1.0)
    dead = what == "power-loss" and variable.causality == "output" and variable.type is not str
    return operators.Fixed(variable.type()) if dead else operators.Stuck()
