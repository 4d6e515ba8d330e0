"""Manoeuvre of a run folder: its record of the true motion, and its orders."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import Run

from .evaluation import Done
from .figures.record import Array, Record

COMPONENT = "manoeuvre"
_LENGTHS = ("length", "outline", "hull_size.x", "hull_length")
"""Where the length of a craft is, the best first: parameters, and that of its outline."""


def has_component(run: Run) -> bool:
    """Return whether a manoeuvre's component has run: not so in imported logs, nor of a shadow."""
    return _manoeuvre(run) is not None


def has_manoeuvre(run: Run) -> bool:
    """Return whether a run has a manoeuvre that was begun, with a record of it."""
    name = _manoeuvre(run)
    return name is not None and f"{name}.phase" in run.signals and bool(_orders(run, name))


def done_in(run: Run) -> Done:
    """Return the manoeuvre of a run.

    Positions and angles are those of the craft's origin; the helm is that ordered, in rad of
    ``full_helm``. Raises InputError for a run without manoeuvre or its record, one that was not
    begun, and one with several craft.
    """
    name = _manoeuvre(run)
    if name is None:
        raise InputError(f"{run.folder}: no component {COMPONENT} has run")
    orders = _orders(run, name)
    if not orders:
        raise InputError(f"{run.folder}: the manoeuvre was not begun: its approach was not steady")
    values = {key: each["value"] for key, each in _entry(run, name)["parameters"].items()}
    craft = _craft(run)
    depth = None
    if values["kind"] == "depth-step":
        depth = float(values["depth_start"]) + float(values["depth_change"])
    measured = {
        "roll": run.signals.get(f"{craft}.attitude.phi"),
        "pitch": run.signals.get(f"{craft}.attitude.theta"),
        "power": run.signals.get(f"{name}.total_power"),
        "pull": run.signals.get(f"{name}.pull"),
    }
    record = Record(
        run.time,
        _signal(run, f"{craft}.position.x"),
        _signal(run, f"{craft}.position.y"),
        _signal(run, f"{craft}.attitude.psi"),
        _signal(run, f"{name}.helm_order") * float(values["full_helm"]),
        depth=run.signals.get(f"{craft}.position.z"),
        # What a model does not have, or no connection brings, is 0.
        **{key: value for key, value in measured.items() if value is not None and value.any()},
    )
    return Done(
        values["kind"],
        record,
        orders,
        heading=float(values["heading_change"]),
        share=float(values["slow"]),
        depth=depth,
        length=_length(_entry(run, craft)),
        helm=min(float(values["helm"]), float(values["full_helm"])),
        full_helm=float(values["full_helm"]),
        window=float(values["window"]),
        side=str(values["side"]),
        criteria=str(values["criteria"]),
        beam=_entry(run, craft).get("outline", {}).get("beam"),
    )


def _manoeuvre(run: Run) -> str | None:
    components = run.manifest["components"].items()
    return next((name for name, entry in components if entry["fmu"] == COMPONENT), None)


def _orders(run: Run, name: str) -> tuple[float, ...]:
    """Return the times at which orders were given, s: the first exactly, others at their rows."""
    phase = _signal(run, f"{name}.phase")
    given = np.flatnonzero(np.diff(phase) > 0) + 1
    if not len(given):
        return ()
    first = float(_signal(run, f"{name}.order_time")[given[0]])
    return first, *run.time[given[1:]].tolist()


def _signal(run: Run, name: str) -> Array:
    if name not in run.signals:
        raise InputError(f"{run.folder}: {name} is not recorded")
    return np.asarray(run.signals[name], np.float64)


def _craft(run: Run) -> str:
    found = [name.removesuffix(".position.x") for name in run.signals
             if name.endswith(".position.x")]  # fmt: skip
    craft = [name for name in found if f"{name}.attitude.psi" in run.signals]
    if len(craft) != 1:
        raise InputError(
            f"{run.folder}: the motion of one craft is needed in the record, found "
            f"{', '.join(craft) or 'none'}"
        )
    return craft[0]


def _entry(run: Run, name: str) -> Mapping[str, Any]:
    entry: Mapping[str, Any] = run.manifest["components"][name]
    return entry


def _length(craft: Mapping[str, Any]) -> float | None:
    # Those of the vehicle's file have a mark: the component's own start values tell nothing of it.
    found = {name: each["value"] for name, each in craft["parameters"].items() if each.get("mark")}
    found["outline"] = craft.get("outline", {}).get("length")
    for name in _LENGTHS:
        value = found.get(name)
        if isinstance(value, float) and value > 0.0:
            return value
    return None
