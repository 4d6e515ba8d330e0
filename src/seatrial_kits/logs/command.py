"""``seatrial export``: the record of a run for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatrial.cli.answer import answer
from seatrial.cli.show import console, print_notes
from seatrial.errors import InputError
from seatrial.trial.records.run_folder import load_run

from .mcap_file import write_mcap
from .parquet_file import write_parquet
from .ros2_bag import write_ros2_bag


def export(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")],
    mcap: Annotated[bool, typer.Option("--mcap", help="For Foxglove and PlotJuggler.")] = False,
    parquet: Annotated[
        bool, typer.Option("--parquet", help="For pandas, DuckDB, MATLAB; needs pyarrow.")
    ] = False,
    ros2: Annotated[
        bool, typer.Option("--ros2", help="A ROS 2 bag, with MCAP inside; needs rosbags.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="The file, or the bag (default: in the run's)."),
    ] = None,
) -> None:
    """Write the record of a run as MCAP, Parquet or a ROS 2 bag."""
    if [mcap, parquet, ros2].count(True) != 1:
        raise InputError("export needs one of --mcap, --parquet and --ros2")
    run = load_run(folder)
    print_notes(run.notes)
    write, name = (
        (write_mcap, "signals.mcap")
        if mcap
        else (write_parquet, "signals.parquet")
        if parquet
        else (write_ros2_bag, "ros2")
    )
    path = out or folder / name
    write(run, path)
    size = sum(file.stat().st_size for file in (path.iterdir() if path.is_dir() else [path]))
    answer.result = {"file": str(path), "bytes": size}
    console.print(f"{path}  ({size / 1000:.0f} kB)", soft_wrap=True)
