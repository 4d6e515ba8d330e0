"""Channels of an MCAP file in Foxglove's schemas: its 3D and map panels show the run by itself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from seatrial.model.component import NS
from seatrial.trial.records.run_folder import Run
from seatrial.trial.records.scene import WORLD, Craft, crafts, waypoints

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
