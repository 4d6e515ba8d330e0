"""The report of a run: one self-contained page with verdicts, plots, parameters and timing."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from ...files.whole_file import write_whole
from ...kits import lacking
from ...model.readable import from_si, number, person_scale
from ...plugins import Registry
from ...system.paths import split_axis, split_path
from ..criteria.expressions import FloatArray
from ..records.run_folder import Run, load_run
from ..running.convergence import load_convergence
from ..running.lost_links import lost_links
from .accuracy_section import accuracy_section
from .autopilot_section import add_estimate, autopilot_rows
from .decks import deck, pads
from .diagram import diagram
from .event_marks import events_of, happenings
from .figure import DARK
from .metrics_section import metrics_figure, metrics_of
from .parameter_tables import parameter_tables, value_text
from .plotly_js import plotly_js
from .plots import MAX_POINTS, Line, Mark, Panel, deck_figure, time_figure, track_figure
from .sea_section import sea_figures
from .templates import environment
from .tethers import tether_figures
from .thinning import thinned
from .timing_section import pacing, step_times
from .wind_and_marks import add_wind_and_marks

REPORT = "report.html"
_MOTION = ("position", "attitude")
_FORCE_UNITS = ("N", "N.m")
_TEXT_ROWS = 20
_POINTS = 55_000
"""Points of all signals in a page, of 10 bytes each; those of the trial's plots come again."""
_FEWEST_POINTS = 500
_MOST_DRAWN = 500
"""Signals of one component that are drawn below "Other signals"."""
_MOST_COLUMNS = 3
"""Panels side by side: narrower ones do not hold their titles."""


@dataclass(frozen=True)
class Played:
    """A run in three dimensions: what its viewer, a page of its own, is given."""

    data: str
    """The recording, in base64."""
    speed: float
    """Simulated seconds per second at which it is played."""
    viewer: str
    """JavaScript that has the viewer as the text ``seatrialViewer``."""


Play = Callable[[Run], Played | None]
"""Returns a run to be played in its report; None of one without anything to see."""


@dataclass(frozen=True)
class Section:
    """A heading with a figure, tables of text signals, or both."""

    title: str
    figure: str | None
    """JSON for Plotly."""
    texts: Sequence[TextSignal] = ()
    folded: bool = False
    left: int = 0
    """Signals that are not drawn: there are too many."""


@dataclass(frozen=True)
class TextSignal:
    """A signal that holds text: its first changes, as (time, value)."""

    name: str
    changes: Sequence[tuple[str, str]]
    more: int
    """Changes that are not listed."""


@dataclass(frozen=True)
class Port:
    """The recorded scalars of one port."""

    component: str
    name: str
    signals: tuple[str, ...]

    def axis(self, signal: str) -> str:
        """Return a signal's name within the port."""
        return signal.removeprefix(f"{self.component}.{self.name}").lstrip(".") or self.name


SECTIONS = Registry("seatrial.sections", "section of reports", {})
"""Functions of kits: of a run, title and figure (JSON for Plotly) of each further section."""
_OWN_TABLES = ("step_times", "lost_links")
"""What ``timing.json`` has that is shown apart."""


def write_report(
    folder: Path | str,
    library: str | None = None,
    play: Play | None = None,
    viewer: str | None = None,
    run: Run | None = None,
) -> Path:
    """Write ``report.html`` into a run folder and return its path. Raises InputError.

    ``run`` is that of the folder, where it is in memory already.

    The page has Plotly's JavaScript in it, or takes it from the address ``library``, relative to
    it: pages of a campaign share one, and likewise the ``viewer`` of what ``play`` returns.
    """
    run = run or load_run(folder)
    drawn = thinned(run)
    played = None if play is None else play(drawn)
    convergence = load_convergence(run.folder)
    metrics = metrics_of(run)
    page = render(
        "report.html.j2",
        library=library,
        run=run,
        played=played,
        viewer=viewer,
        manifest=run.manifest,
        title=run.manifest["trial"].get("title") or run.name,
        verdicts=run.verdicts,
        metrics=metrics,
        metrics_figure=metrics_figure(run, metrics),
        sections=list(_sections(drawn)),
        parameters=list(parameter_tables(run)),
        timing=list(_flat({k: v for k, v in run.timing.items() if k not in _OWN_TABLES})),
        step_times=step_times(run.timing),
        pacing=pacing(run.timing),
        lost_links=lost_links(run.timing),
        autopilot=autopilot_rows(run),
        accuracy=None if convergence is None else accuracy_section(convergence),
        happenings=happenings(run),
        diagram=_diagram(run.manifest),
    )
    path = run.folder / REPORT
    write_whole(path, page)
    return path


def _diagram(manifest: Mapping[str, Any]) -> str | None:
    components = {name: entry["fmu"] for name, entry in manifest["components"].items()}
    try:
        return diagram(components, [(row[0], row[1]) for row in manifest["connections"]])
    except ImportError as error:
        if (said := lacking(error)) is None:
            raise
        return f"<p>No diagram: {escape(said)}</p>"


