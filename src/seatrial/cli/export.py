"""``seatrial export``: the record of a run for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from ..trials.logs.mcap_file import write_mcap
from ..trials.logs.parquet_file import write_parquet
from ..trials.run_folder import load_run
from .answer import answer
from .show import console, print_notes


def export(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")],
    mcap: Annotated[bool, typer.Option("--mcap", help="For Foxglove and PlotJuggler.")] = False,
    parquet: Annotated[
        bool, typer.Option("--parquet", help="For pandas, DuckDB, MATLAB; needs pyarrow.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="The file (default: in the run's folder).")
    ] = None,
) -> None:
    """Write the record of a run as an MCAP or a Parquet file."""
    if mcap == parquet:
        raise InputError("export needs one of --mcap and --parquet")
    run = load_run(folder)
    print_notes(run.notes)
    path = out or folder / ("signals.mcap" if mcap else "signals.parquet")
    (write_mcap if mcap else write_parquet)(run, path)
    answer.result = {"file": str(path), "bytes": path.stat().st_size}
    console.print(f"{path}  ({path.stat().st_size / 1000:.0f} kB)", soft_wrap=True)
