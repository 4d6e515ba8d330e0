"""Run folders as logs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seatrial.trial.logs.channels import Log, channel
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column
from seatrial.trial.records.run_folder import MANIFEST, SIGNALS, Run, load_run

_OF_CRAFT = {
    "north": "position.x",
    "east": "position.y",
    "depth": "position.z",
    "heading": "attitude.psi",
    "roll": "attitude.phi",
    "pitch": "attitude.theta",
}


def _read(path: Path, _: Column | None) -> Log:
    """Return the record of a run: the numbers, in their units, of a played log where it has them.

    Raises InputError as `load_run`.
    """
    run = load_run(path)
    rows = np.arange(2, len(run.time) + 2)
    numbers = {name: values for name, values in run.signals.items() if not isinstance(values, list)}
    channels = {}
    for name, values in numbers.items():
        known = known_rows(run, name)
        time, at = (run.time, rows) if known.all() else (run.time[known], rows[known])
        if len(time):
            values = values if known.all() else np.asarray(values)[known]
            channels[name] = channel(name, run.units[name], time, values, at)
    table = all(each.time is run.time for each in channels.values())
    served = {**of_craft(channels), **_said(run, channels)}
    return Log(path / SIGNALS, channels, served, notes=run.notes, row="line", table=table)


def known_rows(run: Run, name: str) -> NDArray[np.bool_]:
    """Return the rows (n,) at which the value of a signal is known, all without a switch."""
    switch = next((each for each in switches(name) if each in run.signals), None)
    if switch is None:
        return np.ones(len(run.time), np.bool_)
    return np.asarray(run.signals[switch], np.bool_)


def switches(name: str) -> tuple[str, str]:
    """Return the signals that may say where that of an imported, or a played, log is known."""
    component, _, port = name.partition(".")
    return f"{component}.known.{port}", f"{name}_valid"


def _said(run: Run, names: Iterable[str]) -> dict[str, list[str]]:
    """Return the signals that serve quantities in the record of an imported log."""
    there = set(names)
    said = run.manifest.get("log", {}).get("serves", {})
    return {what: [name] for what, name in said.items() if name in there}


def of_craft(names: Iterable[str]) -> dict[str, list[str]]:
    """Return the signals of a run that serve quantities: the true motion of its craft, in order."""
    there = list(names)
    crafts = [name.removesuffix(".attitude.psi") for name in there
              if name.endswith(".attitude.psi")]  # fmt: skip
    return {
        what: [name for craft in crafts if (name := f"{craft}.{port}") in there]
        for what, port in _OF_CRAFT.items()
    }


RUN = Format("run folder", lambda path, _: (path / MANIFEST).is_file(), _read)
