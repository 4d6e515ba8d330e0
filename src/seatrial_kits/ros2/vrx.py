"""Tasks of VRX: goals and scores on the topics of VRX, as outputs too."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.links.geodesy import Origin
from seatrial.model.component import NS, Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled
from seatrial.model.waypoints import MOST, Waypoints

from .frames import quaternion
from .joining import TRANSPORTS, join
from .messages.packing import packed
from .reach import HIGHEST_DOMAIN
from .topics import token
from .transport import Transport, Writer
from .vrx_scores import Gates, Score, StationKeeping, Wayfinding

_LOGGER = logging.getLogger("seatrial.ros2")
GOALS = tuple(f"goal{number}" for number in range(1, MOST + 1))
_TASKS: Mapping[str, Callable[[Sequence[Any], Sequence[float]], Score]] = {
    "stationkeeping": StationKeeping,
    "wayfinding": Wayfinding,
    "follow_path": lambda marks, _: Gates(marks),
}
_INFO = "ros_gz_interfaces/msg/ParamVec"
_POSE, _POSES = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseArray"
_FLOAT, _FLOATS = "std_msgs/msg/Float32", "ros_gz_interfaces/msg/Float32Array"
_TOPICS: Mapping[str, Mapping[str, str]] = {
    "stationkeeping": {"goal": _POSE, "pose_error": _FLOAT, "mean_pose_error": _FLOAT},
    "wayfinding": {"waypoints": _POSES, "min_errors": _FLOATS, "mean_error": _FLOAT},
    "follow_path": {},
}
"""Topics below ``/vrx/TASK``, with their types."""


class VrxTask(Waypoints, Sampled):
    """A task of VRX: station keeping, wayfinding, or a path through gates, and its score.

    The task is "initial", after ``initial`` "ready", after ``ready`` more "running", and after
    ``running`` more "finished". Running, the score is that of VRX (`vrx_scores`): the mean pose
    error of station keeping, the mean of the least pose errors of wayfinding, the points of a
    path. Goals are the waypoints with their headings; of a path two waypoints are a gate: its red
    mark, to starboard, and its green one.

    With ``topics`` = "on" nodes of ROS 2 get ``/vrx/task/info``, and the goals (latitude and
    longitude in degrees as x and y, as VRX has them) and errors below ``/vrx/TASK``, at 1 Hz:
    goals from "ready" on. Gates are no topic there either.

    VRX holds the vehicle until "ready"; here it drifts, or its pilot holds it. Raises InputError
    at the start for gates with a mark too few, and for a domain that cannot be joined. The
    waypoints' ``radius`` has no part in any score.
    """

    rolls_back = False
    transient = Sampled.transient | {"_joined", "_writers"}
    exercised: ClassVar = {"topics": "off", "initial": 0.0, "ready": 0.0}

    period = Parameter(0.02, "s", "sample period", min=1e-6)
    task = Parameter("stationkeeping", "1", "which of them", choices=tuple(_TASKS))
    heading = Parameter(0.0, "rad", "at each goal, clockwise from north", axes=GOALS)
    initial = Parameter(10.0, "s", "time until the task is ready", min=0.0)
    ready = Parameter(10.0, "s", "time from then until it runs", min=0.0)
    running = Parameter(300.0, "s", "longest time that it runs", min=0.0)
    topics = Parameter("on", "1", "whether nodes are given goals and scores", choices=("on", "off"))
    domain = Parameter(
        -1.0, "1", "domain of ROS; -1: ROS_DOMAIN_ID, else 0", min=-1.0, max=float(HIGHEST_DOMAIN)
    )
    transport = Parameter("auto", "1", "as of the link ros2", choices=TRANSPORTS)
    latitude = Parameter(
        0.0, "rad", "of the origin, WGS 84", min=-1.5707964, max=1.5707964, role="home"
    )
    longitude = Parameter(
        0.0, "rad", "of the origin, WGS 84", min=-math.pi, max=math.pi, role="home"
    )
    altitude = Parameter(0.0, "m", "of the origin", role="home")

    position = Input("m", "true position, north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "true Euler angles, ZYX", axes=("phi", "theta", "psi"))

    state = Output("1", "initial, ready, running or finished", type=str, start="initial")
    score = Output("1", "score as of VRX: an error, or points")
    pose_error = Output("1", "error of the pose at each goal: now, or the least", axes=GOALS)
    crossed = Output("1", "number of gates that were crossed", type=int)

    terminals: ClassVar = {"motion": terminal("position", "attitude")}

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._joined: Transport | None = None

    def reset(self, t: float) -> None:
        """Set the goals, and join the domain."""
        self.close()
        goals = self.waypoints()
        if self.task == "follow_path" and len(goals) % 2:
            raise InputError(
                f"{self.name}.count is {len(goals)}, an even number is needed: two marks a gate"
            )
        self._score = _TASKS[self.task](goals, self.heading[: len(goals)])
        self._state, self._begun, self._written_at = "initial", t, -math.inf
        origin = Origin(self.latitude, self.longitude, self.altitude)
        self._goals = [
            {
                "position": (*origin.geodetic(goal)[:2], 0.0),
                "orientation": quaternion((0.0, 0.0, psi)),
            }
            for goal, psi in zip(goals, self.heading, strict=False)
        ]
        self._writers: dict[str, Writer] = {}
        if self.topics == "off":
            return
        try:
            self._joined = join(round(self.domain), f"/vrx_{token(self.name)}", self.transport)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        kinds = {f"{self.task}/{name}": kind for name, kind in _TOPICS[self.task].items()}
        for name, kind in {"task/info": _INFO, **kinds}.items():
            if lacking := self._joined.lacks(kind):
                _LOGGER.warning("%s: /vrx/%s is not written: %s", self.name, name, lacking)
            else:
                self._writers[name] = self._joined.writer(f"/vrx/{name}", kind)

    def sample(self, t: float, k: int) -> None:
        """Publish the score until now."""
        self.state, self.score = self._state, self._score.value
        finite = [each if math.isfinite(each) else 0.0 for each in self._score.errors]
        self.pose_error = [*finite[:MOST], *[0.0] * (MOST - len(finite))]
        self.crossed = self._score.crossed if isinstance(self._score, Gates) else 0

    def update(self, t: float, k: int) -> None:
        """Go on in the task, add to the score, and write once a second."""
        elapsed = t - self._begun - self.initial - self.ready
        if self._state == "running" and (elapsed >= self.running or self._score.done):
            self._state = "finished"
        elif self._state != "finished":
            ready = t - self._begun >= self.initial
            self._state = "running" if elapsed >= 0.0 else "ready" if ready else "initial"
        if self._state == "running":
            self._score.add(self.position, self.attitude[2])
        if self._writers and t - self._written_at >= 1.0:
            self._written_at = t
            self._report(t, elapsed)

    def close(self) -> None:
        """Leave the domain."""
        if self._joined is not None:
            self._joined.close()
        self._joined = None

    # ------------------------------------------------------------------ inside

    def _report(self, t: float, elapsed: float) -> None:
        now = round(t * NS)
        header, errors = {"stamp": now}, self._score.errors
        info: Mapping[str, Any] = {"header": header, "params": self._info(elapsed)}
        messages = {"task/info": info}
        if self._state in ("ready", "running") and self.task == "stationkeeping":
            messages["stationkeeping/goal"] = {"header": header, "pose": self._goals[0]}
        if self._state in ("ready", "running") and self.task == "wayfinding":
            messages["wayfinding/waypoints"] = {"header": header, "poses": self._goals}
        if self._state == "running" and self.task == "stationkeeping":
            messages["stationkeeping/pose_error"] = {"data": errors[0]}
            messages["stationkeeping/mean_pose_error"] = {"data": self._score.value}
        if self._state == "running" and self.task == "wayfinding":
            messages["wayfinding/min_errors"] = {"data": errors}
            messages["wayfinding/mean_error"] = {"data": self._score.value}
        for name, fields in messages.items():
            if name in self._writers:
                writer = self._writers[name]
                writer.write(packed(writer.kind, fields))

    def _info(self, elapsed: float) -> list[Mapping[str, Any]]:
        """Return what VRX says of a task, as parameters of ROS."""
        ran = min(max(elapsed, 0.0), self.running)
        reals = {
            "ready_time": self._begun + self.initial,
            "running_time": self._begun + self.initial + self.ready,
            "elapsed_time": ran,
            "remaining_time": self.running - ran,
            "score": self._score.value,
        }
        return [
            _parameter("name", 4, string_value=self.task),
            _parameter("state", 4, string_value=self._state),
            *(_parameter(name, 3, double_value=value) for name, value in reals.items()),
            _parameter("timed_out", 1, bool_value=elapsed >= self.running),
            _parameter("num_collisions", 2, integer_value=0),
        ]


def _parameter(name: str, kind: int, **value: Any) -> Mapping[str, Any]:
    """Return a rcl_interfaces/Parameter; kinds are its own: 1 bool, 2 integer, 3 double, 4 text."""
    return {"name": name, "value": {"type": kind, **value}}
