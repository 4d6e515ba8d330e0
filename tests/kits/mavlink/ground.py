"""A ground station that uploads and downloads as they do, and a transport that loses messages."""

import math
import random
from pathlib import Path

from pymavlink import mavwp
from pymavlink.dialects.v20 import all as mavlink

from .bench import STATION

RETRY_S = 1.5
MISSION, FENCE, RALLY, ALL = 0, 1, 2, 255
GLOBAL, LOCAL, MISSION_FRAME, RELATIVE, TERRAIN = 0, 1, 2, 3, 10
WAYPOINT, LOITER, TURNS, LOITER_TIME, RETURN, DELAY = 16, 17, 18, 19, 20, 93
JUMP, SPEED, SET_HOME = 177, 178, 179
LATITUDE, LONGITUDE = -31.78, -52.26


def item(
    sequence,
    command=WAYPOINT,
    p1=0.0,
    p2=0.0,
    p3=0.0,
    p4=0.0,
    *,
    at=(LATITUDE, LONGITUDE),
    z=0.0,
    frame=RELATIVE,
    kind=MISSION,
    current=0,
):
    """Return a MISSION_ITEM_INT at latitude and longitude, degrees."""
    x, y = (round(angle * 1e7) for angle in at)
    return mavlink.MAVLink_mission_item_int_message(
        7, 1, sequence, frame, command, current, 1, p1, p2, p3, p4, x, y, z, kind
    )


def listed(*commands, kind=MISSION, home=True):
    """Return items, numbered; item 0 is home if a mission has one. Each is arguments of `item`."""
    first = [((), {})] if home and kind == MISSION else []
    given = [*first, *commands]
    return [item(n, *args, kind=kind, **more) for n, (args, more) in enumerate(given)]


def one(*args, **more):
    """Return arguments of `item`, but for the sequence."""
    return args, more


def north_of(metres, east=0.0):
    """Return latitude and longitude of a place north and east of the bench's origin."""
    # By the radii of curvature of WGS 84, from its semi-major axis and flattening.
    a, f = 6378137.0, 1.0 / 298.257223563
    latitude, e2 = math.radians(LATITUDE), f * (2.0 - f)
    w = math.sqrt(1.0 - e2 * math.sin(latitude) ** 2)
    along_meridian, along_parallel = a * (1.0 - e2) / w**3, a / w * math.cos(latitude)
    return (
        LATITUDE + math.degrees(metres / along_meridian),
        LONGITUDE + math.degrees(east / along_parallel),
    )


def content(message):
    """Return an item's content, without its target and whether it is current."""
    fields = message.to_dict()
    for name in ("target_system", "target_component", "current", "mavpackettype"):
        del fields[name]
    return fields


def upload(bench, items, kind=MISSION, sender=STATION, sends=None):
    """Upload a list over a transport that loses nothing; return MAV_MISSION_RESULT."""
    bench.transport.take()
    bench.receive(mavlink.MAVLink_mission_count_message(7, 1, len(items), kind), sender)
    for _ in range(len(items)):
        requests = bench.transport.take("MISSION_REQUEST_INT", sender.link)
        if not requests:
            break
        (request,) = requests
        assert request.mission_type == kind
        bench.receive((sends or items)[request.seq], sender)
    (answer,) = bench.transport.take("MISSION_ACK", sender.link)
    assert answer.mission_type == kind
    assert (answer.target_system, answer.target_component) == (sender.system, sender.component)
    return answer.type


def download(
    bench, kind=MISSION, sender=STATION, request=mavlink.MAVLink_mission_request_int_message
):
    """Download a list over a transport that loses nothing; return its items, none if denied."""
    bench.transport.take()
    bench.receive(mavlink.MAVLink_mission_request_list_message(7, 1, kind), sender)
    if bench.transport.take("MISSION_ACK", sender.link):
        return []  # denied: it is being uploaded
    (count,) = bench.transport.take("MISSION_COUNT", sender.link)
    items = []
    for sequence in range(count.count):
        bench.receive(request(7, 1, sequence, kind), sender)
        (found,) = [m for m in bench.transport.take(link=sender.link) if hasattr(m, "command")]
        assert (found.seq, found.mission_type) == (sequence, kind)
        items.append(found)
    bench.receive(mavlink.MAVLink_mission_ack_message(7, 1, 0, kind), sender)
    return items


