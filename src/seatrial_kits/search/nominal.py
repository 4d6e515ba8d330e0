"""Nominal values of what varies: as a question says, else as the trial itself has them."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.model.units import conversion
from seatrial.trial.files.trial import Trial
from seatrial.trial.records import run_schema
from seatrial.trial.records.run_folder import MANIFEST
from seatrial.trial.records.run_schema import checked_json
from seatrial.trial.running.supervision import run_supervised
from seatrial_kits.campaigns.distributions import number_and_unit

from .asking import Asking
from .space import Space

NOMINAL = "nominal"
"""Folder of the run of the trial as it is."""


def written_nominal(written: Mapping[str, Any], space: Space, origin: str) -> dict[str, float]:
    """Return the values that a question says, in the units of the keys. Raises InputError."""
    nominal = {}
    for key, value in written.items():
        here = f"{origin}: nominal: {key}"
        if key not in space.keys:
            raise InputError(f"{origin}: nominal: {unknown('key', key, space.keys)}")
        place = space.keys.index(key)
        number = _in(space.units[place], value, here)
        if number is None:
            raise InputError(f"{here}: a number as in vary is needed, found {value!r}")
        nominal[key] = number
        low, high = space.ends[place]
        if not low <= nominal[key] <= high:
            raise InputError(f"{here}: from {low:.6g} to {high:.6g} is needed, found {value!r}")
    return nominal


def nominal_values(asking: Asking, written: Mapping[str, float]) -> tuple[np.ndarray, list[str]]:
    """Return the nominal values of all keys, and notes of those that are outside their ranges.

    Of these it is the end of the range.

    What is not ``written`` is as the trial has it: it is run once into a folder, whose manifest
    says so. Where that has no such parameter, it is the median. Raises SimulationError if the
    trial cannot be run as it is.
    """
    space, trial = asking.space, asking.asked.base
    found = space.quantiles(np.full((1, len(space.keys)), 0.5))[0]
    own = {} if set(written) == set(space.keys) else _own(asking)
    for i, (key, law) in enumerate(zip(space.keys, space.laws, strict=True)):
        said = written.get(key, own.get(key, _of_trial(trial, key)))
        if law.levels:
            found[i] = law.levels.index(said) if said in law.levels else found[i]
            continue
        number = _in(law.unit, said, f"{trial.name}: {key}")
        if number is not None:
            found[i] = number
    clipped = np.clip(found, *space.ends.T)
    notes = [
        f"the trial has {key} at {number:.6g} {unit}".rstrip()
        + f", outside its range: nominal is {end:.6g}"
        for key, unit, number, end in zip(space.keys, space.units, found, clipped, strict=True)
        if number != end
    ]
    return clipped, notes


def _own(asking: Asking) -> dict[str, str]:
    """Return the parameters of the trial as it is, as quantities."""
    folder = asking.folder / NOMINAL
    shutil.rmtree(folder, ignore_errors=True)  # of a question that was stopped
    run_supervised(asking.asked.base, folder, engine=asking.engine, hooks=asking.hooks)
    manifest = checked_json(folder / MANIFEST, run_schema.MANIFEST)
    return {
        f"{path}.{name}": f"{entry['value']!r} {'' if entry['unit'] == '1' else entry['unit']}"
        for path, component in manifest["components"].items()
        for name, entry in component["parameters"].items()
        if isinstance(entry["value"], (int, float))
    }


def _of_trial(trial: Trial, key: str) -> Any:
    """Return a key of the trial's own, such as seed or sea.height; None if it has none."""
    group, _, name = key.rpartition(".")
    entry = getattr(trial.file, group, None) if group else trial.file
    return getattr(entry, name, None)


def _in(unit: str, value: Any, origin: str) -> float | None:
    """Return a number or a quantity in a unit; a number without one is in the unit; None for text.

    Raises InputError for another dimension.
    """
    number, own = number_and_unit(str(value))
    if own is None or isinstance(value, bool):
        return None
    try:
        factor, offset = conversion(own or unit or "1", unit or own or "1")
    except InputError as error:
        raise InputError(f"{origin}: {error}") from None
    return number * factor + offset
