"""The picture that `seatrial drive` shows: heading, depth, attitude, thrust, state of the link."""

from __future__ import annotations

import math
from typing import Any

from rich.columns import Columns
from rich.console import Group
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from seatrial.model.component import Component

from .pilot import HELP, Pilot

_TAPE = 61
_PER_DEGREE = 0.5
"""Characters of the heading tape per degree."""
_NAMES = {0: "N", 45: "NE", 90: "E", 135: "SE", 180: "S", 225: "SW", 270: "W", 315: "NW"}
_HORIZON_WIDTH, _HORIZON_HEIGHT = 31, 11
_ROW_DEGREES = 5.0
_ASPECT = 2.0
"""A character is about twice as high as wide."""


def picture(topside: Component, pilot: Pilot, manual: tuple[float, float, float]) -> Any:
    """Return what is shown, for a terminal of 80 columns and 24 rows."""
    phi, theta, psi = topside.get("attitude")
    if not topside.get("connected"):
        link = Text(f"no vehicle ({topside.get('phase')})", style="bold red")
    else:
        link = Text(f"vehicle {topside.get('serial_number')}", style="green")
    state = Text("ARMED", style="bold white on red") if pilot.armed else Text("disarmed")
    head = Text.assemble(link, "   ", state)
    body = Columns(
        [
            Panel(horizon(phi, theta), title="attitude", width=_HORIZON_WIDTH + 4),
            Panel(_values(topside, pilot, manual), title="vehicle", width=43),
        ],
        padding=(0, 0),
    )
    return Group(head, tape(psi, pilot), body, _help())


def tape(psi: float, pilot: Pilot) -> Text:
    """Return a strip of the compass card around the heading, ``psi`` rad; ^ is the heading."""
    heading = math.degrees(psi) % 360.0
    card, middle = [" "] * _TAPE, _TAPE // 2
    for degrees in range(0, 360, 15):
        place = middle + round(((degrees - heading + 180.0) % 360.0 - 180.0) * _PER_DEGREE)
        label = _NAMES.get(degrees, "·" if degrees % 30 else f"{degrees:03}")
        begin = place - len(label) // 2
        if begin >= 0 and begin + len(label) <= _TAPE:
            card[begin : begin + len(label)] = label
    pointer = [" "] * _TAPE
    pointer[middle] = "^"
    if pilot.hold_heading:
        wanted = math.degrees(pilot.heading_wanted)
        off = round(((wanted - heading + 180.0) % 360.0 - 180.0) * _PER_DEGREE)
        if abs(off) <= middle:
            pointer[middle + off] = "o" if off else "◎"
    return Text(f"{''.join(card)}\n{''.join(pointer)}\n{f'{heading:05.1f}°':^{_TAPE}}")


def horizon(phi: float, theta: float) -> Text:
    """Return an artificial horizon: water below the line; ``phi`` and ``theta`` rad."""
    rows = []
    for row in range(_HORIZON_HEIGHT):
        line = ""
        for column in range(_HORIZON_WIDTH):
            x = (column - _HORIZON_WIDTH // 2) / _ASPECT
            y = row - _HORIZON_HEIGHT // 2
            # Starboard down: the horizon's starboard end goes up; bow up: the horizon goes down.
            below = y * math.cos(phi) + x * math.sin(phi) - math.degrees(theta) / _ROW_DEGREES
            line += "─" if abs(below) < 0.5 else ("░" if below > 0 else " ")
        rows.append(line)
    middle, centre = _HORIZON_HEIGHT // 2, _HORIZON_WIDTH // 2
    rows[middle] = rows[middle][: centre - 3] + "──┼──" + rows[middle][centre + 2 :]
    return Text("\n".join(rows))


def _values(topside: Component, pilot: Pilot, manual: tuple[float, float, float]) -> Table:
    table = Table.grid(padding=(0, 1))
    phi, theta, _ = (math.degrees(angle) for angle in topside.get("attitude"))
    depth = f"{topside.get('depth'):.2f} m"
    if pilot.hold_depth:
        depth += f"   hold {pilot.depth_wanted:.2f} m"
    heading = "-"
    if pilot.hold_heading:
        heading = f"hold {math.degrees(pilot.heading_wanted):.0f}°"
    water = topside.get("water_temperature") - 273.15
    rows = (
        ("depth", depth),
        ("heading", heading),
        ("roll, pitch", f"{phi:+.1f}°  {theta:+.1f}°"),
        ("water", f"{water:.1f} °C   inside {topside.get('humidity'):.0%}"),
        ("ahead", bar(manual[0])),
        ("turn", bar(manual[1])),
        ("down", bar(manual[2])),
        ("keys make", f"{pilot.share:.0%}   power {topside.get('power'):.0%}"),
        ("lights", f"{pilot.lights:.0%}   tilt {math.degrees(pilot.camera_tilt):+.0f}°"),
        ("link", f"{topside.get('round_trip') * 1e3:.1f} ms   missed {topside.get('missed')}"),
    )
    for name, value in rows:
        table.add_row(Text(name, style="dim"), value)
    return table


def bar(share: float) -> str:
    """Return a deflection as a bar, -1 to 1."""
    cells = ["·"] * 21
    cells[10] = "│"
    length = round(abs(share) * 10)
    for number in range(1, length + 1):
        cells[10 + (number if share > 0 else -number)] = "█"
    return f"{''.join(cells)} {share:+.0%}"


def _help() -> Text:
    text = Text(style="dim")
    width = 0
    for key, what in HELP:
        entry = f"{key}: {what}"
        if width + len(entry) + 3 > 78:
            text.append("\n")
            width = 0
        elif width:
            text.append("   ")
            width += 3
        text.append(key, style="bold")
        text.append(f": {what}")
        width += len(entry)
    return text
