"""Replay: what the vehicle's pilot and actuators make of recorded orders."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from seatrial.errors import InputError, SimulationError, unknown
from seatrial.model.expressions import Vector
from seatrial.sim.master import Master
from seatrial.system.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.system import System

from .craft import Craft, craft_in
from .passes import HELM, SPEED, Pass

STEP = 0.1
"""Communication step of the replay, s."""
_SETTLING = 20.0
"""How long the first orders act before the record begins, s."""
_RIG = """\
title = "Replay of recorded orders"
step  = "100 ms"
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


def craft_of(vehicle: str, variant: str | None) -> Craft:
    """Return the craft of a vehicle. Raises InputError for what is wrong in its files."""
    with _started(vehicle, variant, None) as (system, _):
        return craft_in(system)


def inputs_of(craft: Craft, vehicle: str, variant: str | None, run: Pass) -> Vector:
    """Return the inputs (n, m) of the craft at the rows of a pass, as its equations take them.

    Orders that are inputs of the craft act directly. Helm and speed go to the vehicle's pilot in
    its mode ``manual``: yaw is helm / full_helm, surge the speed order, held to -1 to 1, linear
    between rows; what pilot and actuators make of them reaches the craft, at steps of 0.1 s.

    Raises InputError for an order that is neither, and for inputs that nothing gives.
    """
    names = craft.model.u_names
    for name in run.orders:
        if name not in (HELM, SPEED, *names):
            known = [HELM, SPEED, *craft.fed]
            raise InputError(f"{run.path}: {unknown('order', name, known)}")
    values = np.zeros((len(run.record.time), len(names)))
    direct = [name for name in run.orders if name in names]
    lacking = [name for name in craft.fed if name not in direct]
    if HELM in run.orders and SPEED in run.orders:
        values[:, [names.index(name) for name in craft.fed]] = _replayed(
            craft, vehicle, variant, run
        )
    elif lacking and not direct:
        lacking_order = SPEED if HELM in run.orders else HELM
        raise InputError(
            f"{run.path}: the order {lacking_order} is needed: --columns {lacking_order}=NAME or "
            f"{lacking_order}=NUMBER; or orders to {craft.name}: {', '.join(craft.fed)}"
        )
    elif lacking:
        raise InputError(
            f"{run.path}: orders to all inputs of {craft.name} are needed, "
            f"{', '.join(lacking)} lack: --columns {lacking[0]}=NAME or {lacking[0]}=NUMBER"
        )
    for name in direct:
        values[:, names.index(name)] = run.orders[name]
    return values


def _replayed(craft: Craft, vehicle: str, variant: str | None, run: Pass) -> Vector:
    """Return what reaches the inputs (n, fed) of the craft at the rows."""
    time = run.record.time - run.record.start + _SETTLING
    yaw = np.clip(run.orders[HELM] / run.full_helm, -1.0, 1.0)
    surge = np.clip(run.orders[SPEED], -1.0, 1.0)
    rows = [(0.0, surge[0], yaw[0]), *zip(time, surge, yaw, strict=True)]
    rows.append((float(time[-1]) + 2.0 * STEP, surge[-1], yaw[-1]))
    at, reached = [], []
    with _started(vehicle, variant, rows) as (_, master):
        for _ in range(int(np.ceil(time[-1] / STEP - 1e-9)) + 1):
            at.append(master.time)
            reached.append(master.values(craft.name, craft.fed))
            try:
                master.advance(1)
            except SimulationError as error:
                raise InputError(f"{run.path}: the orders cannot be replayed: {error}") from None
    columns = np.array(reached, np.float64).T
    return np.column_stack([np.interp(time, at, column) for column in columns])


@contextmanager
def _started(
    vehicle: str, variant: str | None, rows: list[tuple[float, float, float]] | None
) -> Iterator[tuple[System, Master]]:
    """Start the vehicle, with its pilot where there are orders for it: time, surge and yaw."""
    pilot, connections = ("", "") if rows is None else _PILOT
    text = _RIG.format(
        vehicle=json.dumps(f"vehicles/{vehicle}"),
        pilot=pilot.format(pilot=json.dumps(f"pilots/{vehicle}")),
        connections=connections,
    )
    with TemporaryDirectory() as folder:
        path = Path(folder) / "replay.toml"
        path.write_text(text, encoding="utf-8")
        if rows is not None:
            with path.with_name("orders.csv").open("w", encoding="utf-8", newline="") as file:
                csv.writer(file).writerows([("time", "surge", "yaw"), *rows])
        system = assemble(load_rig(str(path)), "direct", variant=variant)
        try:
            if rows is not None:
                system.set("pilot.orders.mode", "manual", "replay")
                system.set("pilot.orders.armed", True, "replay")
            master = Master(system)
            master.initialise()
            yield system, master
            master.terminate()
        finally:
            system.free()
