"""Vehicle files with identified parameters, for a rig's ``parameters``."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number
from seatrial.system.parameters import Vehicle, VehicleFile, load_vehicle
from seatrial.system.references.entries import DerivedEntry, Entry, WrittenEntry

from .planar_study import PlanarStudy
from .study import Physical, Study

VARIANT = "identified"

_FORCE = ("kg", "N.s/m", "N.s2/m2")
_PORTS = {
    axis: (f"added_mass.{x + x}", f"linear_damping_force.{u}", f"quadratic_damping_force.{u}")
    for axis, x, u in (("surge", "x", "u"), ("sway", "y", "v"), ("heave", "z", "w"))
} | {"yaw": ("added_inertia.zz", "linear_damping_moment.r", "quadratic_damping_moment.r")}
"""Scalars of a craft in six degrees of freedom that an axis decides: added mass and drags."""
_UNITS = {True: ("kg.m2", "N.m.s/rad", "N.m.s2/rad2"), False: _FORCE}
_SAME_DRAG = {"point-drag", "morison"}
"""Terms with drag along all axes; ``crossflow-drag`` has it across the bow."""

_NO_LAG = 1e-3
"""Time constant that is written where none was found, s."""


def identified_entries(study: Study | PlanarStudy) -> dict[str, dict[str, Entry]]:
    """Return the parameters by component table and scalar name, deviations in ``source``.

    Added mass and drag of the axis; with ``result.thruster``, that table's delay and time
    constant, or, of turns, the mean of both thrusters' full thrust.
    """
    result = study.experiment.file.result
    if isinstance(study, PlanarStudy):
        tables = {result.component: _of_sway(study)}
        if result.thruster is not None:
            tables[result.thruster] = _full_thrust(study)
        return tables
    tables = {result.component: _of_the_craft(study)}
    if result.thruster is not None:
        tables[result.thruster] = _of_the_thruster(study)
    return tables


def _of_the_craft(study: Study) -> dict[str, Entry]:
    found = study.physical()
    names = _PORTS[study.experiment.file.axis]
    units = _UNITS[study.experiment.rotation]
    values = (found["added mass"], found["linear"], found["quadratic"])
    return {
        name: _physical(study, value, unit)
        for name, value, unit in zip(names, values, units, strict=True)
    }


def _of_the_thruster(study: Study) -> dict[str, Entry]:
    period, estimate = study.fitted.period, study.estimate
    if estimate.structure.lag == "thruster":
        lag = estimate.values["time_constant"]
        remark = f"standard deviation {number(estimate.deviation('time_constant'), 3)}"
    else:
        lag, remark = _NO_LAG, "no lag was found"
    return {
        "delay": _entry(study, study.delay, "s", f"in whole samples of {number(period, 6)} s"),
        "time_constant": _entry(study, lag, "s", remark),
    }


def _of_sway(study: PlanarStudy) -> dict[str, Entry]:
    found, known = study.fit, study.experiment.file.known.source
    values = {
        "mass": found.values["mass"] - study.dry_mass,
        "linear": found.values["linear"],
        "quadratic": found.values["quadratic"],
    }
    return {
        port: _entry(
            study,
            values[name],
            unit,
            f"standard deviation {number(found.deviation(name), 3)}; surge and yaw: "
            f"{study.known_from}; arm: {known}",
        )
        for port, name, unit in zip(_PORTS["sway"], values, _FORCE, strict=True)
    }


def _full_thrust(study: PlanarStudy) -> dict[str, Entry]:
    first, second = (study.fit.values[name] for name in ("thrust_1", "thrust_2"))
    remark = f"mean of port, {number(first, 4)} N, and starboard, {number(second, 4)} N"
    return {"full_thrust": _entry(study, (first + second) / 2, "N", remark)}


def _physical(study: Study, value: Physical, unit: str) -> Entry:
    known = study.experiment.file.known.source
    remark = f"standard deviation {number(value.deviation, 3)}; thrust and mass: {known}"
    return _entry(study, value.value, unit, remark)


def _entry(study: Study | PlanarStudy, value: float, unit: str, remark: str) -> Entry:
    source = f"identified from {study.log_path.name}, {study.experiment.file.axis}: {remark}"
    return Entry(value=value, unit=unit, source=source, mark="identified")


def base_vehicle(study: Study | PlanarStudy) -> Vehicle | None:
    """Return the vehicle that the result is added to, if one is named. Raises InputError."""
    result, path = study.experiment.file.result, study.experiment.read_from.path
    if result.vehicle is None:
        return None
    vehicle = load_vehicle(result.vehicle, path.parent)
    for key, table in (("component", result.component), ("thruster", result.thruster)):
        if table is not None and table not in vehicle.file.components:
            what = unknown("component table", table, vehicle.file.components)
            raise InputError(f"{path}: result.{key}: {what} in {vehicle.read_from.path}")
    if result.variant is not None and result.variant not in vehicle.file.variants:
        what = unknown("variant", result.variant, vehicle.file.variants)
        raise InputError(f"{path}: result.variant: {what} in {vehicle.read_from.path}")
    _check_drag(study, vehicle)
    return vehicle


def _check_drag(study: Study | PlanarStudy, vehicle: Vehicle) -> None:
    """Raise InputError if a term beside linear and quadratic drag has the axis' drag, too.

    What is identified is all of the drag along the axis: the result would have it twice.
    """
    file, path = study.experiment.file, study.experiment.read_from.path
    result, variants = file.result, vehicle.file.variants
    other = _SAME_DRAG if file.axis == "surge" else _SAME_DRAG | {"crossflow-drag"}

    def twice(variant: str | None) -> list[str]:
        own = vehicle.file.components.get(result.component, {})
        changes = variants.get(variant or "", {}).get(result.component, {})
        terms = {**own, **changes}.get("terms")
        return sorted(other & set(str(terms.value).split())) if terms is not None else []

    chosen = result.variant or vehicle.file.default
    if found := twice(chosen):
        without = [name for name in variants if not twice(name)]
        raise InputError(
            f"{path}: result.variant: {chosen or 'the vehicle itself'} of "
            f"{vehicle.read_from.name} has {file.axis} drag by {' and '.join(found)}, too, and "
            f"what is identified is all of it; variants without: {', '.join(without) or 'none'}"
        )


def write_vehicle(study: Study | PlanarStudy, vehicle: Vehicle | None, path: Path) -> None:
    """Write a vehicle file: ``vehicle`` with the variant `VARIANT`, which is the default.

    The variant is that of the experiment's ``result.variant``, or the vehicle's default, with
    what was identified in the place of its own values; so one axis can be added to another's
    file. Without a vehicle the file has the identified parameters alone.
    """
    tables = identified_entries(study)
    if vehicle is None:
        title = f"Identified from {study.log_path.name}"
        components: dict[str, dict[str, WrittenEntry]] = {t: {**e} for t, e in tables.items()}
        file = VehicleFile(title=title, source=title, components=components)
    else:
        chosen = study.experiment.file.result.variant or vehicle.file.default
        changes = dict(vehicle.file.variants.get(chosen, {})) if chosen else {}
        for table, entries in tables.items():
            changes[table] = {**changes.get(table, {}), **entries}
        variants = {**vehicle.file.variants, VARIANT: changes}
        file = vehicle.file.model_copy(update={"variants": variants, "default": VARIANT})
    write_whole(path, "\n".join(_lines(file)) + "\n")


def _lines(file: VehicleFile) -> Iterator[str]:
    yield f"title = {_text(file.title)}"
    yield f"source = {_text(file.source)}"
    if file.default is not None:
        yield f"default = {_text(file.default)}"
    for table, entries in file.components.items():
        yield from table_lines((table,), entries)
    for variant, tables in file.variants.items():
        yield from ("", f"[variants.{_key(variant)}]")
        for table, entries in tables.items():
            yield from table_lines(("variants", variant, table), entries)
    for table, ports in file.presets.items():
        for port, presets in ports.items():
            yield from table_lines(("presets", table, port), presets)


def table_lines(path: Sequence[str], entries: Mapping[str, WrittenEntry]) -> Iterator[str]:
    """Yield the lines of a table of entries, an empty one first; ``path`` are its keys."""
    yield from ("", f"[{'.'.join(map(_key, path))}]")
    for name, entry in entries.items():
        written = entry.model_dump(exclude_none=True)
        if isinstance(entry, DerivedEntry) and not entry.source:
            del written["source"]
        keys = ", ".join(f"{key} = {_value(value)}" for key, value in written.items())
        yield f"{_key(name)} = {{ {keys} }}"


def _value(value: str | float | int | list[Any]) -> str:
    return f"[{', '.join(map(_scalar, value))}]" if isinstance(value, list) else _scalar(value)


def _scalar(value: str | float | int) -> str:
    return _text(value) if isinstance(value, str) else repr(value)


def _key(name: str) -> str:
    return name if name.replace("-", "").replace("_", "").isalnum() else _text(name)


def _text(text: str) -> str:
    # JSON's text is TOML's: the same escapes, but for DEL, which TOML wants escaped too.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
