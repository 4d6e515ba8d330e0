"""``seatrial play``: a run in three dimensions, played back in a browser."""

from __future__ import annotations

import webbrowser
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from seatrial.cli.answer import answer
from seatrial.cli.running.run_options import Open, Port
from seatrial.cli.show import console
from seatrial.cli.stopping import stoppable
from seatrial.errors import InputError
from seatrial.plugins import service
from seatrial.trial.records.run_folder import load_run


def play(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")],
    ghost: Annotated[
        Path | None, typer.Argument(metavar="[RUN2]", help="A second run, shown as a ghost.")
    ] = None,
    port: Port = 0,
    open_: Open = False,
    ros2: Annotated[
        bool, typer.Option("--ros2", help="No page: to nodes of ROS 2, in real time.")
    ] = False,
) -> None:
    """Play a run back in three dimensions, in a browser, or to nodes of ROS 2."""
    if ros2:
        _play_to_nodes(folder, ghost)
        return
    from .playback import Playback
    from .server import PageServer

    run = load_run(folder)
    other = None if ghost is None else load_run(ghost)
    server = PageServer(port)
    try:
        playback = Playback(server, run, other)
        show_address(server.address, open_)
        with stoppable() as stop:
            playback.run(stop.requested)
    finally:
        server.stop()
    show_refused(server.gate.refused)


def _play_to_nodes(folder: Path, ghost: Path | None) -> None:
    if ghost is not None:
        raise InputError(f"--ros2 plays one run; {ghost} is a second one")
    run = load_run(folder)
    with stoppable() as stop:
        written = service("ros2.play")(run, stop.requested)
    answer.result = {"messages": written}
    console.print(f"{written} messages")


def show_address(address: str, open_: bool) -> None:
    """Say where a page is, and open it if that is wanted."""
    answer.result = {"page": address}
    console.print(f"page: {address}  (Ctrl-C ends it)", soft_wrap=True)
    if open_:
        webbrowser.open(address)


def show_refused(counts: Mapping[str, int]) -> None:
    """Say how much was sent to a page that is not of its viewers, or that no widget sends."""
    if counts:
        said = ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
        console.print(f"page: refused {said}")
