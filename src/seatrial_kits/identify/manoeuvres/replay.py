"""Replay: what the vehicle's pilot and actuators make of recorded orders."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from seatrial.errors import InputError, SimulationError, unknown
from seatrial.model.expressions import Vector
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.system import System

from .craft import Craft, craft_in
from .passes import SPEED, YAW, Pass

_BEYOND = 10.0
"""How long the last orders hold, s: longer than a step of the rig."""
_LARGEST = 1.05
"""Largest share of an order; measured ones overshoot a little and are held to 1."""
_SETTLING = 20.0
"""How long the first orders act before the record begins, s."""
_ALIKE = 1e-6
"""Difference of inputs, as a share of the largest, that is none."""
_RIG = """\
title = "Replay of recorded orders"
step  = {step}
[components]
vehicle = {{ rig = {vehicle} }}
{pilot}
[connections]
{connections}
"""
_PILOT = (
    'pilot = {{ rig = {pilot} }}\norders = {{ fmu = "orders.csv" }}',
    '"vehicle.sensors" = "pilot.sensors"\n"pilot.actuators" = "vehicle.actuators"\n'
    '"orders.surge" = "pilot.orders.manual.surge"\n"orders.yaw" = "pilot.orders.manual.yaw"',
)


@dataclass(frozen=True)
class Inputs:
    """Inputs of a craft over time: ``time`` (n,), s, and ``values`` (n, m)."""

    time: Vector
    values: Vector
    is_held: bool = False
    """Whether values stand until the next time; else they are linear between."""
    from_rest: bool = False
    """Whether the craft and its actuators were at rest before; else the first inputs acted."""

    def means(self, edges: Vector) -> Vector:
        """Return the means (m, g) of the inputs between edges (g + 1,): their impulse is kept."""
        time = np.union1d(self.time, edges)
        if self.is_held:
            last = np.maximum(np.searchsorted(self.time, time[:-1], side="right") - 1, 0)
            heights = self.values[last].T
        else:
            values = np.array([np.interp(time, self.time, column) for column in self.values.T])
            heights = (values[:, 1:] + values[:, :-1]) / 2.0
        areas = np.cumsum(np.diff(time) * heights, axis=1)
        whole = np.column_stack((np.zeros(len(heights)), areas))
        found: Vector = np.diff(whole[:, np.searchsorted(time, edges)], axis=1) / np.diff(edges)
        return found


def craft_of(vehicle: str, variant: str | None) -> Craft:
    """Return the craft of a vehicle. Raises InputError for what is wrong in its files."""
    with _started(vehicle, variant, None) as (system, _):
        return craft_in(system)


def inputs_of(craft: Craft, vehicle: str, variant: str | None, run: Pass) -> list[Inputs]:
    """Return the inputs that the craft may have had during a pass, as its equations take them.

    Orders that are inputs of the craft act directly. Yaw and speed go to the vehicle's pilot in
    its mode ``manual``, held to -1 to 1; what pilot and actuators make of them reaches the craft,
    held over the steps of the vehicle's rig. A record does not show the state of the actuators at
    its beginning: the first inputs are those of actuators that follow the first orders, the
    second, where they differ, of actuators that start from rest.

    Raises InputError for an order that is neither, for one beyond -1 to 1, and for inputs that
    nothing gives.
    """
    names = craft.model.u_names
    for name in run.orders:
        if name not in (YAW, SPEED, *names):
            known = [YAW, SPEED, *craft.fed]
            raise InputError(f"{run.path}: {unknown('order', name, known)}")
        most = float(np.abs(run.orders[name]).max())
        if name in (YAW, SPEED) and most > _LARGEST:
            raise InputError(
                f"{run.path}: {name}: shares from -1 to 1 are needed (helm of 35 deg is 1), found "
                f"{most:g}"
            )
    direct = [name for name in run.orders if name in names]
    lacking = [name for name in craft.fed if name not in direct]
    if YAW in run.orders and SPEED in run.orders:
        settled, rest = (
            _with_direct(craft, run, direct, _replayed(craft, vehicle, variant, run, settling))
            for settling in (_SETTLING, 0.0)
        )
        return [settled] if _is_alike(settled.values, rest.values) else [settled, rest]
    if lacking and not direct:
        lacking_order = SPEED if YAW in run.orders else YAW
        raise InputError(
            f"{run.path}: the order {lacking_order} is needed: --columns {lacking_order}=NAME or "
            f"{lacking_order}=NUMBER; or orders to {craft.name}: {', '.join(craft.fed)}"
        )
    if lacking:
        raise InputError(
            f"{run.path}: orders to all inputs of {craft.name} are needed, "
            f"{', '.join(lacking)} lack: --columns {lacking[0]}=NAME or {lacking[0]}=NUMBER"
        )
    replayed = np.zeros((len(run.record.time), len(craft.fed)))
    return [_with_direct(craft, run, direct, Inputs(run.record.time, replayed))]


def _is_alike(one: Vector, other: Vector) -> bool:
    rows = min(len(one), len(other))
    apart = np.abs(one[:rows] - other[:rows]).max()
    return bool(apart <= _ALIKE * np.abs(one).max())


def _with_direct(craft: Craft, run: Pass, direct: Sequence[str], replayed: Inputs) -> Inputs:
    """Return all inputs of the craft: those replayed, those that orders are, and zeros."""
    names, time = craft.model.u_names, replayed.time
    values = np.zeros((len(time), len(names)))
    values[:, [names.index(name) for name in craft.fed]] = replayed.values
    for name in direct:
        values[:, names.index(name)] = np.interp(time, run.record.time, run.orders[name])
    return replace(replayed, values=values)


def _replayed(
    craft: Craft, vehicle: str, variant: str | None, run: Pass, settling: float
) -> Inputs:
    """Return what reaches the inputs (n, fed) of the craft, after so long with the first orders."""
    time = run.record.time - run.record.start + settling
    yaw, surge = (np.clip(run.orders[name], -1.0, 1.0) for name in (YAW, SPEED))
    rows = list(zip(time, surge, yaw, strict=True))
    if settling:
        rows.insert(0, (0.0, surge[0], yaw[0]))
    # A step beyond the end is asked for.
    rows.append((float(time[-1]) + _BEYOND, surge[-1], yaw[-1]))
    at: list[float] = []
    reached: list[list[float]] = []
    with _started(vehicle, variant, _Orders(rows, run.is_held)) as (_, master):
        while not at or at[-1] < time[-1]:
            at.append(master.time)
            reached.append(master.values(craft.name, craft.fed))
            _advance(master, run)
    shown = np.searchsorted(at, settling)
    return Inputs(
        np.array(at[shown:]) - settling + run.record.start,
        np.array(reached[shown:]),
        is_held=True,
        from_rest=not settling,
    )


def _advance(master: Master, run: Pass) -> None:
    try:
        master.step()
    except SimulationError as error:
        raise InputError(f"{run.path}: the orders cannot be replayed: {error}") from None


@dataclass(frozen=True)
class _Orders:
    """Rows of time, s, surge and yaw, shares, and whether they hold until the next one."""

    rows: list[tuple[float, float, float]]
    are_held: bool

    def write(self, path: Path) -> None:
        """Write them as a table of values over time."""
        kind = " [1 held]" if self.are_held else ""
        with path.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([("time", f"surge{kind}", f"yaw{kind}"), *self.rows])


@contextmanager
def _started(
    vehicle: str, variant: str | None, orders: _Orders | None
) -> Iterator[tuple[System, Master]]:
    """Start the vehicle, with its pilot where there are orders for it."""
    pilot, connections = ("", "") if orders is None else _PILOT
    text = _RIG.format(
        step=json.dumps(load_rig(f"vehicles/{vehicle}").file.step),
        vehicle=json.dumps(f"vehicles/{vehicle}"),
        pilot=pilot.format(pilot=json.dumps(f"pilots/{vehicle}")),
        connections=connections,
    )
    with TemporaryDirectory() as folder:
        path = Path(folder) / "replay.toml"
        path.write_text(text, encoding="utf-8")
        if orders is not None:
            orders.write(path.with_name("orders.csv"))
        system = assemble(load_rig(str(path)), "direct", variant=variant)
        try:
            if orders is not None:
                system.set("pilot.orders.mode", "manual", "replay")
                system.set("pilot.orders.armed", True, "replay")
            master = Master(system)
            master.initialise()
            yield system, master
            master.terminate()
        finally:
            system.free()
