"""The trial in which a log plays into a system."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.model.component import NS, seconds
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.part import Part
from seatrial.system.rig import ComponentEntry, Feed, Rig
from seatrial.system.system import System
from seatrial.trial.criteria.criteria import parse
from seatrial.trial.files.trial import Trial, is_trial, load_trial
from seatrial.trial.files.trial_file import CriterionEntry
from seatrial.trial.logs.channels import Array, Log

from ..paired.common_time import Window
from ..paired.resampling import Trace
from .asked import SPEED, YAW, Asked, Traces, traces_of
from .tables import write_table

COMPONENT = "log"
_RIG = "system.toml"
_MOST_RECORDED = 200_000
"""Rows of the record of a vehicle, whose signals are in memory when they are compared."""
_ORDERS = {YAW: "pilot.orders.manual.yaw", SPEED: "pilot.orders.manual.surge"}
_VEHICLE = """\
title = "{vehicle} alone"
step  = {step}
[components]
vehicle = {{ rig = {rig} }}
"""
_PILOT = """\
pilot = {{ rig = {pilot}, set = {{ "{mode}" = "manual", "{armed}" = true }} }}
[connections]
"vehicle.sensors" = "pilot.sensors"
"pilot.actuators" = "vehicle.actuators"
"""
_TRIAL = """\
title = {title}
rig   = {rig}
stop  = {stop}
[record]
every = {every}
"""


@dataclass(frozen=True)
class Driven:
    """The system that a log plays into: a rig or a trial, or a vehicle with its pilot or alone."""

    name: str | None
    vehicle: str | None
    changes: Mapping[str, Any]
    """Settings of the command line, by component.port."""


@dataclass(frozen=True, eq=False)
class Prepared:
    """A trial that a log plays into, and what of it plays."""

    trial: Trial
    traces: Traces
    window: Window
    """Of the log's time, s; its begin is the time 0 of the trial."""
    notes: tuple[str, ...]

    def played(self, name: str) -> Trace:
        """Return an output of the log at the times of the trial."""
        each = self.traces.outputs[name]
        time = each.time - self.window[0]
        return Trace(f"{COMPONENT}.{name}", each.unit, time, each.values, each.held, each.gap)


def prepared(
    log: Log, driven: Driven, asked: Asked, checks: Sequence[str], folder: Path
) -> Prepared:
    """Return the trial in which a log plays into a system; its files are written into ``folder``.

    The log's outputs are those of the component `COMPONENT`. What they feed is fed by nothing else.
    The only craft of the system starts from the log's position, heading and velocity.

    Raises InputError for what does not fit in the log, the rig, the feeds and the criteria.
    """
    alone = driven.name is None
    if alone and driven.vehicle is None:
        raise InputError("shadow: --vehicle NAME or --rig RIG is needed: what the log plays into")
    ordered = {"yaw", "helm", "speed"} & {fed.port for fed in asked.feeds}
    direct = [fed.port for fed in asked.feeds if fed.port not in ("yaw", "helm", "speed")]
    has_pilot = alone and (bool(ordered) or not direct)
    traces = traces_of(log, asked, has_pilot=has_pilot)
    orders = traces.orders()
    if has_pilot and orders and orders.keys() != {YAW, SPEED}:
        lacking = YAW if SPEED in orders else SPEED
        raise InputError(
            f"{log.path}: the order {lacking} is needed, too: --feed {lacking}=CHANNEL or "
            f"{lacking}=NUMBER, a share of the full one"
        )
    fed = [*traces.feeds.values()]
    window = window_of(
        traces.outputs, fed or [*traces.motion.values()], asked.window, str(log.path)
    )
    notes: list[str] = []
    trial = _trial(log, driven, traces, window, has_pilot and bool(orders), folder, notes)
    trial = _without_settings(trial, [*traces.feeds])
    table = write_table(traces.outputs, window, folder, trial.rig.step_ns)
    trial = replace(trial, rig=_fed(trial.rig, traces, table))
    trial = _started(trial, traces, window, driven.changes, notes)
    return Prepared(_with_criteria(trial, checks), traces, window, tuple(notes))


