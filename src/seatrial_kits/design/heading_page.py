"""The page of a heading design: root loci, damping over the gain, and the gains found."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, layout
from seatrial.trial.reports.report import REPORT, render
from seatrial.trial.running.output import claim_folder

from .heading import GAINS, Gain, HeadingDesign, Locus, least_damping

_WINDOW = 3.0
"""Poles are drawn to this distance from the origin, in units of U / L."""
_LINE = {"color": "#b3261e", "width": 1.2}


@dataclass(frozen=True)
class Row:
    """A gain as the page and the terminal show it."""

    derivative_time: str
    K: str
    Kd: str
    poles: str
    damping: str


def write_design(design: HeadingDesign, out: Path | None) -> Path:
    """Write the page into a new folder (None: ``runs/VEHICLE-design-DATE-TIME``), return its path.

    Raises InputError if ``out`` is something already.
    """
    folder = claim_folder(out, f"{design.vehicle}-design", REPORT)
    page = render(
        "design.html.j2",
        title=f"Heading autopilot of {design.vehicle}"
        + (f", variant {design.variant}" if design.variant else ""),
        design=design,
        A=[[number(value, 6) for value in row] for row in design.A],
        B=[number(value, 6) for value in design.B],
        time_unit=number(design.time_unit, 6),
        zeta=number(design.damping_ratio, 5),
        rows=rows(design),
        stability=[(_time(locus), stability(locus)) for locus in design.loci],
        loci=_loci_figure(design).json(),
        damping=_damping_figure(design).json(),
    )
    path = folder / REPORT
    write_whole(path, page)
    return path


def rows(design: HeadingDesign) -> list[Row]:
    """Return every gain that the design singles out."""
    return [
        _row(design, locus, gain)
        for locus in design.loci
        for gain in (*locus.wanted, *locus.limits)
    ]


def stability(locus: Locus) -> str:
    """Return for which gains the loop is stable, in words."""
    stable, parts = locus.stable_at_first, []
    edges = [0.0, *(gain.K for gain in locus.limits), np.inf]
    for low, high in pairwise(edges):
        if stable:
            up_to = "" if np.isinf(high) else f" < {number(high, 9)}"
            parts.append(f"{number(low, 9)} < K{up_to}" if low or not up_to else f"K{up_to}")
        stable = not stable
    if parts == ["0 < K"]:
        return f"every K up to {GAINS[-1]:g}"
    return "no K" if not parts else " and ".join(parts)


def _row(design: HeadingDesign, locus: Locus, gain: Gain) -> Row:
    return Row(
        derivative_time=_time(locus),
        K=number(gain.K, 9),
        Kd=number(gain.K * locus.derivative_time * design.time_unit, 6),
        poles=", ".join(_pole_text(pole) for pole in gain.poles if pole.imag >= 0.0),
        damping="limit of stability" if gain in locus.limits else number(design.damping_ratio, 5),
    )


def _time(locus: Locus) -> str:
    return number(locus.derivative_time, 6)


def _pole_text(pole: complex) -> str:
    real = number(pole.real if abs(pole.real) > 1e-12 else 0.0, 6)
    return real if pole.imag == 0.0 else f"{real} ± {number(pole.imag, 6)}i"


def _loci_figure(design: HeadingDesign) -> Figure:
    titles = [f"<b>T<sub>d</sub> = {_time(locus)} L/U</b>" for locus in design.loci]
    figure = Figure(titles, gap=0.07)
    edge = _WINDOW * np.array([-design.damping_ratio, np.sqrt(1.0 - design.damping_ratio**2)])
    for col, locus in enumerate(design.loci, start=1):
        poles, gains = locus.poles.ravel(), np.repeat(GAINS, locus.poles.shape[1])
        near = np.abs(poles) < 2.0 * _WINDOW
        figure.trace(
            "scatter",
            x=poles.real[near],
            y=poles.imag[near],
            customdata=gains[near],
            mode="markers",
            marker={"size": 3.5, "color": np.log10(gains[near]), "colorscale": "Viridis"},
            hovertemplate="K = %{customdata:.4g}<br>%{x:.4f} + %{y:.4f} i",
            column=col,
        )
        for sign in (1.0, -1.0):
            figure.trace(
                "scatter",
                x=[0.0, edge[0]],
                y=[0.0, sign * edge[1]],
                mode="lines",
                line={**_LINE, "dash": "dot"},
                hoverinfo="skip",
                column=col,
            )
        for gain in [*locus.wanted, *locus.limits]:
            figure.trace(
                "scatter",
                x=gain.poles.real,
                y=gain.poles.imag,
                mode="markers",
                marker={"size": 11, "symbol": "x-thin", "line": {"width": 2, "color": "#1d2730"}},
                hovertemplate=f"K = {number(gain.K, 9)}<br>%{{x:.4f}} + %{{y:.4f}} i",
                column=col,
            )
        figure.vertical(0.0, line=_LINE, column=col)
        figure.x_axis(title={"text": "real part, U/L"}, range=[-_WINDOW, 1.0], column=col)
        figure.y_axis(range=[-2.0, 2.0], column=col)
    figure.y_axis(title={"text": "imaginary part, U/L"}, column=1)
    figure.lay_out(height=480, showlegend=False, **layout(hovermode="closest"))
    return figure


def _damping_figure(design: HeadingDesign) -> Figure:
    figure = Figure()
    for index, locus in enumerate(design.loci):
        figure.trace(
            "scatter",
            x=GAINS,
            y=[least_damping(poles) for poles in locus.poles],
            name=f"T<sub>d</sub> = {_time(locus)} L/U",
            mode="lines",
            line={"width": 1.8, "color": COLOURS[index % len(COLOURS)]},
            hovertemplate="K = %{x:.4g}: %{y:.4f}",
        )
    figure.horizontal(design.damping_ratio, line={**_LINE, "dash": "dot"})
    figure.horizontal(0.0, line=_LINE)
    figure.x_axis(title={"text": "gain K"}, type="log")
    figure.y_axis(title={"text": "least damping ratio"})
    figure.lay_out(height=400, showlegend=True, **layout(hovermode="closest"))
    return figure
