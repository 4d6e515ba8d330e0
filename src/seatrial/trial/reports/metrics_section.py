"""Metrics of criteria in a report: each with its value and unit, and its signal over time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from ...model.readable import from_si, quantity_text
from ..criteria import formulas
from ..criteria.criteria import Criterion, parse
from ..criteria.expressions import (
    Expression,
    FloatArray,
    Operation,
    Units,
    Value,
    Values,
    unit_of,
    written,
)
from ..criteria.metrics import TIME, Metric, is_constant
from ..criteria.predicates import Comparison
from ..criteria.settling import Settling
from ..records.run_folder import Run
from .plots import Line, Mark, Panel, time_figure

_MOST_DRAWN = 12


@dataclass(frozen=True)
class MetricShown:
    """A metric of a criterion."""

    criterion: str
    text: str
    """As the criterion has it."""
    value: str
    """With its unit."""
    panel: Panel
    """Its first argument over time, within its window."""


def metrics_of(run: Run) -> list[MetricShown]:
    """Return the metrics of a run's criteria; of one that its record does not have none."""
    found = []
    for entry in run.manifest["criteria"] if len(run.time) else []:
        try:
            criterion = parse(entry["check"])
            paths = entry.get("paths", {})
            criterion = criterion.renamed({n: paths.get(n, n) for n in criterion.signals})
            values = criterion.record(run.time, run.signals, run.units).values
            found += [
                _shown(entry["name"], metric, comparison, values, run.units)
                for metric, comparison in _metrics(criterion)
            ]
        except InputError:  # a signal that was not recorded, or a criterion of another version
            continue
    return found


def metrics_figure(run: Run, metrics: list[MetricShown]) -> str | None:
    """Return the courses of metrics below each other, as JSON for Plotly; None without any."""
    panels = [each.panel for each in metrics[:_MOST_DRAWN]]
    return time_figure(run.time, [panels]).json() if panels else None


def _metrics(criterion: Criterion) -> Iterator[tuple[Metric, Comparison]]:
    """Yield each metric with one value, and the comparison that has it."""
    if isinstance(criterion.says, Settling):
        return
    for predicate in formulas.predicates(criterion.says):
        if isinstance(predicate, Comparison):
            for side in (predicate.left, predicate.right):
                yield from ((metric, predicate) for metric in _within(side))


def _within(node: Expression) -> Iterator[Metric]:
    if isinstance(node, Metric) and not node.is_series:
        yield node
    elif isinstance(node, Operation):
        for argument in node.arguments:
            yield from _within(argument)


def _shown(
    criterion: str, metric: Metric, comparison: Comparison, values: Values, units: Units
) -> MetricShown:
    with np.errstate(all="ignore"):
        found = float(np.asarray(metric.evaluate(values)))
    unit = unit_of(comparison, units, metric.exponents(units))
    value = quantity_text(from_si(found, unit), unit)
    subject, text = metric.arguments[0], written(metric)
    own = unit_of(metric, units, subject.exponents(units))
    course = _in(own, subject.evaluate(values), values[TIME])
    since = values[TIME] - values[TIME][0]
    last = np.inf if metric.last is None else metric.last
    course = np.where((since >= metric.first) & (since <= last), course, np.nan)
    marks = list(_marks(metric, own, values, units))
    if metric.exponents(units) == subject.exponents(units):
        marks.append(Mark(f"{metric.name} {value}", from_si(found, own)))
    title = f"{text} is {value}"
    panel = Panel(title, own, [Line(written(subject), course)], marks)
    return MetricShown(criterion, text, value, panel)


def _marks(metric: Metric, unit: str, values: Values, units: Units) -> Iterator[Mark]:
    """Yield the level or target of a metric, and the band around the target."""
    of = metric.arguments[0].exponents(units)
    levels = [a for a in metric.arguments[1:] if is_constant(a) and a.exponents(units) == of]
    numbers = [float(np.asarray(level.evaluate(values))) for level in levels]
    if not numbers or metric.name == "percentile":
        return
    name = "level" if metric.name.startswith(("time_", "cross")) else "target"
    yield Mark(name, from_si(numbers[0], unit))
    for sign in (-1.0, 1.0) if len(numbers) > 1 else ():
        yield Mark("band", from_si(numbers[0] + sign * numbers[1], unit), is_band=True)


def _in(unit: str, value: Value, time: FloatArray) -> FloatArray:
    """Return a course, of a constant too, in a unit."""
    course = np.broadcast_to(np.asarray(value, float), time.shape)
    result: FloatArray = np.asarray(from_si(course, unit))  # type: ignore[arg-type]
    return result
