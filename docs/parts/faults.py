"""The catalogue of faults: what each is, its settings, and a plot of each on a known signal."""

from __future__ import annotations

from typing import Any

from parts import elsewhere, part
from parts.fault_plots import Line, drawn
from parts.markdown import table
from seatrial import Simulation
from seatrial.links import text
from seatrial.model.faults.catalogue import (
    COMPONENTS,
    DEVICES,
    KINDS,
    SIGNALS,
    STREAMS,
    Kind,
    Setting,
)
from seatrial.model.faults.operators import Moment, drawing
from seatrial.sim.streams import Stream
from seatrial.system.fault_entry import FaultEntry

BEGIN, END, STOP = 2.0, 7.0, 10.0
_ON = {
    "signal": "any port",
    "stream": "any port of bytes",
    "device": "a device",
    "measurement": "a measurement (`of`)",
    "bus": "a node of a CAN bus",
    "component": "any component",
}
_MEASURES = {
    "value": "in the port's unit, one or one for each axis",
    "rate": "in the port's unit per second, one or one for each axis",
    "duration": "a time",
    "number": "a number",
    "probability": "0 to 1",
    "coefficients": "five, in the port's unit",
    "range": "two, in the port's unit",
}
EXAMPLES: dict[str, dict[str, Any]] = {
    "fixed": {"value": 1.5},
    "bias": {"value": 0.8, "grows_over": "2 s"},
    "drift": {"rate": 0.3},
    "scale": {"factor": 0.3},
    "noise": {"value": 0.25},
    "deviation": {"coefficients": [0.2, 0.5, 0.3, 0.0, 0.0]},
    "stuck": {},
    "dropout": {"probability": 0.8, "every": "0.4 s"},
    "garbage": {"low": -1.0, "high": 1.5, "every": "0.3 s"},
    "delay": {"time": "1 s"},
    "lag": {"time": "1 s"},
    "rate-limit": {"rate": 0.4},
    "limit": {"low": -0.3, "high": 0.6},
    "runaway": {"value": -1.4, "rate": 0.8},
    "nan": {},
    "loss": {"probability": 0.5},
    "latency": {"time": "0.6 s", "jitter": "0.6 s"},
    "reorder": {"probability": 0.3, "time": "1.2 s"},
    "duplicate": {"probability": 0.4},
    "corruption": {"probability": 0.05},
    "hang": {},
    "crash": {},
    "power-loss": {},
}
"""Settings of what is drawn, each from 2 s to 7 s."""
_BUS = {"off": "sent.n2", "babbling": "load", "defective": "tec.n2"}
_SOURCE = '''
import math
from seatrial.model.component import Component, Input, Output

class Wave(Component):
    """y = sin t."""
    y = Output("m", "signal")
    def outputs(self, t):
        self.y = math.sin(t)

class Reader(Component):
    """y = u."""
    u = Input("m", "signal")
    y = Output("m", "signal")
    feedthrough = {"y": ("u",)}
    def outputs(self, t):
        self.y = self.u

class Clock(Component):
    """Counts the seconds since it began."""
    y = Output("s", "time since its start")
    def start(self, t):
        self.passed = 0.0
    def step(self, t, h):
        self.passed += h
    def outputs(self, t):
        self.y = self.passed
'''
_RIG = """step = "50 ms"
[components]
wave   = { fmu = "parts_of_plot.py:Wave" }
reader = { fmu = "parts_of_plot.py:Reader" }
clock  = { fmu = "parts_of_plot.py:Clock" }
depth  = { fmu = "depth", set = { depth_noise = 0, depth_instability = 0, period = 0.25 } }
[connections]
"wave.y" = ["reader.u", "depth.position.z"]
"""


def _settings(kind: Kind) -> str:
    return "<br>".join(
        f"`{name}`: {one.meaning}; {_MEASURES[one.measure]}{_default(one)}"
        for name, one in kind.settings.items()
    )


def _default(setting: Setting) -> str:
    if setting.default is None:
        return ""
    if setting.measure == "range":
        return " (optional)"
    unit = " s" if setting.measure == "duration" else ""
    return f" (default {setting.default:g}{unit})"


def _section(kinds: dict[str, Kind]) -> str:
    parts = []
    for name, kind in kinds.items():
        acts = ", ".join(_ON[on] for on in kind.on)
        grows = "; takes `grows_over`" if kind.grows else ""
        lines = [f"### {name}\n", f"{kind.title[0].upper()}{kind.title[1:]}.\n"]
        lines.append(f"**{kind.equation}**. Acts on {acts}{grows}.\n")
        if kind.settings:
            lines.append(_settings(kind) + "\n")
        lines.append(_plot(name) + "\n")
        parts.append("\n".join(lines))
    return "\n" + "\n".join(parts)


@part("fault-names")
def fault_names() -> str:
    """Every fault in a line."""
    return table(
        ("fault", "description", "acts on", "settings"),
        [
            (
                f"[`{name}`](#{name})",
                kind.title,
                ", ".join(_ON[on] for on in kind.on),
                ", ".join(f"`{key}`" for key in [*kind.settings, *(["grows_over"] * kind.grows)]),
            )
            for name, kind in KINDS.items()
        ],
    )


