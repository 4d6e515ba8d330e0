"""MCAP files, read by the format's own reader."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import Run
from seatrial_kits.logs.mcap_file import write_mcap

from .conftest import recorded


def flat(message: Any, name: str) -> dict[str, Any]:
    if not isinstance(message, dict):
        return {name: message}
    found: dict[str, Any] = {}
    for key, value in message.items():
        found |= flat(value, f"{name}.{key}")
    return found


def read(path: Path) -> tuple[dict[str, list[int]], dict[str, list[Any]], dict[str, Any]]:
    """Return times by channel, values by signal, and schemas by channel."""
    times: dict[str, list[int]] = {}
    values: dict[str, list[Any]] = {}
    schemas: dict[str, Any] = {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            assert message.publish_time == message.log_time
            times.setdefault(channel.topic, []).append(message.log_time)
            schemas[channel.topic] = json.loads(schema.data)
            for name, value in flat(json.loads(message.data), channel.topic[1:]).items():
                values.setdefault(name, []).append(value)
    return times, values, schemas


def test_the_record_reads_back_exactly(make_run, tmp_path: Path) -> None:
    run = make_run("5 s", "6 s")
    write_mcap(run, tmp_path / "x.mcap")
    times, values, _ = read(tmp_path / "x.mcap")
    expected_times, expected = recorded(run)
    assert expected_times == [5_000_000_000 + 10_000_000 * k for k in range(101)]
    assert times == {"/red": expected_times, "/green": expected_times}
    assert values == expected
    for name, column in expected.items():
        assert [type(value) for value in values[name]] == [type(value) for value in column]


def test_schemas_name_types_units_and_descriptions(make_run, tmp_path: Path) -> None:
    write_mcap(make_run(), tmp_path / "x.mcap")
    schema = read(tmp_path / "x.mcap")[2]["/red"]
    assert (schema["type"], schema["title"]) == ("object", "red (buoy.py:Buoy)")
    properties = schema["properties"]
    assert properties["position"]["properties"]["y"] == {
        "type": "number", "unit": "m", "description": "position, 100 % made up",
    }  # fmt: skip
    kinds = [properties[name]["type"] for name in ("count", "wet", "label", "number")]
    assert kinds == ["integer", "boolean", "string", "string"]
    assert schema["required"] == ["position", "count", "wet", "label", "number"]


def test_bytes_arrays_and_signals_below_signals(foreign: Run, tmp_path: Path) -> None:
    write_mcap(foreign, tmp_path / "x.mcap")
    _, values, schemas = read(tmp_path / "x.mcap")
    expected = recorded(foreign)[1]
    assert [base64.b64decode(text) for text in values.pop("box.raw")] == expected.pop("box.raw")
    assert values == expected
    properties = schemas["/box"]["properties"]
    assert list(properties) == ["raw", "a[1]", "a[2]", "b", "b.c", "b.c.d", "e"]
    assert properties["raw"]["contentEncoding"] == "base64"
    assert properties["e"]["properties"]["f"]["required"] == ["g"]


def test_the_manifest_is_attached(make_run, tmp_path: Path) -> None:
    run = make_run()
    write_mcap(run, tmp_path / "x.mcap")
    with (tmp_path / "x.mcap").open("rb") as file:
        (attachment,) = make_reader(file).iter_attachments()
    assert json.loads(attachment.data) == run.manifest
    assert (attachment.name, attachment.media_type) == ("manifest.json", "application/json")


def test_the_same_record_gives_the_same_bytes(make_run, tmp_path: Path) -> None:
    run = make_run()
    for name in ("a", "b"):
        write_mcap(run, tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_record_that_begins_before_zero_is_refused(make_run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="begins at -500000000 ns; MCAP has no times before 0"):
        write_mcap(make_run("-0.5 s"), tmp_path / "x.mcap")
    assert not (tmp_path / "x.mcap").exists()
