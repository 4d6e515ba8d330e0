"""The question of sensitivity: how much each key matters to criteria and figures."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from seatrial.errors import InputError, SimulationError, unknown
from seatrial_kits.campaigns.questions import SensitivityQuestion
from seatrial_kits.campaigns.results.finding import Finding, Shown

from .asking import Asking, robustness_of
from .drawing import Axes, drawn
from .indices import Morris, Sobol, morris, sobol
from .outputs import Output, figures_of
from .parquet import write_columns
from .searching import needed

INDICES = "indices.parquet"


def sensitivity_question(entry: SensitivityQuestion, asking: Asking) -> Callable[[], Finding]:
    """Return what finds Sobol's indices and Morris's effects of each key on each output.

    Raises InputError for an output that does not exist, keys that are correlated, and a number of
    samples that is no power of 2.
    """
    for library in ("SALib", "matplotlib"):
        needed(library)
    space, origin = asking.space, asking.origin
    if space.scatter is not None or (space.lower != np.eye(len(space.keys))).any():
        raise InputError(
            f"{origin}: the design's keys are correlated, and Sobol's indices are of keys that "
            "are not: say what varies in [ask.vary]"
        )
    if entry.samples & (entry.samples - 1):
        raise InputError(f"{origin}: samples: a power of 2 is needed, found {entry.samples}")
    if not entry.samples and not entry.trajectories:
        raise InputError(f"{origin}: samples and trajectories are both 0: there is nothing to do")
    outputs = _outputs(entry, asking)
    return partial(_answer, entry, asking, outputs)


def _answer(entry: SensitivityQuestion, asking: Asking, outputs: dict[str, Output]) -> Finding:
    keys, space = len(asking.space.keys), asking.space
    asking.expect(entry.samples * (keys + 2) + entry.trajectories * (keys + 1))

    def found(numbers: np.ndarray) -> np.ndarray:
        measured = asking.run(numbers)
        if broken := sum(each.status == "failed" for each in measured):
            raise SimulationError(
                f"{broken} of {len(measured)} runs could not go on, and indices need all: "
                f"{asking.folder}/results.parquet says why; narrow what varies"
            )
        return np.array([[output(each) for output in outputs.values()] for each in measured])

    seed = asking.seed
    by_sobol: list[Sobol] = []
    by_morris: list[Morris] = []
    if entry.samples:
        by_sobol = sobol(lambda p: found(space.quantiles(p)), keys, entry.samples, seed)
    if entry.trajectories:
        by_morris = morris(lambda s: found(space.numbers(s)), keys, entry.trajectories, seed)
    return _finding(asking, list(outputs), by_sobol, by_morris)


def _outputs(entry: SensitivityQuestion, asking: Asking) -> dict[str, Output]:
    """Return what is asked about, by name, as functions of what a run came to."""
    criteria = [name for name, _ in asking.asked.base.criteria]
    known = figures_of(asking.asked.base)
    known |= {name: partial(robustness_of, names=[name]) for name in criteria}
    chosen = entry.of or [*criteria, *(name for name in known if name not in criteria)]
    for name in chosen:
        if name not in known:
            said = unknown("criterion or figure", name, known)
            raise InputError(f"{asking.origin}: of: {said}")
    if not chosen:
        raise InputError(
            f"{asking.origin}: {asking.asked.base.name} has no criterion, and the campaign no "
            "figures, to ask about"
        )
    return {name: known[name] for name in chosen}


def _finding(
    asking: Asking, names: list[str], by_sobol: list[Sobol], by_morris: list[Morris]
) -> Finding:
    finding, keys = asking.finding(), asking.space.keys
    columns: dict[str, list[Any]] = {"of": [], "key": []}
    for i, name in enumerate(names):
        parts: dict[str, np.ndarray] = {}
        if by_sobol:
            s = by_sobol[i]
            parts |= {"first": s.first, "± first": s.first_half}
            parts |= {"total": s.total, "± total": s.total_half}
        if by_morris:
            m = by_morris[i]
            parts |= {"mu*": m.mu_star, "± mu*": m.mu_star_half, "sigma": m.sigma}
        rows = [[key, *(float(p[k]) for p in parts.values())] for k, key in enumerate(keys)]
        finding.tables.append(Shown(name, ["key", *parts], rows))
        columns["of"] += [name] * len(keys)
        columns["key"] += keys
        for part, values in parts.items():
            columns.setdefault(part, []).extend(values.tolist())
        finding.values[name] = {
            key: {part: _finite(values[k]) for part, values in parts.items()}
            for k, key in enumerate(keys)
        }
    if by_sobol and any(np.isnan(s.total).any() for s in by_sobol):
        finding.lines.append("an output that no key changes has no indices")
    write_columns(asking.folder / INDICES, columns, {})
    with drawn(asking.folder, "sensitivity", len(names)) as axes:
        for i, one in enumerate(axes):
            one.set_title(names[i], fontsize=9)
            if by_sobol:
                _draw_sobol(one, keys, by_sobol[i])
            else:
                _draw_morris(one, keys, by_morris[i])
    finding.figures.append("sensitivity.svg")
    return finding


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _draw_sobol(axes: Axes, keys: tuple[str, ...], indices: Sobol) -> None:
    places = np.arange(len(keys))
    style = {"height": 0.38, "error_kw": {"linewidth": 0.8}}
    axes.barh(
        places - 0.2,
        indices.first,
        xerr=indices.first_half,
        color="#0b6ea8",
        label="first",
        **style,
    )
    axes.barh(
        places + 0.2,
        indices.total,
        xerr=indices.total_half,
        color="#d1690e",
        label="total",
        **style,
    )
    axes.set_yticks(places, keys)
    axes.invert_yaxis()
    axes.set_xlabel("share of the variance")
    axes.legend(fontsize=8)


def _draw_morris(axes: Axes, keys: tuple[str, ...], effects: Morris) -> None:
    axes.scatter(effects.mu_star, effects.sigma, s=18, color="#0b6ea8")
    for key, x, y in zip(keys, effects.mu_star, effects.sigma, strict=True):
        axes.annotate(key, (x, y), fontsize=8, xytext=(4, 3), textcoords="offset points")
    axes.set_xlabel("mu*, per range")
    axes.set_ylabel("sigma")
