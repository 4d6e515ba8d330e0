"""Requests to a vehicle, and what it answered: of ArduPilot's firmware, or of the component.

``python -m tests.interop.ardupilot_answers FIRMWARE [NAME...]`` starts ``ardurover`` or ``ardusub``
of the folder SEATRIAL_ARDUPILOT in a network of its own with their own physics, puts the requests of
``tests/reference/ardupilot_requests.jsonl`` to it, and writes the answers to
``ardupilot_answers_FIRMWARE.json`` beside it; with NAME, those of these requests alone, to the screen.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, Protocol

from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

REFERENCE = Path(__file__).parents[1] / "reference"
REQUESTS = REFERENCE / "ardupilot_requests.jsonl"
LATITUDE, LONGITUDE = -31.78, -52.26
HOME = (round(LATITUDE * 1e7), round(LONGITUDE * 1e7))
THERE = (HOME[0] + 9000, HOME[1])
"""Where requests send it in guided mode."""
STATION = (255, 190)
SETTLES_S, LATE_S = 0.4, 6.0
"""Simulated time for which answers are waited for, and those that the firmware's second thread gives."""
LATE = ("PARAM_REQUEST_READ", "FILE_TRANSFER_PROTOCOL", "LOG_REQUEST_LIST", "LOG_REQUEST_DATA")
BASE_MODE = {"rover": 4, "sub": 19}
KINDS = (0, 1, 2)
"""Missions, fences, rally points."""

_ITEM = ("seq", "frame", "command", "param1", "param2", "param3", "param4", "x", "y", "z")
SHOWN: dict[str, tuple[str, ...]] = {
    "COMMAND_ACK": ("command", "result"),
    "MISSION_ACK": ("type", "mission_type"),
    "MISSION_COUNT": ("count", "mission_type"),
    "MISSION_REQUEST": ("seq", "mission_type"),
    "MISSION_ITEM": (*_ITEM, "mission_type"),
    "MISSION_ITEM_INT": (*_ITEM, "mission_type"),
    "MISSION_ITEM_REACHED": ("seq",),
    "PARAM_VALUE": ("param_id", "param_value", "param_type"),
    "PARAM_ERROR": ("param_id", "error"),
    "FILE_TRANSFER_PROTOCOL": ("opcode", "of", "session", "offset", "first"),
    "MESSAGE_INTERVAL": ("message_id", "interval_us"),
    "LOG_DATA": ("id", "ofs", "count"),
    "TIMESYNC": ("ts1",),
    "PING": ("seq",),
}
"""What is recorded of which answers; others only where a request says that it wants them."""
WANTED: dict[str, tuple[str, ...]] = {
    "HOME_POSITION": ("latitude", "longitude"),
    "GPS_GLOBAL_ORIGIN": ("latitude", "longitude"),
    "AVAILABLE_MODES": ("number_modes", "mode_index", "custom_mode"),
    "POSITION_TARGET_GLOBAL_INT": ("type_mask", "lat_int"),
    "POSITION_TARGET_LOCAL_NED": ("type_mask", "vx", "vy"),
}
UNASKED = ("MIS_TOTAL", "FENCE_TOTAL", "RALLY_TOTAL", "STAT_", "BARO", "MOT_THST")
"""Parameters that come by themselves when they change."""
_STREAMED_MS = 100
_ITEM_DEFAULTS = {"frame": 3, "command": 16, "autocontinue": 1, "z": 0.0}

Message = Any
Step = dict[str, Any]
Sender = tuple[int, int]


class Vehicle(Protocol):
    """A vehicle with the time that passes for it."""

    system: int

    def send(self, message: Message, sender: Sender) -> None:
        """Send it a message of a station."""

    def wait(self, seconds: float, *, beats: Sender | None = STATION) -> list[Message]:
        """Let simulated time pass, with heartbeats of a station, and return what came."""


def requests(firmware: str) -> Iterator[dict[str, Any]]:
    """Yield the requests that are put to a firmware."""
    for line in REQUESTS.read_text("utf-8").splitlines():
        request = json.loads(line, parse_constant=None)
        if request.get("of", firmware) == firmware:
            yield request


def message(name: str, system: int, **fields: Any) -> Message:
    """Return a message with these fields; the target is the vehicle, all else is 0."""
    kind = mavlink.mavlink_map[getattr(mavlink, f"MAVLINK_MSG_ID_{name}")]
    lengths = dict(zip(kind.fieldnames, [kind.array_lengths[kind.ordered_fieldnames.index(f)]
                                         for f in kind.fieldnames], strict=True))  # fmt: skip
    fields = {"target_system": system, "target_component": 1, "target": system, **fields}
    values: list[Any] = []
    for field, type_ in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        value = fields.get(field, [0] * lengths[field] if lengths[field] else 0)
        if type_ == "char":
            value = (value or "").encode()
        elif isinstance(value, str):
            value = float(value)  # nan and inf, which JSON has not
        elif type_ in ("float", "double") and not lengths[field]:
            value = float(value)
        values.append(value)
    return kind(*values)