def render(template: str, library: str | None = None, **content: Any) -> str:
    """Return a page from a template of this package; ``content`` is escaped there.

    It has Plotly's JavaScript in it, unless ``library`` is its address.
    """
    content["plotly_js"] = "" if library else plotly_js()
    return environment().get_template(template).render(library=library, dark=DARK, **content)


# ---------------------------------------------------------------------- sections


def _sections(run: Run) -> Iterator[Section]:
    """Yield what a person looks at first, then every other signal by component."""
    ports = list(_ports(run))
    numeric = [port for port in ports if _is_uniform(run, port)]
    craft = {port.component for port in numeric if port.name in _MOTION}
    motion = [p for p in numeric if p.name in _MOTION]
    units = {p: run.units[p.signals[0]] for p in numeric}
    # A vector has three axes at most: the speeds of four rotors are no motion of the craft.
    moved = [p for p in numeric if p.component in craft and len(p.signals) <= 3]
    speeds = [p for p in moved if units[p] in ("m/s", "rad/s")]
    whole = set(numeric)
    forces = _first([p for p in numeric if units[p] in _FORCE_UNITS], _MOST_DRAWN)
    forces = [p for p in forces if p in whole]

    pads_found = pads(run.manifest)
    if pads_found:
        points = [(pad.component, pad, run.passed) for pad in pads_found]
        figure = deck_figure([deck("", points)])
        yield Section("The deck from above", figure.json())
    plots = run.manifest.get("plots", [])  # manifests of before have none
    if plots:
        drawn = [(p["title"], [s for s in p["signals"] if _is_number(run, s)]) for p in plots]
        shown_first = [
            _labelled_panel(run, title, {s: s for s in signals})
            for title, signals in drawn
            if signals
        ]
        if shown_first:
            yield Section("What the trial shows", _over_time(run, [shown_first]))
    for title, chosen in (("Motion", motion), ("Velocities", speeds)):
        for components in _alike_craft(run, chosen):
            own = [p for p in chosen if p.component == components[0]]
            panels = [
                [_panel_of_all(run, p, s, components) for s in _moving(run, p, components)]
                for p in own
            ]
            yield Section(f"{title} of {' and '.join(components)}", _over_time(run, panels))
    tracks = list(_tracks(run, motion))
    if tracks:
        figure = track_figure(tracks)
        add_wind_and_marks(figure, run)
        add_estimate(figure, run)
        yield Section("Track from above", figure.json())
    for name, shape in tether_figures(run):
        yield Section(f"Shape of {name}", shape.json())
    for title, figure in sea_figures(run):
        yield Section(title, figure.json())
    if forces:
        columns = [
            [_panel(run, p, p.signals) for p in forces if units[p] == u] for u in _FORCE_UNITS
        ]
        yield Section("Forces and moments", _over_time(run, [c for c in columns if c]))
    for name in SECTIONS.names():
        yield from (Section(title, figure) for title, figure in SECTIONS.load(name)(run))
    shown = {*motion, *speeds, *forces}
    yield from _rest(run, [p for p in ports if p not in shown])


def _rest(run: Run, ports: Sequence[Port]) -> Iterator[Section]:
    for component in dict.fromkeys(p.component for p in ports):
        own = [p for p in ports if p.component == component]
        left = sum(len(port.signals) for port in own)
        own = _first(own, _MOST_DRAWN)
        left -= sum(len(port.signals) for port in own)
        texts = [
            _text_signal(run, signal)
            for port in own
            for signal in port.signals
            if isinstance(run.signals[signal], list)
        ]
        panels = [p for port in own for p in _panels_by_unit(run, port)]
        columns = [column for column in (panels[::2], panels[1::2]) if column]
        figure = _over_time(run, columns) if columns else None
        yield Section(f"Other signals of {component}", figure, texts, folded=True, left=left)


def _first(ports: Iterable[Port], signals: int) -> list[Port]:
    """Return as many of some ports' signals, in their order."""
    found = []
    for port in ports:
        found.append(replace(port, signals=port.signals[: max(signals, 0)]))
        signals -= len(port.signals)
    return [port for port in found if port.signals]


def _ports(run: Run) -> Iterator[Port]:
    grouped: dict[tuple[str, str], list[str]] = {}
    for signal in run.signals:
        component, rest = split_path(run.manifest["components"], signal)
        grouped.setdefault((component, split_axis(rest)[0]), []).append(signal)
    for (component, name), signals in grouped.items():
        yield Port(component, name, tuple(signals))


def _is_number(run: Run, signal: str) -> bool:
    """Return whether a signal was recorded and is numbers: a run that failed may lack it."""
    return signal in run.signals and not isinstance(run.signals[signal], list)


def _is_uniform(run: Run, port: Port) -> bool:
    """Return whether all of a port is numbers in one unit."""
    has_text = any(isinstance(run.signals[signal], list) for signal in port.signals)
    return not has_text and len({run.units[signal] for signal in port.signals}) == 1


