"""What a trial says of its rig's signals, checked against the assembled rig before it runs."""

from __future__ import annotations

from ..component import seconds
from ..cosim.recorder import matching
from ..cosim.system import System, settable
from ..cosim.values import from_written, port_scalars
from ..errors import InputError, unknown
from .trial import Trial


def check_events(trial: Trial, system: System) -> None:
    """Raise InputError for an event that could not be applied when its time comes."""
    wired = {wire.target for wire in system.wires}
    for event in trial.events():
        where = f"{trial.read_from.path}: event at {seconds(event.at_ns):g} s: {event.action}"
        component, _, port = event.key.partition(".")
        if component not in system.parts:
            raise InputError(f"{where}: {unknown('component', component, system.parts)}")
        part = system.parts[component]
        scalars = port_scalars(part.instance.variables, port)
        connected = [(component, v.name) in wired for v in scalars]
        if event.action == "set":
            scalars = settable(part.instance.variables, port, f"{where}: {component}")
            if any(connected):
                raise InputError(f"{where}: {event.key} is fed by a wire; use override")
            if scalars[0].causality == "parameter" and scalars[0].variability != "tunable":
                raise InputError(f"{where}: {event.key} is fixed and cannot change during a run")
        elif not scalars or not (all(connected) or scalars[0].causality == "output"):
            raise InputError(
                f"{where}: {event.key} is neither an output nor an input that is wholly connected"
            )
        if event.action != "release":
            from_written(event.written, scalars, part.presets.get(port, {}), where)


def check_criteria(trial: Trial, system: System) -> dict[str, str]:
    """Return the signals' units; raise InputError if a criterion does not fit them."""
    outputs = {
        f"{name}.{v.name}": v
        for name, part in system.parts.items()
        for v in part.instance.variables.values()
        if v.causality == "output"
    }
    units = {name: variable.unit for name, variable in outputs.items()}
    try:
        matching(list(units), trial.file.record.signals)
    except InputError as error:
        raise InputError(f"{trial.read_from.path}: record.signals: {error}") from None
    for name, criterion in trial.criteria:
        where = f"{trial.read_from.path}: criterion {name!r}"
        try:
            for signal in criterion.signals:
                if signal not in units:
                    raise InputError(unknown("signal", signal, units))
                if outputs[signal].type is str:
                    raise InputError(f"{signal} is a text, a number is needed")
            criterion.check_units(units)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
    return units