def shown(m: Message, wanted: Iterable[str] = ()) -> str | None:
    """Return an answer as it is recorded, None for a message that is none."""
    name = m.get_type().replace("MISSION_REQUEST_INT", "MISSION_REQUEST")
    fields = SHOWN.get(name) or (WANTED.get(name, ()) if name in wanted else None)
    if fields is None or (name == "TIMESYNC" and m.tc1 == 0):
        return None
    values = _file_transfer(m) if name == "FILE_TRANSFER_PROTOCOL" else m.to_dict()
    if name.startswith("MISSION_ITEM") and fields[-1] == "mission_type":
        values = _home_hidden(values)
    if name.startswith("POSITION_TARGET_GLOBAL"):
        values["lat_int"] = "there" if abs(m.lat_int - THERE[0]) < 3 else "elsewhere"
    if name in ("HOME_POSITION", "GPS_GLOBAL_ORIGIN"):
        values = {key: round(values[key] / 1e5) for key in fields}  # the vehicle moves
    return " ".join([name, *(f"{field}={_number(values[field])}" for field in fields)])


def _home_hidden(values: dict[str, Any]) -> dict[str, Any]:
    """Return an item's fields, the place left out if it is home, which follows the vehicle."""
    is_home = values["seq"] == 0 and values["mission_type"] == 0
    return {**values, "x": "home", "y": "home", "z": 0.0} if is_home else values


def _file_transfer(m: Message) -> dict[str, int]:
    payload = bytes(m.payload)
    first = payload[12] if payload[4] and payload[3] == 129 else 0
    offset = int.from_bytes(payload[8:12], "little")
    return {"opcode": payload[3], "of": payload[5], "session": payload[2], "offset": offset,
            "first": first}  # fmt: skip


