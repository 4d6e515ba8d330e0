"""Study of an experiment of turns: sway fitted by output error, evaluated on data held out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.fmi.components.index import component_class
from seatrial.system.parameters import Vehicle, load_vehicle
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.files.parametrised import parametrise

from ..assessment import LEAST_FIT, MASS_RATIO, Verdict, fit
from ..gravity import acceleration_along
from ..planar_output_error import (
    PlanarFit,
    PlanarKnown,
    PlanarLog,
    as_the_source,
    planar_output_error,
    planar_simulated,
)
from ..source_method import PlanarEstimate
from .log_file import read_columns
from .planar_experiment import PlanarExperiment

READINGS = ("acceleration ahead", "acceleration to starboard", "heading")
LEAST_CERTAIN = 0.10
"""Largest share of the mass in sway that its standard deviation may be."""
_LEAST_PART = 30


@dataclass(frozen=True)
class PlanarStudy:
    """What was found from an experiment of turns."""

    experiment: PlanarExperiment
    log_path: Path
    known: PlanarKnown
    known_from: str
    """Where surge and yaw are from."""
    dry_mass: float
    """Mass without added mass, kg."""
    fitted: PlanarLog
    test: PlanarLog
    """Held out: nothing of it was seen by the fit, but for its first state and the biases."""
    fit: PlanarFit
    source: PlanarEstimate
    """What the method of [Paulino2015] finds from the same data."""
    free_run: FloatArray
    """Simulation over ``test`` (n, 3)."""
    free_run_fits: tuple[float, ...]
    """By reading, as `READINGS`."""
    verdicts: list[Verdict]

    @property
    def accepted(self) -> bool:
        """Whether every rule is kept."""
        return all(verdict.passed for verdict in self.verdicts)


def planar_study(
    experiment: PlanarExperiment, log: Path | None = None, format_name: str | None = None
) -> PlanarStudy:
    """Identify sway and thrust from an experiment's log, or from ``log``. Raises InputError.

    Surge, yaw, delay and lag are those of the vehicle that ``result`` names, in its variant. The
    fit sees the first part of the log; the rest, ``held_out``, evaluates it.
    """
    file, path = experiment.file, experiment.read_from.path
    where = experiment.log_path(log)
    vehicle = load_vehicle(file.result.vehicle, path.parent)
    known, dry_mass, known_from = _known(experiment, vehicle)
    whole = _read(experiment, where, format_name)
    rows = len(whole.commands)
    cut = round((1.0 - file.held_out) * rows)
    fitted, test = whole.part(0, cut), whole.part(cut, rows)
    for part, what in ((fitted, "to fit"), (test, "held out")):
        if len(part.commands) < _LEAST_PART:
            found = f"{len(part.commands)} rows {what}"
            raise InputError(f"{where}: {found}, at least {_LEAST_PART} are needed")
    try:
        estimate = planar_output_error(fitted, known)
    except ValueError as error:
        raise InputError(f"{where}: the delay in {known_from}: {error}") from None
    free_run = planar_simulated(test, known, estimate)
    fits = tuple(fit(test.readings[:, i], free_run[:, i]) for i in range(len(READINGS)))
    return PlanarStudy(
        experiment=experiment,
        log_path=where,
        known=known,
        known_from=known_from,
        dry_mass=dry_mass,
        fitted=fitted,
        test=test,
        fit=estimate,
        source=as_the_source(fitted, known),
        free_run=free_run,
        free_run_fits=fits,
        verdicts=_verdicts(estimate, fits, dry_mass),
    )


def _known(experiment: PlanarExperiment, vehicle: Vehicle) -> tuple[PlanarKnown, float, str]:
    """Return surge, yaw and thrusters of the vehicle's variant, and its mass without water."""
    result, path = experiment.file.result, experiment.read_from.path
    try:
        cls: Any = component_class(result.component)
        craft = cls(result.component)
        thruster: Any = component_class("linear-thruster")(result.thruster)
        parametrise(craft, vehicle, result.component, result.variant)
        parametrise(thruster, vehicle, result.thruster, result.variant)
        mass = craft.mass_matrix()
    except InputError as error:
        raise InputError(f"{path}: result: {error}") from None
    except AttributeError:
        raise InputError(
            f"{path}: result.component: a craft in six degrees of freedom is needed, "
            f"rov or marine-craft, found {result.component!r}"
        ) from None
    force, moment = craft.linear_damping_force, craft.linear_damping_moment
    square, turning = craft.quadratic_damping_force, craft.quadratic_damping_moment
    known = PlanarKnown(
        mass=(float(mass[0, 0]), float(mass[5, 5])),
        linear=(force[0], moment[2]),
        quadratic=(square[0], turning[2]),
        arm=experiment.arm,
        delay=thruster.delay,
        time_constant=thruster.time_constant,
    )
    variant = result.variant or vehicle.file.default
    name = vehicle.read_from.name + (f", variant {variant}" if variant else "")
    return known, float(craft.mass), name


def _read(experiment: PlanarExperiment, path: Path, format_name: str | None) -> PlanarLog:
    entries = experiment.file.columns
    columns = read_columns(path, entries, format_name)
    commands = np.column_stack([columns.command(name) for name in ("port", "starboard")])
    level = np.zeros(len(commands))
    roll, pitch = (columns.values.get(name, level) for name in ("roll", "pitch"))
    x, y = columns.values["acceleration_x"], columns.values["acceleration_y"]
    ahead = acceleration_along("surge", x, roll, pitch, reads=entries.acceleration_x.reads)
    across = acceleration_along("sway", y, roll, pitch, reads=entries.acceleration_y.reads)
    readings = np.column_stack([ahead, across, columns.heading()])
    still = np.flatnonzero(np.ptp(readings, axis=0) == 0.0)
    if len(still):
        raise InputError(f"{path}: the {READINGS[still[0]]} never changes")
    return PlanarLog(commands, readings, columns.period(), np.zeros((0, 2)))


def _verdicts(estimate: PlanarFit, fits: tuple[float, ...], dry_mass: float) -> list[Verdict]:
    """Return the rules: thrust, data held out, how certain sway is, plausible mass."""
    first, second = estimate.values["thrust_1"], estimate.values["thrust_2"]
    mass, deviation = estimate.values["mass"], estimate.deviation("mass")
    ahead, _, heading = fits
    ratio, (least, most) = mass / dry_mass, MASS_RATIO
    return [
        Verdict(
            "both thrusters act as commanded",
            first > 0.0 and second > 0.0,
            f"{first:.4g} N and {second:.4g} N, above 0 is needed",
        ),
        Verdict(
            "a free run fits data held out",
            min(ahead, heading) > LEAST_FIT,
            f"heading {100.0 * heading:.1f} %, acceleration ahead {100.0 * ahead:.1f} %, above "
            f"{100.0 * LEAST_FIT:g} % is needed",
        ),
        Verdict(
            "sway was excited",
            deviation < LEAST_CERTAIN * mass,
            f"mass {mass:.4g} kg, standard deviation {deviation:.2g} kg; at most "
            f"{100.0 * LEAST_CERTAIN:g} % is allowed",
        ),
        Verdict(
            "mass with added mass is plausible",
            least <= ratio <= most,
            f"{ratio:.4g} times the mass without, {least:g} to {most:g} is needed",
        ),
    ]
