"""Passes: records of manoeuvres of one vehicle, with the orders that were given."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from seatrial.errors import InputError
from seatrial.model.expressions import Vector
from seatrial.trial.logs.channels import Log
from seatrial.trial.logs.formats import read_log
from seatrial.trial.logs.quantities import Column, Quantity, read_columns, series
from seatrial.trial.records.run_folder import MANIFEST, Run, load_run
from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.log_record import MOTION, record_of
from seatrial_kits.sea_trials.run_record import COMPONENT, done_in, has_component

YAW, SPEED = "yaw", "speed"
"""Orders to the pilot: helm, positive to turn to starboard, and speed, as shares of full ones."""
FULL_HELM = math.radians(35.0)
"""Helm, rad, that is full deflection in a log."""


@dataclass(frozen=True)
class Pass:
    """A manoeuvre that was done: its record, and the orders (n,) at its rows by name.

    Orders are `YAW` and `SPEED`, or inputs of the craft by scalar name, in their units.
    """

    path: Path
    record: Record
    orders: Mapping[str, Vector]
    is_held: bool = False
    """Whether orders hold until the next row, as those of a run do; else linear between."""
    notes: tuple[str, ...] = ()
    """What its log left out, for a person."""

    @property
    def name(self) -> str:
        """Short name for tables."""
        return self.path.name


def read_pass(path: Path, columns: Sequence[str], unit: Callable[[str], str]) -> Pass:
    """Return the pass in a run folder, or in a log.

    ``columns`` are texts WHAT=NAME[:UNIT] or WHAT=NUMBER; a WHAT that is no quantity of a record
    is an order, whose unit is ``unit(WHAT)``. The helm of the record over `FULL_HELM` is the order
    `YAW` where no other one steers. A run of a manoeuvre begins at the row before its first order.
    One into which a log has played (`seatrial shadow`) stands for that log, with the orders that
    played; one that was imported, too. Raises InputError as `read_log` does, for a run that is none
    of these, and for a log without orders.
    """
    played: list[str] = []
    if (path / MANIFEST).is_file():
        run = load_run(path)
        if run.manifest.get("log") is None or has_component(run):
            if columns:
                raise InputError(f"{path}: --columns is for logs: a run has its own")
            return _of_run(path)
        played = _played(run, columns)
    texts = [*played, *(part.strip() for text in columns for part in text.split(","))]
    own = [text for text in texts if text.partition("=")[0] in MOTION]
    others = [text for text in texts if text.partition("=")[0] not in MOTION]
    named = read_columns(own) if own else {}
    log = read_log(path, None, named.get("time"))
    record, notes = record_of(log, named)
    orders = {}
    for text in others:
        what, equals, written = text.partition("=")
        if not (equals and written):
            raise InputError(
                f"--columns: WHAT=NAME[:UNIT] or WHAT=NUMBER is needed, found {text!r}"
            )
        orders[what] = _order(log, what, written, unit(what), record.time)
    if record.helm is not None and not any(name != SPEED for name in orders):
        orders[YAW] = record.helm / FULL_HELM
    return Pass(path, record, orders, notes=tuple(f"{path.name}: {note}" for note in notes))


def _played(run: Run, columns: Sequence[str]) -> list[str]:
    """Return the orders that a log gave in a run, as texts WHAT=NAME, but for those in columns."""
    named = {part.partition("=")[0].strip() for text in columns for part in text.split(",")}
    orders = run.manifest["log"].get("orders", {})
    return [f"{port}={name}" for port, name in orders.items() if port not in named]


def _order(log: Log, what: str, written: str, unit: str, time: Vector) -> Vector:
    """Return an order at the times of the record; of other instants the last one holds."""
    try:
        return np.full(len(time), float(written))
    except ValueError:
        name, _, given = written.partition(":")
    found = series(log, what, Column(name, given or None), Quantity("an order", unit, held=True))
    return found.values[np.maximum(np.searchsorted(found.time, time, side="right") - 1, 0)]


def _of_run(path: Path) -> Pass:
    run = load_run(path)
    done = done_in(run)
    name = next(n for n, each in run.manifest["components"].items() if each["fmu"] == COMPONENT)
    signal = f"{name}.speed_order"
    if signal not in run.signals:
        raise InputError(f"{path}: {signal} is not recorded")
    first = max(int(np.searchsorted(done.record.time, done.needed())) - 1, 0)
    columns = {key: values[first:] for key, values in done.record.columns().items()}
    record = Record(**columns)
    speed = np.asarray(run.signals[signal], np.float64)[first:]
    return Pass(path, record, {YAW: record.helm / done.full_helm, SPEED: speed}, is_held=True)


def thinned(record: Record, most: int) -> Record:
    """Return every k-th row of a record, so that there are no more than ``most``."""
    every = -(-len(record.time) // most)
    return replace(record, **{name: each[::every] for name, each in record.columns().items()})