def _number(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _was_asked(m: Message, request: dict[str, Any]) -> bool:
    """Return whether a parameter is one that was asked for: some come when they change."""
    return not m.get_type().startswith("PARAM_") or not m.param_id.startswith(UNASKED)


class Dialogue:
    """Puts requests to a vehicle, one after the other, each from the same state."""

    def __init__(self, vehicle: Vehicle, firmware: str) -> None:
        self._vehicle, self._mode = vehicle, BASE_MODE[firmware]
        self._syncs = 0
        self._system = vehicle.system

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Return the answers to a request, in order, and the state after it."""
        for step in self._resets():
            self._vehicle.send(self._built(step), STATION)
        self._answers(SETTLES_S)
        answers: list[str] = []
        for step in request["do"]:
            answered = self._do(step)
            for came in answered:
                text = shown(came, request.get("wants", ()))
                if text is not None and text not in answers[-1:] and _was_asked(came, request):
                    answers.append(text)
            if "upload" in step and [m.type for m in answered] != [0]:
                break  # a list that is refused ends the request
        state = self._state()
        for step in request.get("then", ()):
            self._do(step)
        return {"answers": answers, "state": state}

    def quiet(self) -> None:
        """Stop streams of messages that a request may want."""
        for name in WANTED:
            self._do({"long": [511, getattr(mavlink, f"MAVLINK_MSG_ID_{name}"), -1]})

    def _resets(self) -> list[Step]:
        clears = [{"send": "MISSION_CLEAR_ALL", "mission_type": kind} for kind in KINDS]
        return [{"long": [400, 0, 21196]}, {"long": [176, 1, self._mode]}, *clears]

    def _state(self) -> str:
        came = self._vehicle.wait(0.0)
        for kind in KINDS:
            asked = message("MISSION_REQUEST_LIST", self._system, mission_type=kind)
            self._vehicle.send(asked, STATION)
        came += self._do({"long": [512, mavlink.MAVLINK_MSG_ID_MISSION_CURRENT]}, 1.1)
        newest = {m.get_type(): m for m in came}
        beat, current = newest["HEARTBEAT"], newest["MISSION_CURRENT"]
        counts = {m.mission_type: m.count for m in came if m.get_type() == "MISSION_COUNT"}
        if counts.get(0) == 1:
            counts[0] = 0  # home alone, which an ArduPilot writes when it moves
        of_kinds = "/".join(str(counts.get(kind, "-")) for kind in KINDS)
        armed = "armed" if beat.base_mode & 128 else "disarmed"
        return f"mode {beat.custom_mode}, {armed}, lists {of_kinds}, current {current.seq}"

    def _do(self, step: Step, settles: float = SETTLES_S) -> list[Message]:
        sender = tuple(step.get("from", STATION))
        if "wait" in step:
            beats = step.get("beats", STATION)
            return self._vehicle.wait(step["wait"], beats=beats and tuple(beats))
        if "upload" in step:
            return self.upload(step["upload"], step["items"], sender)
        if "download" in step:
            return self._download(step["download"], sender)
        self._vehicle.send(self._built(step), sender)
        return self._answers(LATE_S if step.get("send") in LATE else settles)

    def _built(self, step: Step) -> Message:
        given = {k: v for k, v in step.items() if k not in ("send", "long", "int", "from")}
        if "send" in step:
            return message(step["send"], self._system, **given)
        values = step.get("long") or step["int"]
        names = ["command", *(f"param{n}" for n in range(1, 8))]
        if "int" in step:
            names[5:] = ["x", "y", "z"]
        fields = dict(zip(names, values, strict=False))
        name = "COMMAND_LONG" if "long" in step else "COMMAND_INT"
        return message(name, self._system, **(fields | given))

    def _answers(self, seconds: float) -> list[Message]:
        """Wait until a later message is answered, and then some time."""
        self._syncs += 1
        mark = -self._syncs
        self._vehicle.send(message("TIMESYNC", self._system, ts1=mark), STATION)
        came: list[Message] = []
        for _ in range(50):
            came += self._vehicle.wait(0.1)
            if any(m.get_type() == "TIMESYNC" and m.ts1 == mark for m in came):
                break
        came += self._vehicle.wait(seconds)
        return [m for m in came if m.get_type() != "TIMESYNC" or m.ts1 > 0]

    def upload(
        self, kind: int, items: list[dict[str, Any]], sender: Sender = STATION
    ) -> list[Message]:
        """Upload a list, and return what it ended with."""
        given = [{"x": HOME[0], "y": HOME[1], "frame": 0}] if kind == 0 else []
        given += [{"x": HOME[0] + 900, "y": HOME[1], **item} for item in items]
        count = message("MISSION_COUNT", self._system, count=len(given), mission_type=kind)
        self._vehicle.send(count, sender)
        came = self._answers(0.0)
        for _ in range(2 * len(given)):
            asked = [m for m in came if m.get_type() in ("MISSION_REQUEST", "MISSION_REQUEST_INT")]
            ended = [m for m in came if m.get_type() == "MISSION_ACK"]
            if ended or not asked or asked[-1].seq >= len(given):
                break
            item = {**_ITEM_DEFAULTS, **given[asked[-1].seq], "seq": asked[-1].seq}
            p = dict(zip(("param1", "param2", "param3", "param4"), item.pop("p", ()), strict=False))
            name = item.pop("as", "MISSION_ITEM_INT")
            sent = message(name, self._system, mission_type=kind, **item, **p)
            self._vehicle.send(sent, sender)
            came = self._answers(0.0)
        return [m for m in came if m.get_type() == "MISSION_ACK"]

    def _download(self, kind: int, sender: Sender) -> list[Message]:
        came = self._do({"send": "MISSION_REQUEST_LIST", "mission_type": kind}, 0.0)
        counts = [m for m in came if m.get_type() == "MISSION_COUNT"]
        for sequence in range(counts[0].count if counts else 0):
            step = {"send": "MISSION_REQUEST_INT", "seq": sequence, "mission_type": kind}
            came += self._do(step, 0.0)
        return came


# ---------------------------------------------------------------------- the firmware


class Firmware:
    """ArduPilot's firmware at its port of this machine, by its own clock."""

    system = 1

    def __init__(self, ended: Callable[[], bool]) -> None:
        self.ended = ended
        for _ in range(100):
            try:
                self._link = mavutil.mavlink_connection("tcp:127.0.0.1:5760", dialect="all")
                break
            except OSError:
                time.sleep(0.2)
        self._link.wait_heartbeat(timeout=30)
        self._now = self._beat_at = 0.0

    def prepare(self) -> None:
        """Stop all streams but the clock, and wait until the vehicle can arm and knows its place."""
        self.send(message("REQUEST_DATA_STREAM", 1, req_stream_id=0, start_stop=0), STATION)
        number = mavlink.MAVLINK_MSG_ID_SYSTEM_TIME
        self._command(511, number, 1000 * _STREAMED_MS)
        for _ in range(100):
            self._command(512, mavlink.MAVLINK_MSG_ID_SYS_STATUS)
            self._command(512, mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT)
            newest = {m.get_type(): m for m in self.wait(1.0)}
            if not {"SYS_STATUS", "EKF_STATUS_REPORT"} <= newest.keys():
                continue
            healthy = newest["SYS_STATUS"].onboard_control_sensors_health
            flags = newest["EKF_STATUS_REPORT"].flags
            if healthy & mavlink.MAV_SYS_STATUS_PREARM_CHECK and flags & mavlink.EKF_POS_HORIZ_ABS:
                return
        raise TimeoutError(
            f"not ready to arm: {[m.text for m in self.wait(40.0) if m.get_type() == 'STATUSTEXT']}"
        )

    def _command(self, number: int, *given: float) -> None:
        fields = {f"param{n}": value for n, value in enumerate(given, 1)}
        self.send(message("COMMAND_LONG", 1, command=number, **fields), STATION)

    def send(self, sent: Message, sender: Sender) -> None:
        self._link.mav.srcSystem, self._link.mav.srcComponent = sender
        self._link.mav.send(sent)

    def wait(self, seconds: float, *, beats: Sender | None = STATION) -> list[Message]:
        came: list[Message] = []
        until, deadline = self._now + seconds, time.monotonic() + 30.0 + seconds
        while (self._now < until or not seconds) and time.monotonic() < deadline:
            if beats and self._now - self._beat_at >= 0.8:
                self._beat_at = self._now
                self.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3), beats)
            m = self._link.recv_match(blocking=bool(seconds), timeout=0.2)
            if self.ended():
                raise ConnectionError("the firmware has ended")
            if m is None:
                if not seconds:
                    break
                continue
            if m.get_srcSystem() == self.system:
                came.append(m)
            if m.get_type() == "SYSTEM_TIME":
                self._now = m.time_boot_ms / 1e3
        return came


