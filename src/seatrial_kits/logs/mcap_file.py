"""MCAP export, for Foxglove, Lichtblick and PlotJuggler."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Callable, Container, Mapping, Sequence
from pathlib import Path
from typing import Any

from seatrial import __version__
from seatrial.errors import InputError
from seatrial.fmi.cache import write_named
from seatrial.system.paths import split_path
from seatrial.trial.records.run_folder import MANIFEST, Run

from .foxglove import write_scene
from .record import Column, columns, nanoseconds

_SCHEMAS: Mapping[str, Mapping[str, str]] = {
    "Real": {"type": "number"},
    "Integer": {"type": "integer"},
    "Boolean": {"type": "boolean"},
    "String": {"type": "string"},
    "Binary": {"type": "string", "contentEncoding": "base64"},
}
_WRITTEN: Mapping[str, Callable[[Any], str]] = {
    "Real": repr,
    "Integer": repr,
    "Boolean": json.dumps,
    "String": json.dumps,
    "Binary": lambda value: json.dumps(base64.b64encode(value).decode()),
}

_Tree = dict[str, Any]
"""A component's signals by the parts of their names; the leaves are columns."""


def write_mcap(run: Run, path: Path) -> None:
    """Write the record of a run as an MCAP file: same record, same bytes.

    Each component is a channel of its name, with a JSON message per row of the record and a
    JSON schema that names type, unit and description of each signal; ``hull.position.x`` is
    ``x`` of ``position`` in the channel ``/hull``. Times are those of the simulation, ns;
    numbers read back exactly. Craft are in channels of Foxglove's schemas too (`foxglove`). The
    manifest is attached. Raises InputError for a record that begins before the time 0, which
    the format has not.
    """
    from mcap.writer import Writer

    times = nanoseconds(run)
    if times and times[0] < 0:
        raise InputError(f"{run.folder} begins at {times[0]} ns; MCAP has no times before 0")
    content = io.BytesIO()
    writer = Writer(content)
    writer.start(library=f"seatrial {__version__}")
    channels = []
    for component, signals in _by_component(columns(run), run.manifest["components"]).items():
        tree = _tree(component, signals)
        schema = writer.register_schema(component, "jsonschema", _schema(tree, component, run))
        channels.append((writer.register_channel(f"/{component}", "json", schema), _rows(tree)))
    for number, time in enumerate(times):
        for channel, row in channels:
            writer.add_message(channel, time, row(number), time, number)
    write_scene(writer, run, times)
    manifest = json.dumps(run.manifest, ensure_ascii=False, indent=1).encode()
    writer.add_attachment(0, 0, MANIFEST, "application/json", manifest)
    writer.finish()  # type: ignore[no-untyped-call]
    write_named(path, content.getvalue())


def _by_component(signals: Sequence[Column], components: Container[str]) -> dict[str, list[Column]]:
    found: dict[str, list[Column]] = {}
    for signal in signals:
        found.setdefault(split_path(components, signal.name)[0], []).append(signal)
    return found


def _tree(component: str, signals: Sequence[Column]) -> _Tree:
    """Return the signals by the parts of their names; a name stays whole below another signal."""
    names = {signal.name for signal in signals}
    tree: _Tree = {}
    for signal in signals:
        name = signal.name.removeprefix(f"{component}.")
        parts = name.split(".")
        above = {f"{component}.{'.'.join(parts[:n])}" for n in range(1, len(parts))}
        branch = tree
        for part in parts[:-1] if above.isdisjoint(names) else ():
            branch = branch.setdefault(part, {})
        branch[parts[-1] if above.isdisjoint(names) else name] = signal
    return tree


def _schema(tree: _Tree, component: str, run: Run) -> bytes:
    title = f"{component} ({run.manifest['components'][component]['fmu']})"
    return json.dumps({"title": title, **_object(tree)}, ensure_ascii=False).encode()


def _object(tree: _Tree) -> dict[str, Any]:
    properties = {
        key: _object(value) if isinstance(value, dict) else _described(value)
        for key, value in tree.items()
    }
    return {"type": "object", "properties": properties, "required": list(properties)}


def _described(signal: Column) -> dict[str, str]:
    unit = {"unit": signal.unit} if signal.unit else {}
    return {**_SCHEMAS[signal.type], **unit, "description": signal.description}


def _rows(tree: _Tree) -> Callable[[int], bytes]:
    """Return what writes a row: a template, filled with values that are JSON already."""
    leaves: list[list[str]] = []
    template = _template(tree, leaves)
    return lambda number: (template % tuple(leaf[number] for leaf in leaves)).encode()


def _template(tree: _Tree, leaves: list[list[str]]) -> str:
    fields = []
    for key, value in tree.items():
        if isinstance(value, dict):
            text = _template(value, leaves)
        else:
            written = _WRITTEN[value.type]
            leaves.append([written(each) for each in value.values])
            text = "%s"
        fields.append(f"{json.dumps(key)}:".replace("%", "%%") + text)
    return "{" + ",".join(fields) + "}"
