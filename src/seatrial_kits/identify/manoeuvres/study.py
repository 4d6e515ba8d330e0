"""Study of a vehicle's manoeuvres: its parameters from the logs, with how certain they are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.errors import InputError
from seatrial.model.expressions import Vector
from seatrial.model.readable import number

from ..assessment import LEAST_FIT, Verdict, fit
from .craft import Craft
from .identifiability import Identifiability, identifiability
from .intervals import WITHIN, bootstrap, deviations
from .passes import Pass
from .prediction import Motion, halved, motion_of
from .problem import ROUGH, Problem, Solution
from .replay import inputs_of

_PRIOR = 0.5
"""Standard deviation of relative changes while it is not yet known which are identifiable."""
_TURNED = math.radians(10.0)
_TURNED_BACK = math.radians(90.0)
"""Range of headings from which a current shows itself against a model's speed."""


@dataclass(frozen=True)
class Row:
    """A parameter, or a component of the current: in SI units."""

    name: str
    unit: str
    before: float
    """Value in the vehicle's file; no current."""
    value: float
    """That identified; of one that is kept, that before."""
    deviation: float
    """Standard deviation, by the information matrix; what it would be, of one that is kept."""
    resampled: float
    """The same by bootstrap; 0 of one that is kept."""
    integration: float
    """How much half the steps of the integration changed it."""
    is_identifiable: bool
    """Whether the passes show it; else it keeps its value."""
    partner: str
    """The parameter that it is hardly separable from, empty if there is none."""
    is_current: bool
    """Whether it is the current of a pass, which no file has."""

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of 95 %, see `half`."""
        return self.value - self.half, self.value + self.half

    @property
    def half(self) -> float:
        """Half of the interval: by the larger one of both deviations, and the error of the steps.

        The value is that of half the steps. The error of a method of order p >= 1 is then
        1 / (2^p - 1) times the change by halving, no more than that change (Richardson).
        """
        return WITHIN * max(self.deviation, self.resampled) + self.integration


@dataclass(frozen=True)
class Shown:
    """Readings (3, n) of a pass: those of the log, and of the model before and after."""

    run: Pass
    time: Vector
    log: Vector
    before: Vector
    after: Vector
    is_fitted: bool = True
    """Whether the parameters were chosen by it; else it is there to evaluate them."""

    def rms(self, simulated: Vector) -> tuple[float, float]:
        """Return the root mean square distance of the track, m, and of the heading, rad."""
        north, east, heading = self.log - simulated
        return math.sqrt(np.mean(north**2 + east**2)), math.sqrt(np.mean(heading**2))

    @property
    def fit(self) -> float:
        """The lesser fit (`assessment.fit`) of track and, where it turns by 10 deg, heading."""
        track = fit(*((each[:2].T - self.log[:2].mean(axis=1)).ravel()
                      for each in (self.log, self.after)))  # fmt: skip
        turns = np.ptp(self.log[2]) > _TURNED
        return min(track, fit(self.log[2], self.after[2])) if turns else track


@dataclass(frozen=True)
class ManoeuvreStudy:
    """What was identified from passes of a vehicle."""

    vehicle: str
    craft: Craft
    rows: tuple[Row, ...]
    notes: tuple[str, ...]
    """Parameters that are not identifiable, and the combinations that are."""
    shown: tuple[Shown, ...]
    verdicts: tuple[Verdict, ...]

    @property
    def accepted(self) -> bool:
        """Whether every rule is kept."""
        return all(verdict.passed for verdict in self.verdicts)

    @property
    def parameters(self) -> tuple[Row, ...]:
        """Parameters of the vehicle that the passes show."""
        return tuple(row for row in self.rows if row.is_identifiable and not row.is_current)


def manoeuvre_study(
    vehicle: str,
    passes: Sequence[Pass],
    craft: Craft,
    free: Sequence[str],
    variant: str | None,
    checks: Sequence[Pass] = (),
) -> ManoeuvreStudy:
    """Identify the parameters ``free`` of a vehicle from passes, each in a uniform current.

    Output error: every pass is simulated from its orders alone, and parameters, the current and
    the state at the first row of each pass are chosen so that north, east and heading are nearest
    to those of the log, each weighted by its own residual. Actuators followed the first orders
    before, or start from rest, whichever is nearer to the log. Parameters that the passes do not
    show (`identifiability`) keep the values of the file. ``checks`` are passes that choose no
    parameter: they are simulated with those found. Raises InputError as `inputs_of` and
    `motion_of` do, and if the passes show no parameter.
    """

    def motion(run: Pass) -> Motion:
        inputs = inputs_of(craft, vehicle, variant, run)
        first, *others = [motion_of(craft, run.record, each) for each in inputs]
        return min((first, *others), key=lambda m: _left(craft, m, free)) if others else first

    problem = Problem(craft, [motion(run) for run in passes], free)
    held = problem.solve(problem.named, problem.guess(), prior=_PRIOR, accuracy=ROUGH)
    which = identifiability(held.jacobian, held.residual, problem.stretches, problem.named)
    if not set(which.shown) & set(problem.free):
        raise InputError(
            f"{', '.join(run.name for run in passes)}: the manoeuvres show no parameter of "
            f"{', '.join(free)} through the noise"
        )
    start = held.unknowns.copy()
    start[[problem.named.index(name) for name in which.kept]] = 0.0
    rough = problem.solve(which.shown, start, scales=held.scales)
    coarse = problem
    problem = Problem(craft, [halved(each) for each in coarse.motions], free)
    final = problem.solve(which.shown, rough.unknowns, scales=rough.scales)
    start = final.unknowns.copy()
    start[: len(problem.free)] = 0.0
    currents = [name for name in which.shown if name not in problem.free]
    before = coarse.solve(currents, start, scales=held.scales, accuracy=ROUGH)
    rows = _rows(problem, final, which, np.abs(final.unknowns - rough.unknowns))
    shown = _shown(problem, passes, before, final)
    if checks:
        others = Problem(craft, [motion(run) for run in checks], free)
        found = final.unknowns[: len(free)]
        both = (_followed(others, each) for each in (np.zeros(len(free)), found))
        shown += _shown(others, checks, *both, is_fitted=False)
    notes, verdicts = _notes(problem, final, which), _verdicts(craft, rows, shown)
    return ManoeuvreStudy(vehicle, craft, rows, tuple(notes), shown, tuple(verdicts))


def _left(craft: Craft, motion: Motion, free: Sequence[str]) -> float:
    """Return what of a pass the equations leave: the product of the residuals of all readings.

    The least product is the most likely of normal residuals whose variances are not known.
    """
    problem = Problem(craft, [motion], free)
    found = problem.solve(problem.named, problem.guess(), prior=_PRIOR, accuracy=ROUGH)
    return float(np.prod(found.scales))


def _followed(problem: Problem, changes: Vector) -> Solution:
    """Return passes with given relative changes of the parameters, and currents of their own.

    A current is looked for where a pass turns; on a straight course it would be taken for a wrong
    speed of the model.
    """
    start = problem.guess()
    start[: len(changes)] = changes
    currents = [
        name
        for motion, names in zip(problem.motions, problem.currents, strict=True)
        for name in names
        if np.ptp(motion.record.heading) > _TURNED_BACK
    ]
    return problem.solve(currents, start)


def _shown(
    problem: Problem, passes: Sequence[Pass], before: Solution, after: Solution, **given: bool
) -> tuple[Shown, ...]:
    simulated = (problem.readings(each.unknowns) for each in (before, after))
    return tuple(
        Shown(run, motion.record.time, motion.measured, old, new, **given)
        for run, motion, old, new in zip(passes, problem.motions, *simulated, strict=True)
    )


def _rows(
    problem: Problem, final: Solution, which: Identifiability, integration: Vector
) -> tuple[Row, ...]:
    named, craft = problem.named, problem.craft
    places = [i for i, name in enumerate(named) if name in which.shown]
    kept = [i for i, name in enumerate(problem.free) if name in which.kept]
    own = [*places, *range(len(named), final.jacobian.shape[1])]
    left = final.jacobian, final.residual, problem.stretches
    by_matrix = deviations(*left, own, kept)
    resampled = bootstrap(final.jacobian[:, own], final.residual, problem.stretches)
    found = {named[place]: (by_matrix[i], resampled[i]) for i, place in enumerate(places)}
    partners = {pair.second: pair.first for pair in which.pairs}
    partners |= {pair.first: pair.second for pair in which.pairs if pair.first not in partners}
    rows = []
    for place, name in enumerate(named):
        is_current = name not in problem.free
        scale = problem.speed if is_current else craft.parameters[name]
        old = 0.0 if is_current else scale
        deviation, drawn = found.get(name, (which.kept.get(name, 0.0), 0.0))
        rows.append(
            Row(
                name,
                "m/s" if is_current else craft.unit(name),
                old,
                old + scale * float(final.unknowns[place]),
                abs(scale) * float(deviation),
                abs(scale) * float(drawn),
                abs(scale) * float(integration[place]),
                name in which.shown,
                partners.get(name, ""),
                is_current,
            )
        )
    return tuple(rows)


def _notes(problem: Problem, final: Solution, which: Identifiability) -> list[str]:
    """Return what is said of unknowns that are kept, and of pairs that are hardly separable."""
    own = set(problem.free)
    scales = dict.fromkeys(problem.named, problem.speed) | problem.craft.parameters
    found, changes = [], dict(zip(problem.named, final.unknowns, strict=False))
    paired = {pair.second for pair in which.pairs}
    for name in which.kept:
        if name not in paired:
            kept = "keeps the file's value" if name in own else "is taken as 0"
            found.append(f"{name} is not shown by these manoeuvres and {kept}")
    for pair in which.pairs:
        first, second = scales[pair.first], scales[pair.second]
        ratio = pair.ratio * first / second
        value = sum(
            factor * scales[name] * (changes[name] + (name in own))
            for name, factor in ((pair.first, 1.0), (pair.second, -ratio))
        )
        sign = "-" if ratio > 0.0 else "+"
        half = WITHIN * pair.deviation * abs(first)
        kept = f"; {pair.second} keeps the file's value" if pair.second in which.kept else ""
        found.append(
            f"{pair.first} and {pair.second} are hardly separable (correlation "
            f"{pair.correlation:.3f}): {pair.first} {sign} {number(abs(ratio), 3)} {pair.second} = "
            f"{number(value, 4)} +- {number(half, 2)} is identifiable{kept}"
        )
    return found


def _verdicts(craft: Craft, rows: Sequence[Row], shown: Sequence[Shown]) -> list[Verdict]:
    """Return the rules: values that the craft accepts, and passes that the model follows."""
    outside = [
        f"{row.name} {number(row.value, 4)}, {number(low, 4)} to {number(high, 4)} is allowed"
        for row in rows
        if row.is_identifiable and not row.is_current
        for low, high in [craft.limits(row.name)]
        if not low <= row.value <= high
    ]
    fitted, checked = (
        {each.run.name: each.fit for each in shown if each.is_fitted is which}
        for which in (True, False)
    )
    found = [
        Verdict("the values are those of a craft", not outside, "; ".join(outside) or "in range"),
        _follows("the model follows the logs", fitted),
    ]
    if checked:
        found.append(_follows("the model follows logs it was not fitted to", checked))
    return found


def _follows(rule: str, fits: Mapping[str, float]) -> Verdict:
    said = ", ".join(f"{name} {100.0 * value:.1f} %" for name, value in fits.items())
    is_kept = min(fits.values()) > LEAST_FIT
    return Verdict(rule, is_kept, f"{said}, above {100.0 * LEAST_FIT:g} % is needed")
