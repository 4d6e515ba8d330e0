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
from seatrial.model.component import NS
from seatrial.system.paths import split_path
from seatrial.trial.records.run_folder import MANIFEST, Run
from seatrial.trial.records.scene import WORLD, Craft, crafts, waypoints

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
    numbers read back exactly. Craft are in channels of Foxglove's schemas too. The
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


_BODY = (0.30, 0.50, 0.75, 0.8)
_AHEAD = (0.90, 0.45, 0.10, 1.0)
_TRACK = (0.85, 0.20, 0.20, 1.0)
_MARK = (0.95, 0.75, 0.10, 0.9)
"""Red, green, blue, opacity."""
_SIZE = (1.0, 0.5)
"""Of a craft whose file says no length and beam, m."""
_HEIGHT, _ARROW, _WAYPOINT = 0.25, 0.25, 0.5
"""Height of a body over its beam, breadth of its arrow over its beam; radius of a waypoint, m."""
_MOST_OF_A_TRACK = 5000
"""Points of the line of a track."""


def write_scene(writer: Any, run: Run, times: Sequence[int]) -> list[str]:
    """Write the craft of a run to an MCAP writer; return the names of their frames.

    ``/tf`` has the frame of each craft in that of the world, ``/NAME/pose`` its pose,
    ``/NAME/location`` WGS 84, if its profile says a home; ``/scene`` a body and the whole
    track of each, and all waypoints. World and body axes: `scene`.
    """
    from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
    from foxglove_schemas_protobuf.LocationFix_pb2 import LocationFix
    from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame

    found = crafts(run)
    if not found or not times:
        return []
    channels = _Channels(writer)
    channels.add("/scene", _scene(run, found, times[0]), times[0])
    for craft in found:
        positions, turns = craft.position.tolist(), craft.orientation.tolist()
        for time, position, turn in zip(times, positions, turns, strict=True):
            transform = FrameTransform(parent_frame_id=WORLD, child_frame_id=craft.name)
            _stamp(transform.timestamp, time)
            _set(transform.translation, "xyz", position)
            _set(transform.rotation, "xyzw", turn)
            channels.add("/tf", transform, time)
            pose = PoseInFrame(frame_id=WORLD)
            _stamp(pose.timestamp, time)
            _pose(pose.pose, position, turn)
            channels.add(f"/{craft.name}/pose", pose, time)
        geodetic = [] if craft.geodetic is None else craft.geodetic.tolist()
        for time, row in zip(times, geodetic, strict=False):
            fix = LocationFix(frame_id=craft.name)
            _stamp(fix.timestamp, time)
            _set(fix, ("latitude", "longitude", "altitude"), row)
            channels.add(f"/{craft.name}/location", fix, time)
    return [craft.name for craft in found]


class _Channels:
    """Channels by topic, made when they are first written to."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self._schemas: dict[str, int] = {}
        self._ids: dict[str, int] = {}

    def add(self, topic: str, message: Any, time: int) -> None:
        """Write a message at a time, ns."""
        from mcap_protobuf.schema import register_schema

        kind = message.DESCRIPTOR.full_name
        if kind not in self._schemas:
            self._schemas[kind] = register_schema(self._writer, type(message))
        if topic not in self._ids:
            schema = self._schemas[kind]
            self._ids[topic] = self._writer.register_channel(topic, "protobuf", schema)
        data = message.SerializeToString(deterministic=True)
        self._writer.add_message(self._ids[topic], time, data, time)


def _scene(run: Run, found: Sequence[Craft], time: int) -> Any:
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    scene = SceneUpdate()
    for craft in found:
        _body(scene.entities.add(), craft, time)
        _track(scene.entities.add(), craft, time)
    for component, places in waypoints(run):
        entity = scene.entities.add(frame_id=WORLD, id=component)
        _stamp(entity.timestamp, time)
        for place in places:
            sphere = entity.spheres.add()
            _pose(sphere.pose, place, (0.0, 0.0, 0.0, 1.0))
            _set(sphere.size, "xyz", [2.0 * _WAYPOINT] * 3)
            _set(sphere.color, "rgba", _MARK)
    return scene


def _body(entity: Any, craft: Craft, time: int) -> None:
    """Fill an entity that moves with the craft: a box of its size, and an arrow ahead."""
    entity.frame_id, entity.id, entity.frame_locked = craft.name, craft.name, True
    _stamp(entity.timestamp, time)
    length, beam = craft.size or _SIZE
    cube, arrow = entity.cubes.add(), entity.arrows.add()
    _pose(cube.pose, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    _set(cube.size, "xyz", (length, beam, _HEIGHT * beam))
    _set(cube.color, "rgba", _BODY)
    _pose(arrow.pose, (0.0, 0.0, _HEIGHT * beam), (0.0, 0.0, 0.0, 1.0))
    arrow.shaft_length, arrow.head_length = 0.4 * length, 0.2 * length
    arrow.shaft_diameter, arrow.head_diameter = 0.5 * _ARROW * beam, _ARROW * beam
    _set(arrow.color, "rgba", _AHEAD)


def _track(entity: Any, craft: Craft, time: int) -> None:
    entity.frame_id, entity.id = WORLD, f"track of {craft.name}"
    _stamp(entity.timestamp, time)
    line = entity.lines.add(thickness=2.0, scale_invariant=True)
    _pose(line.pose, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    _set(line.color, "rgba", _TRACK)
    points = craft.position.tolist()
    for point in points[:: -(-len(points) // _MOST_OF_A_TRACK)]:
        _set(line.points.add(), "xyz", point)


def _pose(pose: Any, position: Sequence[float], turn: Sequence[float]) -> None:
    _set(pose.position, "xyz", position)
    _set(pose.orientation, "xyzw", turn)


def _set(message: Any, fields: Sequence[str], values: Sequence[float]) -> None:
    for name, value in zip(fields, values, strict=True):
        setattr(message, name, value)


def _stamp(timestamp: Any, time: int) -> None:
    timestamp.seconds, timestamp.nanos = divmod(time, NS)
