"""A DroneCAN node as a component: what all of them have in common."""

from __future__ import annotations

import hashlib
import re
import zlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

from dronecan.transport import Transfer

from seatrial.errors import InputError
from seatrial.model.component import NS, Component, Input, Noise, Output, Parameter, terminal

from ..node import CanNode
from .codec import protocol
from .parameters import ExecuteOpcode, GetSet, ParameterServer, Setting
from .transfers import LOW, Kind, Transfers

REQUEST_MS, FOLLOW_UP_MS = (600, 1000), (0, 400)
"""Ranges of the random times before a request, and before what follows an answer."""
LONGEST_PART = 6
"""Bytes of the unique ID in one request."""

Allocation: Any = protocol.dynamic_node_id.Allocation

_MS = 1_000_000


class Allocatee:
    """Requests a node ID, by its unique ID of 16 bytes in three parts: rules A to E of the message.

    Source: DroneCAN specification, uavcan.protocol.dynamic_node_id.Allocation.

    A view of ``memory``, a dict that belongs to the component's state. ``draw`` (k) returns the
    k-th random number, 0 to 1.
    """

    def __init__(
        self, memory: dict[str, Any], unique_id: bytes, draw: Callable[[int], float]
    ) -> None:
        self._memory, self._unique_id, self._draw = memory, unique_id, draw

    def begin(self, now_ns: int) -> None:
        """Start the request timer."""
        self._memory.update(draws=0, due=0, offset=0)
        self._wait(now_ns, 0, REQUEST_MS)

    @property
    def due_ns(self) -> int:
        """Time of its next message, if it receives nothing before."""
        due: int = self._memory["due"]
        return due

    def receive(self, now_ns: int, transfer: Transfer) -> int:
        """Take in an Allocation message; return the node ID that it grants, or 0."""
        message = transfer.payload
        known = bytes(message.unique_id)
        self._wait(now_ns, 0, REQUEST_MS)
        if transfer.source_node_id == 0 or not self._unique_id.startswith(known):
            return 0
        if len(known) < len(self._unique_id):
            if known:
                self._wait(now_ns, len(known), FOLLOW_UP_MS)
            return 0
        return int(message.node_id)

    def request(self) -> tuple[Any, int]:
        """Return the message that is due, and its discriminator; wait for an answer."""
        offset = self._memory["offset"]
        message = Allocation(first_part_of_unique_id=offset == 0)
        message.unique_id = list(self._unique_id[offset : offset + LONGEST_PART])
        self._wait(self.due_ns, 0, REQUEST_MS)
        return message, int(self._random() * (1 << 14))

    def _wait(self, now_ns: int, offset: int, range_ms: tuple[int, int]) -> None:
        """Send the part of the unique ID at ``offset`` after a random time."""
        low, high = range_ms
        delay = round((low + (high - low) * self._random()) * _MS)
        self._memory.update(due=now_ns + delay, offset=offset)

    def _random(self) -> float:
        self._memory["draws"] += 1
        return self._draw(self._memory["draws"])


NodeStatus: Any = protocol.NodeStatus
GetNodeInfo: Any = protocol.GetNodeInfo
RestartNode: Any = protocol.RestartNode

STATUS_NS = NS
"""Period of NodeStatus."""
OFFLINE_NS = 3 * NS
"""A node that is silent for so long is offline."""
SHORTEST_NS = 1_000_000
"""The shortest period of anything."""
LARGEST_ID = 127

_SERVICES = frozenset(
    (service.default_dtid, True) for service in (GetNodeInfo, RestartNode, GetSet, ExecuteOpcode)
)
_ALLOCATION = frozenset([(Allocation.default_dtid, False)])
_FIRST_DRAW = 100
"""Random numbers below are for phases."""


class Task(NamedTuple):
    """Task of a node every ``period`` (s), at most each millisecond; never if that is 0."""

    name: str
    period: float
    act: Callable[[int], None]
    """Called with the simulated time at which it is due, ns."""
    spread: bool = True
    """Begin at a random time in the first period, and not at once."""


def check_name(text: str) -> None:
    """Raise InputError for a text that cannot be a node's name."""
    if not re.fullmatch(r"[a-z0-9._-]{1,80}", text):
        raise InputError(
            f"name is {text!r}, 1 to 80 small letters, digits, '.', '-' and '_' are needed, such "
            "as 'org.example.esc'"
        )


def check_unique_id(text: str) -> None:
    """Raise InputError for a text that cannot be a unique ID."""
    if text and not re.fullmatch(r"[0-9a-fA-F]{32}", text):
        raise InputError(f"unique_id is {text!r}, 32 hexadecimal digits are needed, or nothing")