def _panels_by_unit(run: Run, port: Port) -> Iterator[Panel]:
    numeric = [s for s in port.signals if not isinstance(run.signals[s], list)]
    for unit in dict.fromkeys(run.units[s] for s in numeric):
        yield _panel(run, port, tuple(s for s in numeric if run.units[s] == unit))


def _panel(run: Run, port: Port, signals: Sequence[str]) -> Panel:
    """Return the signals, all of one unit, in one panel with the limits set on them."""
    title = signals[0] if len(signals) == 1 else f"{port.component}.{port.name}"
    return _labelled_panel(run, title, {s: port.axis(s) for s in signals})


def _panel_of_all(run: Run, port: Port, signal: str, components: Sequence[str]) -> Panel:
    """Return a signal of a port together with that of alike components, if there are others."""
    if len(components) == 1:
        return _panel(run, port, (signal,))
    rest = signal.removeprefix(f"{port.component}.")
    return _labelled_panel(run, rest, {f"{name}.{rest}": name for name in components})


def _labelled_panel(run: Run, title: str, signals: Mapping[str, str]) -> Panel:
    """Return a panel of signals, all of one unit, by the label of each, with their limits."""
    factor, unit = person_scale(run.units[next(iter(signals))])
    values = {label: run.signals[s] for s, label in signals.items()}
    if run.units[next(iter(signals))] == "rad" and any(map(_goes_round, values.values())):
        title += " (turns counted)"
        values = {label: np.unwrap(v) for label, v in values.items()}
    lines = [Line(label, v * factor) for label, v in values.items()]
    marks = [
        Mark(
            f"{'limit' if kind != 'band' else kind} of {verdict['name']}",
            from_si(value, unit),
            is_band=kind == "band",
        )
        for verdict in run.verdicts
        for signal, value, kind in verdict["limits"]
        if signal in signals
    ]
    return Panel(title, unit, lines, marks)


def _goes_round(angle: FloatArray) -> bool:
    """Return whether an angle, rad, jumps from one end of its circle to the other."""
    return bool(np.isfinite(angle).all() and np.any(np.abs(np.diff(angle)) > np.pi))


def _moving(run: Run, port: Port, components: Sequence[str]) -> list[str]:
    """Return a port's signals without those that stay at 0 in all components: ships have no heave.

    All of them if all are.
    """
    rests = {signal: signal.removeprefix(port.component) for signal in port.signals}
    moving = [s for s in rests if any(np.any(run.signals[c + rests[s]]) for c in components)]
    return moving or list(port.signals)


def _alike_craft(run: Run, ports: Iterable[Port]) -> list[list[str]]:
    """Return the components of some ports; those of one FMU with the same signals go together."""
    signals: dict[str, list[str]] = {}
    for port in ports:
        own = signals.setdefault(port.component, [])
        own += [signal.removeprefix(port.component) for signal in port.signals]
    groups: dict[tuple[str, ...], list[str]] = {}
    for component, own in signals.items():
        fmu = run.manifest["components"].get(component, {}).get("fmu", component)
        groups.setdefault((fmu, *own), []).append(component)
    return list(groups.values())


def _over_time(run: Run, columns: Sequence[Sequence[Panel]]) -> str:
    points = points_of_a_line(len(run.signals))
    placed = [list(column) for column in columns[:_MOST_COLUMNS]]
    for column in columns[_MOST_COLUMNS:]:
        min(placed, key=len).extend(column)
    return time_figure(run.time, placed, events_of(run), points).json()


def points_of_a_line(signals: int) -> int:
    """Return how many points a line may have in a page of so many signals."""
    return min(max(_POINTS // max(signals, 1), _FEWEST_POINTS), MAX_POINTS)


def _tracks(run: Run, motion: Iterable[Port]) -> Iterator[tuple[str, Any, Any]]:
    for port in motion:
        north, east = (f"{port.component}.position.{axis}" for axis in "xy")
        if port.name == "position" and {north, east} <= set(port.signals) and len(run.time):
            yield port.component, run.signals[north], run.signals[east]


def _text_signal(run: Run, signal: str) -> TextSignal:
    values: list[str] = run.signals[signal]
    changes = [
        (number(run.time[row], 9), value[:200])
        for row, value in enumerate(values)
        if row == 0 or value != values[row - 1]
    ]
    return TextSignal(signal, changes[:_TEXT_ROWS], max(0, len(changes) - _TEXT_ROWS))


# ---------------------------------------------------------------------- tables


def _flat(content: Any, prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield the leaves of nested tables as (path, text); figures show the histograms."""
    if isinstance(content, dict) and "bins" in content:
        return
    if isinstance(content, dict):
        for key, value in content.items():
            yield from _flat(value, f"{prefix}.{key}" if prefix else str(key))
    else:
        yield prefix, value_text(np.round(content, 6) if isinstance(content, float) else content)