def _trial(
    log: Log,
    driven: Driven,
    traces: Traces,
    window: Window,
    has_pilot: bool,
    folder: Path,
    notes: list[str],
) -> Trial:
    changes, name = dict(driven.changes), driven.name
    if name is not None and driven.vehicle is not None:
        changes["choices.vehicle"] = driven.vehicle
    if name is not None and is_trial(name):
        step = load_trial(name, changes=changes, origin="--set").rig.step_ns
        return load_trial(name, changes={**changes, "stop": _stop(window, step)}, origin="--set")
    if name is None:
        assert driven.vehicle is not None
        rig = _vehicle_rig(driven.vehicle, has_pilot, folder)
    else:
        rig = str(Path(name).resolve()) if name.endswith(".toml") else name
    chosen = {k.partition(".")[2]: v for k, v in changes.items() if k.startswith("choices.")}
    step = load_rig(rig, folder, chosen).step_ns
    usual = [each.usual for each in traces.outputs.values() if each.usual > 0.0]
    length = _length(window, step)
    steps = max(round(min(usual, default=1.0) * NS / step), 1)
    fewest = -(-length // (step * _MOST_RECORDED))
    if fewest > steps:
        notes.append(f"recorded and compared every {fewest * step / NS:g} s: the run is long")
    every = min(max(steps, fewest) * step, length)
    path = folder / f"{log.path.stem}-shadow.toml"
    text = _TRIAL.format(
        title=json.dumps(f"{log.path.name} plays into {driven.vehicle or name}"),
        rig=json.dumps(rig),
        stop=json.dumps(f"{length} ns"),
        every=json.dumps(f"{every} ns"),
    )
    path.write_text(text, encoding="utf-8")
    return load_trial(str(path), changes=changes, origin="--set")


def _vehicle_rig(vehicle: str, has_pilot: bool, folder: Path) -> str:
    """Write a rig of a vehicle, and its pilot in the mode manual; return its name there."""
    text = _VEHICLE.format(
        vehicle=vehicle,
        step=json.dumps(load_rig(f"vehicles/{vehicle}").file.step),
        rig=json.dumps(f"vehicles/{vehicle}"),
    )
    if has_pilot:
        text += _PILOT.format(
            pilot=json.dumps(f"pilots/{vehicle}"), mode="guidance.mode", armed="guidance.armed"
        )
    (folder / _RIG).write_text(text, encoding="utf-8")
    return _RIG


def _length(window: Window, step_ns: int) -> int:
    """Return the length of a window in whole steps, ns. Raises InputError for less than one."""
    steps = int((window[1] - window[0]) * NS + 1) // step_ns
    if steps < 1:
        raise InputError(
            f"--from, --to: {window[1] - window[0]:g} s of the log are shorter than a step of the "
            f"rig, {seconds(step_ns):g} s"
        )
    return steps * step_ns


def _stop(window: Window, step_ns: int) -> str:
    return f"{_length(window, step_ns)} ns"


def _without_settings(trial: Trial, ports: Sequence[str]) -> Trial:
    """Return a trial whose file does not set the inputs that the log feeds."""
    kept = {key: value for key, value in trial.file.set.items() if key not in ports}
    return replace(trial, file=trial.file.model_copy(update={"set": kept}))


def _fed(rig: Rig, traces: Traces, table: Path) -> Rig:
    """Return the rig with the log as a component, whose outputs feed inputs."""
    entry = ComponentEntry(fmu=str(table), set={"beyond": "hold"})
    feeds = [
        Feed(f"{COMPONENT}.{name}", _ORDERS.get(port, port), f"--feed {port}")
        for port, name in traces.feeds.items()
    ]
    return rig.fed(COMPONENT, entry, feeds)


def _started(
    trial: Trial, traces: Traces, window: Window, changes: Mapping[str, Any], notes: list[str]
) -> Trial:
    """Return the trial whose craft starts as the log does, unless its start was set."""
    system: System = assemble(trial.rig, "direct", variant=trial.file.variant)
    try:
        found = crafts(system)
        motion = {what: traces.outputs[name] for what, name in traces.motion.items()}
        state = first_state(motion, window)
        if len(found) != 1 or not state:
            if found and state:
                notes.append(f"{len(found)} craft: none starts from the log's first position")
            return trial
        values = settings(found[0], state)
        is_set = {*changes, *trial.file.set}
        chosen = {
            key: value
            for key, value in values.items()
            if not any(key == name or key.startswith(f"{name}.") for name in is_set)
        }
    finally:
        system.discard()
    notes.append(
        f"{found[0].name} starts from the log: "
        + ", ".join(
            f"{key.rpartition('_start.')[2]} = {value:.4g}" for key, value in chosen.items()
        )
    )
    own = tuple((key, value, "the log") for key, value in chosen.items())
    return replace(trial, overrides=(*own, *trial.overrides))


def _with_criteria(trial: Trial, checks: Sequence[str]) -> Trial:
    entries = [CriterionEntry(name=check, check=check) for check in checks]
    file = trial.file.model_copy(update={"criteria": [*trial.file.criteria, *entries]})
    parsed = tuple((check, parse(check)) for check in checks)
    return replace(trial, file=file, criteria=(*trial.criteria, *parsed))


def window_of(traces: Mapping[str, Trace], needed: list[str], window: Window, where: str) -> Window:
    """Return the part of the log's time, s, in which the traces ``needed`` have values.

    Raises InputError for traces without a time in common.
    """
    kept = [traces[name] for name in needed] or list(traces.values())
    first = max(window[0], *(float(each.time[0]) for each in kept))
    last = min(window[1], *(float(each.time[-1]) for each in kept))
    if first >= last:
        spans = "; ".join(
            f"{each.name}: {each.time[0]:g} s to {each.time[-1]:g} s" for each in kept
        )
        raise InputError(f"{where}: no time is common to {spans}")
    return first, last


_FITTED = 20.0
"""Longest time over which the first velocity is found, s; at most a tenth of the record is."""
_FEWEST = 6
"""Rows of the shortest part."""
_ROUNDING = 1e-9
"""m and rad."""
_PLACES: Mapping[str, tuple[str, ...]] = {
    "north": ("position_start.x", "eta_start.x"),
    "east": ("position_start.y", "eta_start.y"),
    "heading": ("attitude_start.psi", "eta_start.psi"),
    "u": ("velocity_start.u", "nu_start.u"),
    "v": ("velocity_start.v", "nu_start.v"),
    "r": ("rates_start.r", "nu_start.r"),
    "depth": ("position_start.z", "eta_start.z"),
}
"""Parameters of craft that are the state at the start, as they call them."""


def crafts(system: System) -> list[Part]:
    """Return the components that are craft whose state at the start can be set."""
    return [
        part for part in system.parts.values()
        if any(name in part.instance.variables for name in _PLACES["heading"])
        and "attitude.psi" in part.instance.variables
    ]  # fmt: skip


def first_state(motion: Mapping[str, Trace], window: tuple[float, float]) -> dict[str, float]:
    """Return position, heading and velocity at the begin of a window, SI, as far as they are known.

    Velocities are those of a polynomial of degree 2 through the beginning, at most 20 s or a tenth
    of the record, as far as that follows. Those over ground are taken for those through the water.
    """
    first, last = window
    length = min(_FITTED, 0.1 * (last - first))
    found = {what: motion[what] for what in ("north", "east", "heading") if what in motion}
    fits = {what: _fit(each, first, length) for what, each in found.items()}
    state = {what: fit[0] for what, fit in fits.items()}
    if "depth" in motion:
        state["depth"] = float(motion["depth"].at(np.array([first]))[0][0])
    if "heading" in fits:
        state["r"] = fits["heading"][1]
    if fits.keys() == {"north", "east", "heading"}:
        psi, v_n, v_e = state["heading"], fits["north"][1], fits["east"][1]
        state["u"] = v_n * np.cos(psi) + v_e * np.sin(psi)
        state["v"] = v_e * np.cos(psi) - v_n * np.sin(psi)
    elif "speed" in motion:
        state["u"] = float(motion["speed"].at(np.array([first]))[0][0])
    return {what: float(value) for what, value in state.items()}


def _fit(each: Trace, first: float, length: float) -> tuple[float, float]:
    """Return value and slope at ``first``, of the longest part that a polynomial follows.

    That is a part whose residual is not larger than one and a half times the noise.
    """
    elapsed, values = each.time - first, each.values
    inside = (elapsed >= 0.0) & (elapsed <= length)
    elapsed, values = elapsed[inside], values[inside]
    counts: list[int] = []
    while len(elapsed) >> len(counts) >= _FEWEST:
        counts.append(len(elapsed) >> len(counts))
    if not counts:
        return float(each.at(np.array([first]))[0][0]), 0.0
    most = 1.5 * _noise(each.values) + _ROUNDING
    for count in counts:
        fitted = np.polyfit(elapsed[:count], values[:count], 2)
        left = values[:count] - np.polyval(fitted, elapsed[:count])
        if np.sqrt(np.sum(left**2) / (count - 3)) <= most or count == counts[-1]:
            break
    return float(fitted[2]), float(fitted[1])


def _noise(values: Array) -> float:
    """Return the standard deviation of white noise in values, by their second differences."""
    if len(values) < _FEWEST:
        return 0.0
    # Those of white noise have six times its variance; 0.6745 is the median of |x| for N(0, 1).
    return float(np.median(np.abs(np.diff(values, 2))) / (0.6745 * np.sqrt(6.0)))


def settings(craft: Part, state: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters of a craft that are its state at the start, by component.port."""
    found: dict[str, float] = {}
    for what, value in state.items():
        for name in _PLACES[what]:
            if name in craft.instance.variables:
                found[f"{craft.name}.{name}"] = value
    return found