def check_version(text: str) -> None:
    """Raise InputError for a text that is no version."""
    if not re.fullmatch(r"\d{1,3}\.\d{1,3}", text) or max(map(int, text.split("."))) > 255:
        raise InputError(f"version is {text!r}, something like '1.0' is needed")


class DroneCanNode(Noise, Component):
    """Base of the nodes of a DroneCAN bus.

    **It sends** NodeStatus once a second, and answers GetNodeInfo, RestartNode, param.GetSet and
    param.ExecuteOpcode. With the ``node_id`` 0 it first requests one of an allocator, by its
    ``unique_id`` (`Allocatee`), and until then sends and takes in nothing else. Without a
    ``unique_id`` it is made of the component's name.

    **Time** is simulated: what is due from t to before t + h is requested at its very time, with
    the inputs as of t; requests are answered at the beginning of the step in which they are
    received.

    **Parameters over the bus** are `settings`; they begin as the component's own and change at
    once, but for ``NODE_ID`` and ``CHANNELS``, which wait for a restart. A restart forgets what was
    not saved, counts time and transfers anew, and is over at once.

    A subclass declares ``messages``, the message types that it takes in, and overrides
    `begin`, `settings`, `tasks`, `received` and `attention`; it sends with `send`.
    """

    discrete = True
    transient = Component.transient | {
        "_node",
        "_transfers",
        "_parameters",
        "_allocatee",
        "_wanted",
    }
    messages: ClassVar[tuple[Any, ...]] = ()

    node_id = Parameter(0.0, "1", "node ID, 0: an allocator gives it", min=0.0, max=LARGEST_ID)
    node_name = Parameter("org.seatrial.node", "1", "name of the node", check=check_name)
    unique_id = Parameter("", "1", "unique ID, 32 hexadecimal digits", check=check_unique_id)
    software_version = Parameter("1.0", "1", "version of the software", check=check_version)
    hardware_version = Parameter("1.0", "1", "version of the hardware", check=check_version)

    rx = Input("1", "operations from the bus", type=str, role="can")

    tx = Output("1", "operations to the bus", type=str, role="can")
    own_id = Output("1", "node ID that it has, 0 while it has none", type=int)
    malformed = Output("1", "transfers received that could not be understood", type=int)

    terminals: ClassVar = {"bus": terminal("tx", "rx")}

    # ------------------------------------------------------------------ written by nodes

    def begin(self) -> None:
        """Set what a restart sets anew."""

    def settings(self) -> Sequence[Setting]:
        """Return the parameters that the bus may see, without ``NODE_ID``."""
        return ()

    def tasks(self) -> Sequence[Task]:
        """Return what is done again and again."""
        return ()

    def received(self, time_ns: int, transfer: Transfer) -> None:
        """Take in a message of `messages`, which was on the bus at ``time_ns``."""

    def attention(self) -> bool:
        """Return whether the node's health is a warning."""
        return False

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Make the node; raises InputError for values that cannot be."""
        if self.node_id % 1.0:
            raise InputError(f"{self.name}: node_id is {self.node_id!r}, a whole number is needed")
        self._can: dict[str, Any] = {}
        self._link: dict[str, Any] = {}
        self._stored: dict[str, Any] = {}
        self._allocating: dict[str, Any] = {}
        self._boots = -1
        self._view()
        self._boot()

    def step(self, t: float, h: float) -> None:
        """Take in what was received, and send what is due from ``t`` to before ``t + h``."""
        wanted = self._wanted if self._id else _ALLOCATION
        restarts = False
        for when, transfer in self._transfers.receive(self.rx, wanted, self._id):
            if not self._id:
                self._receive_allocation(transfer)
            elif transfer.service_not_message:
                restarts |= self._serve(transfer)
            else:
                self.received(when, transfer)
        if restarts:
            self._boot()
        self._do_what_is_due(self.now_ns + round(h * NS))
        self._node.flush()

    def outputs(self, t: float) -> None:
        """Publish what is sent."""
        self.publish("tx", self._node.text)
        self.publish("own_id", self._id)
        self.publish("malformed", self._transfers.malformed)

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        if "_link" in state:
            self._view()

    def send(self, time_ns: int, message: Any, priority: int) -> None:
        """Send a message at ``time_ns``."""
        self._transfers.broadcast(time_ns, self._id, message, priority)

    def publish(self, name: str, value: Any) -> None:
        """Set an output; with axes, to a tuple."""
        if getattr(self, name) != value:  # mostly it is the same, and quicker read than set
            setattr(self, name, value)

    @property
    def visible(self) -> list[Setting]:
        """The parameters that the bus sees."""
        return [Setting("NODE_ID", int(self.node_id), 0, LARGEST_ID), *self.settings()]

    def setting(self, name: str) -> Any:
        """Return a parameter of `settings`, as it is now."""
        return self._parameters.value(name)

    # ------------------------------------------------------------------ inside

    def _view(self) -> None:
        """Make what looks at the state."""
        self._node = CanNode(self._can)
        self._transfers = Transfers(self._link, self._node)
        self._parameters = ParameterServer(self._stored, self.visible)
        self._allocatee = Allocatee(self._allocating, self._unique_id, self._draw)
        messages = ((message.default_dtid, False) for message in self.messages)
        self._wanted: frozenset[Kind] = _SERVICES.union(messages)

    def _boot(self) -> None:
        self._boots += 1
        self._link.clear()
        self._parameters.restart()
        self._transfers = Transfers(self._link, self._node)
        self._begun_ns = self.now_ns
        self._due: dict[str, int] = {}
        self._periods: dict[str, int] = {}
        self._periods_may_differ = True
        self._id: int = self.setting("NODE_ID")
        if not self._id:
            self._allocatee.begin(self.now_ns)
        self.begin()

    @property
    def _unique_id(self) -> bytes:
        written: str = self.unique_id
        return bytes.fromhex(written) or hashlib.sha256(self.name.encode()).digest()[:16]

    def _draw(self, k: int) -> float:
        """Return random number ``k`` of this node since it was started, 0 to 1."""
        number = (self._boots << 32) + _FIRST_DRAW + k
        return float(self.generator(number, zlib.crc32(self._unique_id)).random())

    def _receive_allocation(self, transfer: Transfer) -> None:
        self._id = self._allocatee.receive(self.now_ns, transfer)

    def _do_what_is_due(self, end_ns: int) -> None:
        while not self._id and self._allocatee.due_ns < end_ns:
            when = self._allocatee.due_ns
            message, discriminator = self._allocatee.request()
            self._transfers.broadcast_anonymously(when, message, discriminator)
        if self._id and (self._periods_may_differ or min(self._due.values()) < end_ns):
            self._periods_may_differ = False
            self._do_tasks(end_ns)

    def _do_tasks(self, end_ns: int) -> None:
        tasks = [Task("status", STATUS_NS / NS, self._send_status), *self.tasks()]
        self._schedule(tasks)
        while True:
            task = min((each for each in tasks if _ns(each.period)), key=self._due_ns)
            when = self._due_ns(task)
            if when >= end_ns:
                return
            task.act(when)
            self._due[task.name] = when + _ns(task.period)

    def _due_ns(self, task: Task) -> int:
        return self._due[task.name]

    def _schedule(self, tasks: Sequence[Task]) -> None:
        """Let tasks that are new, or have another period than before, begin."""
        for number, task in enumerate(tasks):
            period = _ns(task.period)
            if self._periods.get(task.name, 0) == period:
                continue
            self._periods[task.name] = period
            late = self._draw(number - _FIRST_DRAW) if task.spread else 0.0
            self._due[task.name] = self.now_ns + int(late * period)
            if not period:
                del self._due[task.name]

    # ------------------------------------------------------------------ services

    def _serve(self, request: Transfer) -> bool:
        """Answer a request; return whether the node restarts."""
        requested, restarts = request.payload, False
        if not request.request_not_response:
            return False
        if requested._type is GetNodeInfo:
            response = self._info()
        elif requested._type is RestartNode:
            restarts = requested.magic_number == requested.MAGIC_NUMBER
            response = RestartNode.Response(ok=restarts)
        else:
            response = self._parameters.answer(requested)
            self._periods_may_differ = True
        self._transfers.respond(self.now_ns, self._id, request, response)
        return restarts

    def _send_status(self, time_ns: int) -> None:
        self.send(time_ns, self._status(time_ns), LOW)

    def _status(self, time_ns: int) -> Any:
        status = NodeStatus(uptime_sec=(time_ns - self._begun_ns) // NS)
        status.health = status.HEALTH_WARNING if self.attention() else status.HEALTH_OK
        status.mode = status.MODE_OPERATIONAL
        return status

    def _info(self) -> Any:
        info = GetNodeInfo.Response(status=self._status(self.now_ns), name=self.node_name)
        for version, written in (
            (info.software_version, self.software_version),
            (info.hardware_version, self.hardware_version),
        ):
            version.major, version.minor = map(int, written.split("."))
        info.hardware_version.unique_id = list(self._unique_id)
        return info


def _ns(period: float) -> int:
    return max(SHORTEST_NS, round(period * NS)) if period > 0.0 else 0
