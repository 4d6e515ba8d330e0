"""Checks of a trial's signals against the assembled rig, before it runs."""

from __future__ import annotations

from collections.abc import Mapping

from ...errors import InputError, unknown
from ...fmi.instance import Variable
from ...model.component import seconds
from ...sim.actions import action
from ...sim.fault_schedule import Fault
from ...sim.faults import resolved
from ...sim.recorder import matching
from ...system.system import System
from ..files.trial import Trial


def check_events(trial: Trial, system: System) -> None:
    """Raise InputError for an event that could not be applied when its time comes."""
    for event in trial.events():
        where = f"{trial.read_from.path}: event at {seconds(event.at_ns):g} s: set"
        action(system, "set", event.key, event.written, where)


def trial_faults(trial: Trial, system: System) -> list[Fault]:
    """Return the trial's faults. Raises InputError for one that does not fit."""
    found = []
    for index, entry in enumerate(trial.file.faults):
        where = f"{trial.read_from.path}: faults.{index}"
        fault = resolved(system, entry, index, trial.start_ns, where)
        if not trial.start_ns <= fault.begin_ns <= trial.stop_ns:
            raise InputError(f"{where}.at: {entry.at!r} is outside the trial's time")
        found.append(fault)
    return found


def _outputs(system: System) -> dict[str, Variable]:
    return {
        f"{name}.{v.name}": v
        for name, part in system.parts.items()
        for v in part.instance.variables.values()
        if v.causality == "output"
    }


def check_criteria(trial: Trial, system: System) -> dict[str, str]:
    """Return the signals' units; raise InputError if a criterion does not fit them."""
    outputs = _outputs(system)
    units = {name: variable.unit for name, variable in outputs.items()}
    try:
        matching(list(units), trial.file.record.signals)
    except InputError as error:
        raise InputError(f"{trial.read_from.path}: record.signals: {error}") from None
    for name, criterion in trial.criteria:
        where = f"{trial.read_from.path}: criterion {name!r}"
        try:
            for signal, kinds in criterion.kinds.items():
                for kind in sorted(kinds):
                    _REQUIRE[kind](signal, outputs)
            criterion.check_units(units)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
    return units


def check_plots(trial: Trial, system: System) -> None:
    """Raise InputError for a plot of signals that are not recorded or of unlike units."""
    outputs = _outputs(system)
    recorded = matching(list(outputs), trial.file.record.signals)
    for entry in trial.file.plots:
        where = f"{trial.read_from.path}: plot {entry.title!r}"
        try:
            for signal in entry.signals:
                _require_number(signal, outputs)
                if signal not in recorded:
                    raise InputError(f"{signal} is not recorded, see record.signals")
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
        if len({outputs[signal].unit for signal in entry.signals}) > 1:
            listed = ", ".join(f"{signal} in {outputs[signal].unit}" for signal in entry.signals)
            raise InputError(f"{where}: signals of one unit are needed, not {listed}")


def check_figures(trial: Trial, system: System) -> None:
    """Raise InputError for a figure of a signal that is no number."""
    outputs = _outputs(system)
    for signal in trial.figures:
        try:
            _require_number(signal, outputs)
        except InputError as error:
            raise InputError(f"figures: {error}") from None


def check_real_time(trial: Trial, system: System) -> None:
    """Raise InputError for a signal of ``real_time`` that is no number of its unit."""
    entry = trial.file.real_time
    if entry is None:
        return
    outputs = _outputs(system)
    for key, signal, unit in (("factor", entry.factor, "1"), ("paused", entry.paused, "s")):
        if not isinstance(signal, str):
            continue
        where = f"{trial.read_from.path}: real_time.{key}"
        try:
            _require_number(signal, outputs)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
        if (outputs[signal].unit or "1") != unit:
            raise InputError(
                f"{where}: {signal} is in {outputs[signal].unit}, a signal in {unit} is needed"
            )


def _require_number(signal: str, outputs: Mapping[str, Variable]) -> None:
    if signal not in outputs:
        raise InputError(unknown("signal", signal, outputs))
    if outputs[signal].type is str:
        raise InputError(f"{signal} is a text, a number is needed")


def _require_truth(signal: str, outputs: Mapping[str, Variable]) -> None:
    _require_number(signal, outputs)
    if outputs[signal].type is not bool:
        raise InputError(f"{signal} is a number: compare it, as in '{signal} > 0.5'")


def _require_text(signal: str, outputs: Mapping[str, Variable]) -> None:
    if signal not in outputs:
        texts = [name for name, variable in outputs.items() if variable.type is str]
        what, known = ("text signal", texts) if texts else ("signal", list(outputs))
        raise InputError(unknown(what, signal, known))
    if outputs[signal].type is not str:
        raise InputError(f"{signal} is no text: 'says' and 'is' need one")


_REQUIRE = {"number": _require_number, "truth": _require_truth, "text": _require_text}