def save(items, path: Path):
    """Write a file as ground stations made of pymavlink do."""
    loader = mavwp.MAVWPLoader()
    for message in items:
        loader.add(as_float(message))
    loader.save(str(path))


def as_float(m):
    """Return a MISSION_ITEM_INT as the MISSION_ITEM with the same content."""
    unit = 1e-7 if m.frame in (GLOBAL, RELATIVE) else 1
    return mavlink.MAVLink_mission_item_message(
        m.target_system,
        m.target_component,
        m.seq,
        m.frame,
        m.command,
        m.current,
        m.autocontinue,
        m.param1,
        m.param2,
        m.param3,
        m.param4,
        m.x * unit,
        m.y * unit,
        m.z,
        m.mission_type,
    )


class Client:
    """One transfer at a time, with everything repeated that is not answered."""

    def __init__(self, speak, retry_s=RETRY_S):
        self.speak, self._retry_s = speak, retry_s
        self.items, self.result, self.count = [], None, None
        self._last, self._since = None, 0.0

    def upload(self, items, kind, now):
        self.items, self.kind, self.result = items, kind, None
        self._send(mavlink.MAVLink_mission_count_message(7, 1, len(items), kind), now)

    def download(self, kind, now):
        self.items, self.kind, self.count = [], kind, None
        self._send(mavlink.MAVLink_mission_request_list_message(7, 1, kind), now)

    @property
    def has_all(self):
        return self.count is not None and len(self.items) == self.count

    def receive(self, m, now):
        if getattr(m, "mission_type", None) != self.kind:
            return
        match m.get_type():
            case "MISSION_REQUEST_INT" if self.result is None:
                self._send(self.items[m.seq], now)
            case "MISSION_REQUEST" if self.result is None:
                self._send(as_float(self.items[m.seq]), now)
            case "MISSION_ACK":
                self.result = m.type
            case "MISSION_COUNT" if self.count is None:
                self.count = m.count
                self._request(now)
            case "MISSION_ITEM_INT" if not self.has_all and m.seq == len(self.items):
                self.items.append(m)
                self._request(now)

    def tick(self, now):
        if self._last is not None and now - self._since >= self._retry_s:
            self._send(self._last, now)

    def _request(self, now):
        if self.has_all:
            self._send(mavlink.MAVLink_mission_ack_message(7, 1, 0, self.kind), now)
            self._last = None
        else:
            request = mavlink.MAVLink_mission_request_int_message
            self._send(request(7, 1, len(self.items), self.kind), now)

    def _send(self, message, now):
        self._last, self._since = message, now
        self.speak(message)


class LossyTransport:
    """Bytes from one end to the other: lost, doubled, or late, and so out of order."""

    def __init__(self, seed, loss=0.1, doubled=0.1, late_s=0.15):
        self._random = random.Random(seed)
        self._loss, self._doubled, self._late = loss, doubled, late_s
        self._waiting = []
        self.lost = 0
        self._writer, self._reader = mavlink.MAVLink(None, 255, 190), mavlink.MAVLink(None)

    def put(self, message, now):
        frame = message.pack(self._writer)
        if self._random.random() < self._loss:
            self.lost += 1
            return
        for _ in range(2 if self._random.random() < self._doubled else 1):
            self._waiting.append((now + self._random.uniform(0.0, self._late), frame))

    def take(self, now):
        due = sorted(each for each in self._waiting if each[0] <= now)
        self._waiting = [each for each in self._waiting if each[0] > now]
        return [m for _, frame in due for m in self._reader.parse_buffer(frame)]
