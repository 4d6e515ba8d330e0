"""Options of ``seatrial run`` alone."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

RealTime = Annotated[
    float | None,
    typer.Option(metavar="FACTOR", help="In real time: simulated seconds per second of it."),
]
Overrun = Annotated[
    str | None, typer.Option(metavar="POLICY", help="In real time: 'catch-up', 'slip' or 'abort'.")
]
Record = Annotated[
    str,
    typer.Option(
        metavar="LEVEL",
        help="What is recorded: 'all' outputs, as the 'trial' says, or what 'criteria' and "
        "plots need.",
    ),
]
Junit = Annotated[
    Path | None, typer.Option("--junit", metavar="FILE", help="Write a JUnit file, too.")
]
Jobs = Annotated[
    int | None,
    typer.Option(
        metavar="N", min=1, help="Cases of a campaign side by side (default: every core)."
    ),
]
Resume = Annotated[
    bool,
    typer.Option("--resume", help="Go on with a campaign that was stopped, in --out's folder."),
]
RerunChanged = Annotated[
    bool,
    typer.Option(
        "--rerun-changed", help="With --resume: run again the cases whose files have changed."
    ),
]
Live = Annotated[
    bool, typer.Option("--live", help="Show the run in three dimensions, in a browser, as it goes.")
]
Port = Annotated[
    int, typer.Option("--port", metavar="N", min=0, max=65535, help="Port (0: any that is free).")
]
Open = Annotated[bool, typer.Option("--open", help="Open the page in a browser.")]
LiveControl = Annotated[
    bool,
    typer.Option(
        "--live-control", help="With --hardware: the page may command, too, and not only watch."
    ),
]
Limit = Annotated[
    list[str] | None,
    typer.Option(
        metavar="KEY=VALUE",
        help="End a run beyond 'wall' time, 'memory', or wall time of a 'call' without progress: "
        "wall='60 s', memory='1 GB', call=none.",
    ),
]
KeepGoing = Annotated[
    bool, typer.Option("--keep-going", help="With --hardware: go on without a link that is lost.")
]
Twice = Annotated[
    bool,
    typer.Option(
        "--twice",
        help="Repeat the run, or five cases of a campaign, and name what differs; status 1 if "
        "anything does.",
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Run a campaign on the workers of a Dask scheduler, HOST:PORT or tls://HOST:PORT.",
    ),
]
KeepName = Annotated[
    str | None,
    typer.Option(
        metavar="WHICH",
        help="Leave a table of a campaign, with the run folders of 'all', 'failed' or 'none'.",
    ),
]
NoReport = Annotated[
    bool, typer.Option("--no-report", help="Write no report: seatrial report makes it.")
]
