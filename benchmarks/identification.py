"""Errors of identification on synthetic logs: output error, [Paulino2015]'s method, and a bound.

``python -m benchmarks.identification`` prints the table of docs/kits/identify/identification.md,
``--write`` puts it there. The logs are made by SciPy's DOP853 from the equations of motion;
nothing of the package simulates them.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from seatrial_kits.identify.output_error import AxisLog, Estimate, output_error
from seatrial_kits.identify.source_method import integrated, least_squares_axis, source_method

PAGE = Path(__file__).parents[1] / "docs/kits/identify/identification.md"
MARK = re.compile(r"(<!-- made by benchmarks/identification\.py -->\n).*?(<!-- end -->)", re.DOTALL)
PERIOD, DURATION, HOLD, AMPLITUDE = 0.1, 120.0, 10, 0.3
LONGEST_DELAY = 7


@dataclass(frozen=True)
class Case:
    """A vehicle's axis A nu' + b nu + c |nu| nu = E beta(t - delay), and its sensor."""

    name: str
    A: float
    b: float
    c: float
    E: float
    delay: int
    noise: float
    resolution: float
    rotation: bool = False

    @property
    def truth(self) -> np.ndarray:
        """B/A, C/A, E/A."""
        return np.array([-self.b, -self.c, self.E]) / self.A


CASES = (
    Case("surge, 7.9 cm/s²", 8.44, 0.95, 20.0, 93.41, 3, 0.079, 0.01),
    Case("surge, 2.4 cm/s²", 8.44, 0.95, 20.0, 93.41, 3, 0.024, 0.01),
    Case("yaw, 0.195 deg", 0.133, 0.023, 0.45, 9.34, 2, np.radians(0.195), np.radians(0.1), True),
)


class Run(NamedTuple):
    """A synthetic log, and the velocity that no sensor shows."""

    log: AxisLog
    velocity: np.ndarray
    delayed: np.ndarray


def synthetic(case: Case, seed: int) -> Run:
    """Return two minutes of random commands, each held for 1 s, integrated to 1e-11."""
    random = np.random.default_rng(seed)
    count = round(DURATION / PERIOD)
    levels = random.uniform(-1.0, 1.0, count // HOLD)
    command = AMPLITUDE * np.repeat(levels / np.abs(levels).max(), HOLD)
    late = np.concatenate([np.zeros(case.delay), command])[:count]

    def slope(_t: float, x: np.ndarray, beta: float) -> list[float]:
        drag = case.b * x[1] + case.c * abs(x[1]) * x[1]
        return [x[1], (case.E * beta - drag) / case.A]

    state, states = np.zeros(2), np.zeros((count, 2))
    edges = [0, *(np.flatnonzero(np.diff(late)) + 1).tolist(), count]
    for first, last in pairwise(edges):
        times = np.arange(first, last + 1) * PERIOD
        exact = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}
        piece = solve_ivp(slope, times[[0, -1]], state, t_eval=times, args=(late[first],), **exact)
        states[first:last], state = piece.y.T[:-1], piece.y[:, -1]
    if case.rotation:
        true = states[:, 0]
    else:
        true = np.array([slope(0.0, x, beta)[1] for x, beta in zip(states, late, strict=True)])
    noisy = true + case.noise * random.standard_normal(count)
    measured = np.round(noisy / case.resolution) * case.resolution
    log = AxisLog(
        command, measured, PERIOD, "place" if case.rotation else "acceleration", case.rotation
    )
    return Run(log, states[:, 1], late)


class Errors(NamedTuple):
    """Relative errors (3,) of B/A, C/A, E/A by method, and the delays found."""

    by_method: dict[str, np.ndarray]
    estimate: Estimate
    source_delay: int


def errors(case: Case, seed: int) -> Errors:
    """Return what each method makes of one log."""
    run = synthetic(case, seed)
    log = run.log
    estimate = output_error(log, range(LONGEST_DELAY + 1))
    ours = [estimate.values[name] for name in ("linear", "quadratic", "thrust")]
    reading = {"angle" if case.rotation else "acceleration": log.measured}
    source = source_method(log.command, PERIOD, longest_delay=LONGEST_DELAY, **reading)
    found = {
        "output error": ours,
        "[Paulino2015]": [source.linear, source.quadratic, source.thrust],
    }
    if not case.rotation:
        left = integrated(log.measured, PERIOD, "left")
        for name, velocity in (
            ("[Paulino2015], left rectangles", left),
            ("velocity without noise", run.velocity),
        ):
            B, C, _, E = least_squares_axis(run.delayed, velocity, log.measured, offset=False)
            found[name] = [B, C, E]
    relative = {name: np.abs(np.array(v) / case.truth - 1.0) for name, v in found.items()}
    return Errors(relative, estimate, source.delay)


def rows(seeds: int = 20) -> Iterator[list[str]]:
    """Yield the table's rows: median and 90 % quantile of each error, and right delays."""
    for case in CASES:
        runs = [errors(case, seed) for seed in range(seeds)]
        for method in runs[0].by_method:
            found = np.array([run.by_method[method] for run in runs])
            cells = [
                f"{_shown(np.median(column))} / {_shown(np.quantile(column, 0.9))}"
                for column in found.T
            ]
            delays = {
                "output error": [run.estimate.delay for run in runs],
                "[Paulino2015]": [run.source_delay for run in runs],
            }.get(method)
            right = f"{delays.count(case.delay)} of {seeds}" if delays else "given"
            yield [case.name, method, *cells, right]


def table(seeds: int = 20) -> str:
    """Return the table in Markdown."""
    head = ["log", "method", "B", "C", "E", "right delay"]
    lines = [head, ["---"] * len(head), *rows(seeds)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _shown(value: float) -> str:
    return f"{value:.2g}" if value >= 1e-4 else f"{value:.1e}"


if __name__ == "__main__":
    made = table()
    print(made)
    if "--write" in sys.argv[1:]:
        page = PAGE.read_text("utf-8")
        PAGE.write_text(MARK.sub(lambda m: m[1] + made + m[2], page), "utf-8")
