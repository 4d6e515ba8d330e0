"""Replay: what the vehicle's pilot and actuators make of recorded orders."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from seatrial.errors import InputError, SimulationError, unknown
from seatrial.model.component import NS
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
    """Inputs of a craft over time: ``time`` (n,), s, and ``values`` (n, m), linear between."""

    time: Vector
    values: Vector


def craft_of(vehicle: str, variant: str | None) -> Craft:
    """Return the craft of a vehicle. Raises InputError for what is wrong in its files."""
    with _started(vehicle, variant, None) as (system, _):
        return craft_in(system)


def inputs_of(craft: Craft, vehicle: str, variant: str | None, run: Pass) -> Inputs:
    """Return the inputs of the craft during a pass, as its equations take them.

    Orders that are inputs of the craft act directly. Yaw and speed go to the vehicle's pilot in
    its mode ``manual``, held to -1 to 1; what pilot and actuators make of them reaches the craft,
    at the steps of the vehicle's rig.

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
    time, replayed = run.record.time, np.zeros((len(run.record.time), len(craft.fed)))
    direct = [name for name in run.orders if name in names]
    lacking = [name for name in craft.fed if name not in direct]
    if YAW in run.orders and SPEED in run.orders:
        time, replayed = _replayed(craft, vehicle, variant, run)
    elif lacking and not direct:
        lacking_order = SPEED if YAW in run.orders else YAW
        raise InputError(
            f"{run.path}: the order {lacking_order} is needed: --columns {lacking_order}=NAME or "
            f"{lacking_order}=NUMBER; or orders to {craft.name}: {', '.join(craft.fed)}"
        )
    elif lacking:
        raise InputError(
            f"{run.path}: orders to all inputs of {craft.name} are needed, "
            f"{', '.join(lacking)} lack: --columns {lacking[0]}=NAME or {lacking[0]}=NUMBER"
        )
    values = np.zeros((len(time), len(names)))
    values[:, [names.index(name) for name in craft.fed]] = replayed
    for name in direct:
        values[:, names.index(name)] = np.interp(time, run.record.time, run.orders[name])
    return Inputs(time, values)


def _replayed(craft: Craft, vehicle: str, variant: str | None, run: Pass) -> tuple[Vector, Vector]:
    """Return times (n,) and what reaches the inputs (n, fed) of the craft then."""
    time = run.record.time - run.record.start + _SETTLING
    yaw, surge = (np.clip(run.orders[name], -1.0, 1.0) for name in (YAW, SPEED))
    rows = [(0.0, surge[0], yaw[0]), *zip(time, surge, yaw, strict=True)]
    # A step beyond the end is asked for.
    rows.append((float(time[-1]) + _BEYOND, surge[-1], yaw[-1]))
    at: list[float] = []
    reached: list[list[float]] = []
    with _started(vehicle, variant, _Orders(rows, run.is_held)) as (system, master):
        while not at or at[-1] < time[-1]:
            at.append(master.time)
            reached.append(master.values(craft.name, craft.fed))
            _advance(master, run)
    shown = np.searchsorted(at, _SETTLING)
    # What reaches the craft at t holds until the next step: it is the value of that step's middle.
    middles = np.array(at[shown:]) + 0.5 * system.rig.step_ns / NS
    return middles - _SETTLING + run.record.start, np.array(reached[shown:])


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
