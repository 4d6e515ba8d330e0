"""Table and page of a motion plan."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from seatrial.files.whole_file import write_whole
from seatrial.model.expressions import Vector
from seatrial.model.readable import number
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, layout
from seatrial.trial.reports.report import REPORT, render
from seatrial.trial.running.output import claim_folder

from .motion import MotionPlan

TABLE = "plan.csv"
_HEADER = ("time", "U", "V", "R", "t1", "t2", "x", "y", "psi")
_LIMIT = {"color": "#b3261e", "width": 1.2, "dash": "dot"}


def write_plan(plan: MotionPlan, out: Path | None) -> Path:
    """Write table and page into a new folder (None: ``runs/VEHICLE-plan-DATE-TIME``), return it.

    Raises InputError if ``out`` is something already.
    """
    folder = claim_folder(out, f"{plan.vehicle}-plan", REPORT)
    write_whole(folder / TABLE, _table(plan))
    page = render(
        "plan.html.j2",
        title=f"Motion of {plan.vehicle}" + (f", variant {plan.variant}" if plan.variant else ""),
        verdicts=verdicts(plan),
        settings=settings(plan),
        table=TABLE,
        velocities=_over_time(plan, plan.velocity, ("U, m/s", "V, m/s", "R, rad/s")).json(),
        commands=_commands(plan).json(),
        track=_track(plan).json(),
    )
    write_whole(folder / REPORT, page)
    return folder


def verdicts(plan: MotionPlan) -> list[tuple[bool, str]]:
    """Return whether thrusters can do it and the flatness law can track it, and the figures."""
    peak = f"largest command {number(plan.peak, 4)}, limit {number(plan.limit, 4)}"
    until = plan.flat_until
    crossed = "keeps its sign" if until is None else f"is 0 or crosses it at {number(until, 4)} s"
    return [
        (plan.feasible, f"the thrusters can do it: {peak}"),
        (until is None, f"the flatness law can track it: l U m11 - R m33 {crossed}"),
    ]


def settings(plan: MotionPlan) -> list[str]:
    """Return the lines of a trial that give the plan to a law of the rig videoray-surface."""
    lines = [
        f'"law.surge" = "{plan.surge.value!r} m/s"',
        f'"law.yaw_rate" = "{plan.yaw.value!r} rad/s"',
    ]
    for axis, profile in (("surge", plan.surge), ("yaw", plan.yaw)):
        if profile.duration:
            lines.append(f'"law.{axis}_profile" = "polynomial"')
    if plan.duration:
        lines.append(f'"law.duration" = "{plan.duration!r} s"')
    return lines


def _table(plan: MotionPlan) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_HEADER)
    for k, t in enumerate(plan.time.tolist()):
        values = (plan.velocity[k], plan.command[k], plan.track[k])
        writer.writerow([round(t, 9), *(value for row in values for value in row.tolist())])
    return text.getvalue()


def _over_time(plan: MotionPlan, columns: Vector, names: tuple[str, ...]) -> Figure:
    figure = Figure()
    for index, name in enumerate(names):
        figure.trace(
            "scatter",
            x=plan.time,
            y=columns[:, index],
            name=name,
            mode="lines",
            line={"width": 1.8, "color": COLOURS[index % len(COLOURS)]},
        )
    figure.x_axis(title={"text": "time, s"})
    figure.lay_out(height=380, showlegend=True, **layout())
    return figure


def _commands(plan: MotionPlan) -> Figure:
    figure = _over_time(plan, plan.command, ("t1", "t2"))
    if plan.peak > plan.limit / 10.0:  # further away it would flatten the lines
        for sign in (1.0, -1.0):
            figure.horizontal(sign * plan.limit, line=_LIMIT)
    figure.y_axis(title={"text": "share of full thrust"})
    return figure


def _track(plan: MotionPlan) -> Figure:
    figure = Figure()
    figure.trace(
        "scatter",
        x=plan.track[:, 1],
        y=plan.track[:, 0],
        customdata=plan.time,
        mode="lines",
        line={"width": 1.8, "color": COLOURS[0]},
        hovertemplate="%{customdata:.1f} s: %{y:.3f} m north, %{x:.3f} m east",
    )
    figure.x_axis(title={"text": "east, m"})
    figure.y_axis(title={"text": "north, m"}, scaleanchor="x")
    figure.lay_out(height=480, showlegend=False, **layout(hovermode="closest"))
    return figure
