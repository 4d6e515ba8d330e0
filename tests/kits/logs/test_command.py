"""``seatrial export`` from the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from mcap.reader import make_reader
from pyarrow import parquet

from tests.command import seatrial
from tests.trials.conftest import write_run_folder


@pytest.fixture
def run(tmp_path: Path) -> Path:
    folder = write_run_folder(tmp_path / "run")
    manifest = folder / "manifest.json"
    manifest.write_text(manifest.read_text().replace('{"unit"', '{"type": "Real", "unit"'))
    return folder


def rows(folder: Path) -> int:
    return len((folder / "signals.csv").read_text().splitlines()) - 1


def test_a_record_as_mcap_and_as_parquet(run: Path, tmp_path: Path) -> None:
    done = seatrial("export", "run", "--mcap", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("run/signals.mcap  (")
    with (run / "signals.mcap").open("rb") as file:
        statistics = make_reader(file).get_summary().statistics
    # Hull and downwash; the scene once; frame and pose of the craft.
    assert statistics.message_count == 2 * rows(run) + 1 + 2 * rows(run)
    done = seatrial("export", "run", "--parquet", "--out", "x.parquet", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert parquet.read_metadata(tmp_path / "x.parquet").num_rows == rows(run)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("run",), "export needs one of --mcap, --parquet and --ros2"),
        (("run", "--mcap", "--parquet"), "export needs one of --mcap, --parquet and --ros2"),
        ((".", "--mcap"), "is not a run folder"),
        (("run", "--mcap", "--out", "no/x.mcap"), "cannot write no/x.mcap: No such file"),
    ],
)
def test_mistakes_are_named(run: Path, tmp_path: Path, arguments, expected: str) -> None:
    done = seatrial("export", *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert expected in done.stderr
