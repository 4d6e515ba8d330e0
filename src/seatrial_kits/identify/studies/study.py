"""Study of an experiment: fitted by output error, evaluated on data held out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.criteria.expressions import FloatArray

from ..assessment import Verdict, Whiteness, fit, verdicts, whiteness
from ..output_error import AxisLog, Estimate, output_error, simulated
from ..source_method import SourceEstimate, source_method
from .experiment import Experiment
from .log_file import read_log

_LEAST_PART = 30


@dataclass(frozen=True)
class Physical:
    """A parameter of the vehicle in SI, and its standard deviation; thrust and mass as given."""

    value: float
    deviation: float


@dataclass(frozen=True)
class Study:
    """What was found from an experiment."""

    experiment: Experiment
    log_path: Path
    test_path: Path
    fitted: AxisLog
    test: AxisLog
    """Held out: nothing of it was seen by the fit, but for its first state and a bias."""
    estimate: Estimate
    source: SourceEstimate
    """What the method of [Paulino2015] finds from the same data."""
    free_run: FloatArray
    """Simulation over ``test``."""
    free_run_fit: float
    whiteness: Whiteness
    verdicts: list[Verdict]

    @property
    def delay(self) -> float:
        """Delay of the command, s."""
        return self.estimate.delay * self.fitted.period

    @property
    def accepted(self) -> bool:
        """Whether every rule is kept."""
        return all(verdict.passed for verdict in self.verdicts)

    def physical(self) -> dict[str, Physical]:
        """Return mass with added mass, added mass, both drags and the constant force.

        A = thrust / (E/A), with the thrust that the experiment knows; the others are A times
        their ratio, drag positive. Deviations to first order, of the ratios alone.
        """
        ratios, thrust = self.estimate.values, self.experiment.thrust
        E = ratios["thrust"]
        total = thrust / E
        of_E = {"thrust": -total / E}
        found = {"total mass": (total, of_E), "added mass": (total - self.experiment.mass, of_E)}
        for name, sign in (("linear", -1.0), ("quadratic", -1.0), ("offset", 1.0)):
            value = sign * total * ratios[name] + 0.0
            found[name] = (value, {name: sign * total, "thrust": -value / E})
        return {
            name: Physical(value, self._deviation(slope)) for name, (value, slope) in found.items()
        }

    def _deviation(self, slope: dict[str, float]) -> float:
        gradient = np.array([slope.get(name, 0.0) for name in self.estimate.free])
        return math.sqrt(float(gradient @ self.estimate.covariance @ gradient))


def study(experiment: Experiment, log: Path | None = None, format_name: str | None = None) -> Study:
    """Identify an experiment's axis from its log, or from ``log``. Raises InputError.

    The fit sees the first part of the log; the rest, ``held_out``, evaluates it. With a
    ``test_log`` the fit sees the whole log, and the other one evaluates it.
    """
    file = experiment.file
    log_path = experiment.log_path(log)
    test_path = log_path
    whole = read_log(experiment, log_path, format_name)
    if file.test_log is None:
        count = len(whole.command)
        cut = round((1.0 - file.held_out) * count)
        fitted, test = whole.part(0, cut), whole.part(cut, count)
    else:
        test_path = experiment.read_from.path.parent / file.test_log
        fitted, test = whole, read_log(experiment, test_path, format_name)
        if abs(test.period / fitted.period - 1.0) > 1e-6:
            raise InputError(
                f"{test_path}: rows {test.period:g} s apart, {log_path} has {fitted.period:g} s"
            )
    longest = math.floor(experiment.longest_delay / fitted.period + 1e-9)
    _require(fitted, test, longest, log_path, test_path)
    estimate = output_error(
        fitted, range(longest + 1), thrust_law=file.thrust_law, offset=experiment.offset
    )
    free_run = simulated(test, estimate)
    free_run_fit = fit(test.measured, free_run)
    return Study(
        experiment=experiment,
        log_path=log_path,
        test_path=test_path,
        fitted=fitted,
        test=test,
        estimate=estimate,
        source=_as_the_source(fitted, file.thrust_law, longest, experiment.offset),
        free_run=free_run,
        free_run_fit=free_run_fit,
        whiteness=whiteness(estimate.residual),
        verdicts=verdicts(
            estimate, fitted.period, free_run_fit, experiment.mass, experiment.thrust
        ),
    )


def _require(fitted: AxisLog, test: AxisLog, longest: int, log_path: Path, test_path: Path) -> None:
    """Raise InputError for parts that are too short, or at rest."""
    for part, path, what in ((fitted, log_path, "to fit"), (test, test_path, "held out")):
        rows = len(part.command)
        least = _LEAST_PART + longest
        if rows < least:
            raise InputError(f"{path}: {rows} rows {what}, at least {least} are needed")
        if np.ptp(part.command[: rows - longest]) == 0.0:
            raise InputError(f"{path}: the command never changes in the rows {what}")
        if np.ptp(part.measured) == 0.0:
            raise InputError(f"{path}: what was measured never changes in the rows {what}")


def _as_the_source(
    log: AxisLog, thrust_law: str, longest_delay: int, offset: bool
) -> SourceEstimate:
    beta = log.command * np.abs(log.command) if thrust_law == "quadratic" else log.command
    place = log.reading == "place"
    return source_method(
        beta,
        log.period,
        acceleration=None if place else log.measured,
        angle=log.measured if place else None,
        longest_delay=longest_delay,
        offset=offset,
    )
