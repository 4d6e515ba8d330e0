"""Reference trajectories of vehicles: files of states, inputs and thrusts at every 0.1 s."""

import csv
from pathlib import Path

import numpy as np

from seatrial.fmi.components.index import component_class
from seatrial.system.parameters import load_vehicle
from seatrial.system.references.derived import measures
from seatrial.system.references.quantities import amount

DATA = Path(__file__).parents[1] / "reference"
STATES = ("x", "y", "z", "phi", "theta", "psi", "u", "v", "w", "p", "q", "r")


def shipped(fmu, table, variant=None, **values):
    """Return a component with the values of a shipped vehicle's table ``vehicle.table``."""
    vehicle, _, part = table.partition(".")
    component = component_class(fmu)(part)
    entries = load_vehicle(vehicle).parameter_set(part, variant).values
    for name, value in {**{n: in_si(e) for n, e in entries.items()}, **values}.items():
        component.set(name, value)
    return component


def in_si(entry):
    """Return the value of an entry in SI; a text as it is."""
    if isinstance(entry.value, str):
        return entry.value
    if not isinstance(entry.value, list):
        return amount(entry.value, entry.unit).value
    found = zip(entry.value, measures(entry, len(entry.value)), strict=True)
    return [amount(value, unit).value for value, unit in found]


def columns(name):
    """Return the columns of a file by name."""
    with (DATA / f"{name}.csv").open() as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def row(times, t):
    """Return the row whose inputs are held at ``t``: they change at rows."""
    return int(np.searchsorted(times, t, side="right")) - 1


def assert_met(found, expected, names, tolerance=1e-7, least=2e-8):
    """Compare columns to a share of their largest value."""
    for name, column in zip(names, np.transpose(found), strict=True):
        known = expected[name]
        allowed = max(tolerance * np.abs(known).max(), least)
        worst = np.abs(column - known).max()
        assert worst <= allowed, f"{name}: off by {worst:.3g}, allowed {allowed:.3g}"