@part("fault-signals")
def fault_signals() -> str:
    """Faults of signals, drawn."""
    return _section(SIGNALS)


@part("fault-streams")
def fault_streams() -> str:
    """Faults of streams, drawn."""
    return _section(STREAMS)


@part("fault-devices")
def fault_devices() -> str:
    """Faults of whole devices, drawn."""
    return _section(DEVICES)


@part("fault-components")
def fault_components() -> str:
    """Faults of whole components, drawn."""
    return _section(COMPONENTS)


# ---------------------------------------------------------------------- plots


def _plot(name: str) -> str:
    if name in STREAMS:
        return _of_stream(name)
    if name in ("babbling", "defective"):
        return _of_bus(name)
    if name in COMPONENTS:
        return _of_rig(name, "clock", "clock.y", None, "s since its start")
    if name in DEVICES:
        return _of_rig(name, "depth", "depth.depth", "wave.y", "measured depth, m")
    shown = "wave.y" if name == "nan" else "reader.y"
    return _of_rig(name, "wave.y" if name == "nan" else "reader.u", shown, "wave.y", "y")


def _of_rig(name: str, where: str, shown: str, truth: str | None, label: str) -> str:
    with elsewhere() as folder:
        (folder / "parts_of_plot.py").write_text(_SOURCE, "utf-8")
        (folder / "rig.toml").write_text(_RIG, "utf-8")
        rows = []
        with Simulation(folder / "rig.toml") as sim:
            if name != "nan":  # what reads it would end the run
                sim.inject(name, where, at=BEGIN, for_=END - BEGIN, **EXAMPLES.get(name, {}))
            for _ in range(round(STOP / 0.1) + 1):
                y, x = sim.get(shown), sim.get(truth) if truth else sim.time
                lost = name == "nan" and BEGIN <= sim.time < END
                rows.append((sim.time, x, None if lost else y))
                sim.step(2)
    lines = [Line([(t, y) for t, _, y in rows])]
    if truth or name in COMPONENTS:
        lines.insert(0, Line([(t, x) for t, x, _ in rows], faint=True))
    return drawn(f"{name}: {label} over t, s", lines, (BEGIN, END), STOP)


def _of_bus(name: str) -> str:
    with Simulation("can-faults") as sim:
        sim.inject(name, "can.n3" if name == "babbling" else "can.n2", at=0.2, for_=0.5)
        points = []
        while sim.time < 1.0:
            sim.step(5)
            points.append((sim.time, float(sim.get(f"can.{_BUS[name]}"))))
    what = {"load": "load of the bus", "tec.n2": "its transmit error counter"}[_BUS[name]]
    return drawn(f"{name}: {what} over t, s", [Line(points)], (0.2, 0.7), 1.0)


def _of_stream(name: str) -> str:
    """Chunks as lines from when they were sent, above, to when they arrive, below."""
    entry = FaultEntry.model_validate({"what": name, "where": "x", **EXAMPLES[name]})
    operator = _operator(name, entry.settings)
    step, marks = 250_000_000, list[Line]()
    memory: Any = None
    begin, end = (round(t * 1e9) for t in (BEGIN, END))
    source: list[bytes] = []
    for k in range(round(STOP * 4) + 1):
        now = k * step
        moment = Moment(now, begin, 0, end if now >= end else None)
        source.append(bytes([k] * 4))
        sent = text.encode(k + 1, [(now, source[-1])])
        if memory is None:
            memory = operator.first(sent, Moment(now, now))._replace(source=0, number=0)
        before = memory.number
        memory = operator.after(memory, sent, moment, step)
        if memory.number == before:
            continue
        for when, data in text.decode(memory.shown)[1]:
            number = max(set(data), key=data.count)
            wrong = data not in source
            marks.append(Line([(number / 4, 1.0), (when / 1e9, -1.0)], faint=wrong))
    arrived = {round(mark.points[0][0] * 4) for mark in marks}
    lost = [k for k in range(len(source)) if k not in arrived and k / 4 < STOP - 2.0]
    marks += [Line([(k / 4, 1.0), (k / 4, 0.7)]) for k in lost]
    return drawn(f"{name}: chunks, sent above, arriving below, t in s", marks, (BEGIN, END), STOP)


def _operator(name: str, settings: dict[str, Any]) -> Stream:
    def ns(key: str) -> int:
        return round(float(str(settings.get(key, "0 s")).removesuffix(" s")) * 1e9)

    probability, draw = settings.get("probability", 1.0), drawing(1, name)
    match name:
        case "loss":
            return Stream(draw, loss=probability)
        case "latency":
            return Stream(draw, time_ns=ns("time"), jitter_ns=ns("jitter"))
        case "reorder":
            return Stream(draw, reorder=probability, held_ns=ns("time"))
        case "duplicate":
            return Stream(draw, duplicate=probability)
    return Stream(draw, bit_errors=probability)
