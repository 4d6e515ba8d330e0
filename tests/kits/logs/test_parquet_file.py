"""Parquet files, read by pyarrow."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from pyarrow import parquet

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import Run
from seatrial_kits.logs.parquet_file import write_parquet

from .conftest import recorded


def test_the_record_reads_back_exactly(make_run, tmp_path: Path) -> None:
    run = make_run("-0.5 s")
    write_parquet(run, tmp_path / "x.parquet")
    table = parquet.read_table(tmp_path / "x.parquet").to_pydict()
    times, columns = recorded(run)
    assert table.pop("time_ns") == times
    assert times[0] == -500_000_000
    assert table == columns
    for name, column in columns.items():
        assert [type(value) for value in table[name]] == [type(value) for value in column]


def test_bytes_are_bytes(foreign: Run, tmp_path: Path) -> None:
    write_parquet(foreign, tmp_path / "x.parquet")
    table = parquet.read_table(tmp_path / "x.parquet").to_pydict()
    times, columns = recorded(foreign)
    assert table == {"time_ns": times, **columns}
    assert table["box.raw"] == [b"\0\xff%s", b""]


def test_fields_have_types_units_and_descriptions(make_run, tmp_path: Path) -> None:
    run = make_run()
    write_parquet(run, tmp_path / "x.parquet")
    schema = parquet.read_schema(tmp_path / "x.parquet")
    names = ("time_ns", "red.position.y", "red.count", "red.wet", "red.label")
    kinds = [str(schema.field(name).type) for name in names]
    assert kinds == ["int64", "double", "int32", "bool", "string"]
    about = schema.field("red.position.y").metadata
    assert (about[b"unit"], about[b"description"]) == (b"m", b"position, 100 % made up")
    assert json.loads(schema.metadata[b"seatrial.manifest"]) == run.manifest


def test_the_same_record_gives_the_same_bytes(make_run, tmp_path: Path) -> None:
    run = make_run()
    for name in ("a", "b"):
        write_parquet(run, tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_missing_library_is_named_with_the_command(
    foreign: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(InputError, match=r'pip install "seatrial\[parquet\]"'):
        write_parquet(foreign, tmp_path / "x.parquet")