_CALIBRATED = "".join(
    f"INS_ACC{which}{what}_{axis} {value}\n"
    for which in ("", "2") for what, value in (("OFFS", 0.001), ("SCAL", 1.001)) for axis in "XYZ"
)  # fmt: skip
_FIRMWARES = {
    "rover": ("motorboat", "SIM_FLOAT_EXCEPT 0\nFRAME_CLASS 2\nSERVO1_FUNCTION 26\nSERVO3_FUNCTION 70\n"
              "SERVO1_MIN 1000\nSERVO1_MAX 2000\nSERVO3_MIN 1000\nSERVO3_MAX 2000\n"
              "ATC_STR_RAT_FF 0.75\nCRUISE_SPEED 3\nCRUISE_THROTTLE 30\nWP_SPEED 3\n"
              "WP_RADIUS 3\nBATT_MONITOR 4\n" + _CALIBRATED),
    "sub": ("vectored", "SIM_FLOAT_EXCEPT 0\nFS_PILOT_INPUT 0\nBARO_EXT_BUS 1\nBATT_MONITOR 4\n" + "".join(
        f"COMPASS_OFS{which}_{axis} {value}\n"
        for which in ("", "2", "3") for axis, value in (("X", 5), ("Y", 13), ("Z", -18)))
        + _CALIBRATED),
}  # fmt: skip
"""Physics and parameters."""


def record(firmware: str, names: list[str], ended: Callable[[], bool]) -> dict[str, Any]:
    """Return the answers of a firmware that has been started."""
    vehicle = Firmware(ended)
    vehicle.prepare()
    dialogue = Dialogue(vehicle, firmware)
    dialogue.quiet()
    found = {}
    for request in requests(firmware):
        if not names or any(request["name"].startswith(name) for name in names):
            found[request["name"]] = dialogue.ask(request)
            print(request["name"], found[request["name"]], file=sys.stderr, flush=True)
    return found


def main(firmware: str, *names: str) -> None:
    """Start the firmware, and write down what it answers."""
    program = Path(os.environ["SEATRIAL_ARDUPILOT"], f"ardu{firmware}").resolve()
    physics, parameters = _FIRMWARES[firmware]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "own.parm")
        file.write_text(parameters)
        started = subprocess.Popen(
            [program, "--model", physics, "--speedup", os.environ.get("SPEEDUP", "20"), "--home",
             f"{LATITUDE},{LONGITUDE},0,0", "--defaults", file, "-w"],
            cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        try:
            found = record(firmware, [*names], lambda: started.poll() is not None)
        finally:
            started.kill()
            started.wait()
    lines = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in found.items()]
    text = "{\n" + ",\n".join(lines) + "\n}\n"
    if names:
        print(text)
    else:
        (REFERENCE / f"ardupilot_answers_{firmware}.json").write_text(text)


if __name__ == "__main__":
    if os.environ.get("SEATRIAL_ALONE") != "1":
        from .test_dronecan_multicast import alone

        again = [sys.executable, "-m", "tests.interop.ardupilot_answers", *sys.argv[1:]]
        os.environ["SEATRIAL_ALONE"] = "1"
        sys.exit(subprocess.call(alone(f"exec {subprocess.list2cmdline(again)}")))
    main(*sys.argv[1:])
