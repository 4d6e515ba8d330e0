"""The VideoRay's page: linear against quadratic actuation, counted as [Paulino2015] counts."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from parts import elsewhere, part
from parts.markdown import table
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import Run, load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.identify.prediction import delayed
from seatrial_kits.identify.source_method import (
    correlation_delay,
    differences,
    integrated,
    least_squares_axis,
)

_PERIOD, _LONGEST = 0.1, 40
_GRAVITY = 9.81
_DIVERGED = 1e6
"""Times the variance of the measured signal."""
TESTS = {"surge": (0.30, 0.30, 0.35), "yaw": (0.35, 0.35, 0.45, 0.45), "heave": (1.0, 1.0)}
"""Amplitudes of [Paulino2015], section 7.2."""
VARIABLES = ("u", "v", "w", "p", "q", "r", "w of depth")
FORMS = {"linear": np.copy, "square": np.square, "signed square": lambda b: b * np.abs(b)}
"""Of the command beta: eqs 5.9 and 5.10, and what 5.10 should be for both directions."""


class _Series(NamedTuple):
    velocity: Any
    acceleration: Any


def _series(run: Run) -> dict[str, _Series]:
    """Return rates as the source has them: integrated accelerations, differences of angles."""
    s = run.signals
    euler = [np.unwrap(s[f"vehicle.ahrs.euler.{a}"]) for a in ("phi", "theta", "psi")]
    phi, theta, _ = euler
    down = np.stack([-np.sin(theta), np.cos(theta) * np.sin(phi), np.cos(theta) * np.cos(phi)])
    found = {}
    for name, axis, g in zip("uvw", "xyz", _GRAVITY * down, strict=True):
        moved = s[f"vehicle.ahrs.accelerometer.{axis}"] + g
        found[name] = _Series(integrated(moved, _PERIOD), moved)
    for name, angle in zip("pqr", euler, strict=True):
        found[name] = _Series(*differences(angle, _PERIOD))
    found["w of depth"] = _Series(*differences(s["vehicle.depth.depth"], _PERIOD))
    return found


def _error(command: Any, measured: _Series) -> float:
    """Return the mean square error of the identified model's free run; infinite if it diverges."""
    delay = correlation_delay(command, measured.acceleration, _LONGEST)
    beta = delayed(command, delay)
    linear, quadratic, offset, thrust = least_squares_axis(
        beta, measured.velocity, measured.acceleration, offset=True
    )
    x, free = float(measured.velocity[0]), []
    for b in beta:
        free.append(x)
        x += _PERIOD * (linear * x + quadratic * abs(x) * x + offset + thrust * float(b))
        if not abs(x) < 1e9:
            return math.inf
    error = float(np.square(np.array(free) - measured.velocity).mean())
    return error if error < _DIVERGED * measured.velocity.var() else math.inf


def _errors() -> dict[tuple[str, str], list[dict[str, float]]]:
    """Return the errors by form, of each test and variable: 63 of them."""
    found: dict[tuple[str, str], list[dict[str, float]]] = {}
    for axis, amplitudes in TESTS.items():
        for seed, amplitude in enumerate(amplitudes, 1):
            settings = {"variant": "drivable", "excitation.amplitude": amplitude, "seed": seed}
            with elsewhere() as folder:
                trial = load_trial(f"videoray-excite-{axis}").changed(settings, "docs/tables.py")
                run = load_run(run_trial(trial, folder / "out", engine="direct").folder)
            command = run.signals["excitation.command"]
            for name, series in _series(run).items():
                errors = {form: _error(made(command), series) for form, made in FORMS.items()}
                found.setdefault((axis, name), []).append(errors)
    return found


@part("videoray-actuation")
def videoray_actuation() -> str:
    """How often the linear form errs less, by test and variable."""
    errors, rows = _errors(), []
    totals = {"square": 0, "signed square": 0}
    count = diverged = 0
    for (axis, name), tests in errors.items():
        shown = [
            " / ".join("diverges" if math.isinf(t[form]) else f"{t[form]:.3g}" for t in tests)
            for form in FORMS
        ]
        wins = {f: sum(t["linear"] < t[f] for t in tests) for f in totals}
        for form, number in wins.items():
            totals[form] += number
        count += len(tests)
        diverged += sum(math.isinf(t["square"]) for t in tests)
        rows.append((axis, name, *shown, *(f"{n} of {len(tests)}" for n in wins.values())))
    rows.append(
        (
            "all",
            "",
            "",
            f"{diverged} diverge",
            "",
            *(f"**{n} of {count}**" for n in totals.values()),
        )
    )
    head = (
        *("actuation", "variable", "error, beta", "error, beta²", "error, beta abs(beta)"),
        *("beta better than beta²", "than beta abs(beta)"),
    )
    return table(head, rows)
