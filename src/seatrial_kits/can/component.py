"""A CAN bus as a component: frames of its nodes in, frames for its nodes out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from seatrial.errors import InputError, SimulationError, unknown
from seatrial.links.parameter_validation import whole_number
from seatrial.links.text import Inbox, Outbox, chunk
from seatrial.model.component import (
    NS,
    Component,
    Input,
    Logging,
    Noise,
    Output,
    Parameter,
    terminal,
)

from .bus_state import restore, saved
from .controller import Controller
from .disturbances import Disturbances
from .frame import Frame
from .operations import (
    ArbitrationLost,
    BitRate,
    Buffering,
    BusError,
    Confirm,
    FormatError,
    Operation,
    Status,
    Transmit,
    Wakeup,
    decode,
    encode,
)
from .run_log import RunLog
from .simulated_bus import PS, Broken, GivenUp, Sent, SimulatedBus

NODES = 12
"""Most nodes of one bus."""
WATCHED = 8
"""Most identifiers whose latency is on an output."""
FAULTS = ("none", "off", "babbling", "defective")
"""Values of a node's fault."""

_NODES = tuple(f"n{number}" for number in range(1, NODES + 1))
_WATCHED = tuple(f"l{number}" for number in range(1, WATCHED + 1))
_PS_PER_NS = 1000


class CanBus(Logging, Noise, Component):
    """A CAN or CAN FD bus of up to 12 nodes, in exact simulated time.

    **Nodes** are named by ``nodes`` and have the ports ``tx.n1``, ``rx.n1`` and so on, in their
    order. What passes there are operations of FMI-LS-BUS (`operations`) in texts
    (`seatrial.links.text`): to the bus `Transmit`, `BitRate`, `Buffering`; from it `Transmit`,
    `Confirm`, `ArbitrationLost`, `BusError`, `FormatError`, each with its time. A node that expects
    another bit rate is refused.

    **Time.** Frames, queues and arbitration are `SimulatedBus`'s: to the bit, however coarse the
    communication step. In the step from t to t + h the bus runs until t, since all that nodes
    requested until then is known; so what ended by t is on ``rx`` and on all other outputs at
    t + h: one step late, with the time at which it ended, and never wrong.

    **Controllers** have ``mailboxes`` and a queue of ``queue_length`` (`Controller`), and come back
    from bus-off if ``recovery`` is on. Those of ``listen_only`` never send, acknowledge or object.

    **What goes wrong**: ``bit_error_rate`` for all, ``receive_error_rate`` of single nodes
    (`Disturbances`): error frames, and frames sent again. ``loss`` and ``receive_loss``: frames
    that are sent and acknowledged and yet do not reach any node's, or one node's, software: a full
    buffer. ``fault`` of a node: off (out of the bus), babbling (sends the highest priority all the
    time), defective (its own frames are broken, until it is off the bus).

    **Outputs.** ``load`` is the share of time that frames, error frames and intermissions took
    in the last ``load_window``. Counts are of the whole run. ``latency`` is the time from the
    request to the end of the frame, for each identifier in ``watched`` (numbers, as 0x09F11217,
    29 bits if there are more than three digits): the longest of those that ended since the step
    before, or else the last.

    In ``run_folder`` it leaves ``NAME.blf``, ``NAME.log`` and ``NAME.json`` (`RunLog`).

    Not modelled: CAN XL, sleep, propagation and clock tolerance, overload frames, the 6 to 12
    bits of superposed flags in between.

    Raises InputError at the start for nodes and identifiers that cannot be.
    """

    transient = Component.transient | {"_bus", "_wrong", "_run_log", "_ports"}

    nodes = Parameter("n1 n2", "1", "names of the nodes, separated by spaces")
    bit_rate = Parameter(250_000.0, "1/s", "bit rate", min=1000.0, max=1e6)
    data_bit_rate = Parameter(
        2_000_000.0, "1/s", "bit rate of CAN FD's data phase", min=1000.0, max=2e7
    )
    mailboxes = Parameter(3.0, "1", "mailboxes of each controller", min=1.0, max=1000.0)
    queue_length = Parameter(100.0, "1", "longest queue before the mailboxes", min=0.0, max=1e6)
    recovery = Parameter("on", "1", "whether nodes come back from bus-off", choices=("on", "off"))
    listen_only = Parameter("", "1", "names of nodes that only listen")
    bit_error_rate = Parameter(
        0.0, "1", "probability that a bit is wrong", min=0.0, max=1.0, tunable=True
    )
    receive_error_rate = Parameter(
        0.0,
        "1",
        "probability that a node alone sees a wrong bit",
        axes=_NODES,
        min=0.0,
        max=1.0,
        tunable=True,
    )
    loss = Parameter(
        0.0, "1", "probability that no node's software gets a frame", min=0.0, max=1.0, tunable=True
    )
    receive_loss = Parameter(
        0.0,
        "1",
        "probability that a node's software does not get a frame",
        axes=_NODES,
        min=0.0,
        max=1.0,
        tunable=True,
    )
    watched = Parameter("", "1", "identifiers whose latency is reported, separated by spaces")
    load_window = Parameter(1.0, "s", "time over which the load is counted", min=1e-3)

    tx = Input("1", "operations from the nodes", type=str, role="can", axes=_NODES, optional=True)
    fault = Input(
        "1",
        f"{', '.join(FAULTS)}",
        type=str,
        axes=_NODES,
        start=("none",) * NODES,
        optional=True,
        role="fault",
    )

    rx = Output("1", "operations to the nodes", type=str, role="can", axes=_NODES)
    load = Output("1", "share of time that the bus is busy")
    frames = Output("1", "frames sent", type=int)
    error_frames = Output("1", "error frames", type=int)
    state = Output("1", "1 error active, 2 error passive, 3 bus-off", type=int, axes=_NODES)
    tec = Output("1", "transmit error counter", type=int, axes=_NODES)
    rec = Output("1", "receive error counter", type=int, axes=_NODES)
    queued = Output("1", "frames that wait", type=int, axes=_NODES)
    dropped = Output("1", "frames that found no place", type=int, axes=_NODES)
    sent = Output("1", "frames sent", type=int, axes=_NODES)
    received = Output("1", "frames received", type=int, axes=_NODES)
    lost = Output("1", "frames that were sent and not received", type=int, axes=_NODES)
    latency = Output("s", "of the identifiers watched", axes=_WATCHED)

    feedthrough: ClassVar = {}
    # One for each node: its terminal `bus` joins it.
    terminals: ClassVar = {n: terminal(tx=f"tx.{n}", rx=f"rx.{n}") for n in _NODES}

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._run_log: RunLog | None = None

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Make the bus; raises InputError for names and identifiers that cannot be."""
        names = _names(self.nodes, NODES)
        silent = _among(self.listen_only, names, "listen_only")
        self._keys = _identifiers(self.watched)
        self._begun_ns = self.now_ns
        self._inboxes: list[dict[str, Any]] = [{} for _ in names]
        self._outboxes: list[dict[str, Any]] = [{} for _ in names]
        self._latencies = [0.0] * WATCHED
        self._longest = [0.0] * WATCHED
        self._frames = self._error_frames = 0
        self._busy: list[list[int]] = [[self.now_ns, 0]]
        self._losses = [0.0] * (1 + len(names))
        self._build(names, silent)

    def step(self, t: float, h: float) -> None:
        """Take in what nodes have requested, and let the bus run until ``t``."""
        if self._run_log is not None:
            self._run_log.open(self.run_folder)
        for node, (inbox, text) in enumerate(zip(self._inboxes, self.tx, strict=False)):
            for when, data in Inbox(inbox).take(text):
                self._receive(node, when, data)
        self._longest = [0.0] * WATCHED
        self._bus.run(self.now_ns * _PS_PER_NS)
        self._latencies = [
            new or last for new, last in zip(self._longest, self._latencies, strict=True)
        ]
        for port in self._ports:
            port.flush()
        self._count_load(self.now_ns)
        self._apply_faults()

    def outputs(self, t: float) -> None:
        """Publish the bus's operations and counters."""
        each = self._bus.controllers
        nothing = (0,) * (NODES - len(each))
        self.rx = [*(port.text for port in self._ports), *("" for _ in nothing)]
        for name, values in (
            ("state", [int(c.state) for c in each]),
            ("tec", [c.tec for c in each]),
            ("rec", [c.rec for c in each]),
            ("queued", [c.waiting for c in each]),
            ("dropped", [c.dropped for c in each]),
            ("sent", [c.sent for c in each]),
            ("received", [c.received for c in each]),
            ("lost", [c.lost for c in each]),
        ):
            whole = (*values, *nothing)
            if getattr(self, name) != whole:  # mostly it is the same, and quicker read than set
                setattr(self, name, whole)
        self.frames, self.error_frames = self._frames, self._error_frames
        self.latency = self._latencies
        begun, last = self._busy[0], self._busy[-1]
        passed = last[0] - begun[0]
        self.load = (last[1] - begun[1]) / (passed * _PS_PER_NS) if passed else 0.0

    def close(self) -> None:
        """End the logs."""
        if self._run_log is not None:
            self._run_log.close(self._bus, self._begun_ns * _PS_PER_NS)

    def get_state(self) -> dict[str, Any]:
        """Return a copy of the whole state, the bus's included, as plain data."""
        return {**super().get_state(), "bus": saved(self._bus), "wrong": self._wrong.saved()}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        own = {name: value for name, value in state.items() if name not in ("bus", "wrong")}
        super().set_state(own)
        restore(self._bus, state["bus"])
        self._wrong.restore(state["wrong"])
        self._ports = [Outbox(memory) for memory in self._outboxes]

    def _build(self, names: list[str], silent: list[str]) -> None:
        queue, mailboxes = (
            whole_number("queue_length", self.queue_length),
            whole_number("mailboxes", self.mailboxes),
        )
        recovers = self.recovery == "on"
        controllers = [
            Controller(name, queue, mailboxes, name in silent, recovers) for name in names
        ]
        self._wrong = Disturbances(self.generator, len(names))
        self._bus = SimulatedBus(
            controllers,
            whole_number("bit_rate", self.bit_rate),
            whole_number("data_bit_rate", self.data_bit_rate),
            self._wrong,
            self._was_sent,
            self._was_broken,
            self._was_given_up,
            now_ps=self.now_ns * _PS_PER_NS,
            counted_ps=self.now_ns * _PS_PER_NS,
        )
        self._ports = [Outbox(memory) for memory in self._outboxes]
        self._run_log = RunLog(self.name)

    # ------------------------------------------------------------------ nodes

    def _receive(self, node: int, when: int, data: bytes) -> None:
        try:
            operations = decode(data)
        except InputError:
            self._send(node, when, FormatError(data))
            return
        for operation in operations:
            match operation:
                case Transmit(frame):
                    self._bus.request(when * _PS_PER_NS, node, frame)
                case BitRate(rate, fd):
                    self._agree(node, rate, fd)
                case Buffering(waits):
                    self._bus.controllers[node].waits = waits
                case Wakeup():
                    for other in range(len(self._ports)):
                        if other != node:
                            self._send(other, when, operation)
                case Status() | FormatError():
                    pass  # this bus counts its nodes' errors itself, and has nothing to repeat
                case _:
                    self._send(node, when, FormatError(data))

    def _agree(self, node: int, rate: int, fd: bool) -> None:
        own = self.data_bit_rate if fd else self.bit_rate
        if rate != own:
            name = self._bus.controllers[node].name
            what = "data_bit_rate" if fd else "bit_rate"
            raise SimulationError(
                f"{self.name}: node {name!r} has {rate} bit/s, the bus's {what} is {own:g}"
            )

    def _send(self, node: int, when_ns: int, operation: Operation) -> None:
        self._ports[node].put(when_ns, encode(operation))

    # ------------------------------------------------------------------ what happens

    def _was_sent(self, sent: Sent) -> None:
        self._frames += 1
        attempt, frame = self._bus.attempts, sent.frame
        latency = sent.end_ps - sent.requested_ps
        key = [frame.identifier, frame.extended]
        if key in self._keys:
            place = self._keys.index(key)
            self._longest[place] = max(self._longest[place], latency / PS)
        if self._run_log is not None:
            self._run_log.sent(attempt, sent, latency)
        when = _rounded_up(sent.end_ps)
        for node in sent.senders:
            self._send(node, when, Confirm(frame.identifier))
        gone = self._losers(attempt)
        received = chunk(when, encode(Transmit(frame)))
        for node in sent.receivers:
            if node in gone:
                self._bus.controllers[node].lost += 1
            else:
                self._ports[node].put_chunk(received)

    def _losers(self, attempt: int) -> set[int]:
        """Return the nodes whose software loses the frame of an attempt."""
        losses = self._losses
        if not any(losses):
            return set()
        draws = self.generator(attempt, 1).random(len(losses)).tolist()
        if draws[0] < losses[0]:
            return set(range(len(losses)))
        return {node for node in range(len(losses) - 1) if draws[1 + node] < losses[1 + node]}

    def _was_broken(self, broken: Broken) -> None:
        self._error_frames += 1
        if self._run_log is not None:
            self._run_log.broken(self._bus.attempts, broken)
        for node, each in enumerate(self._bus.controllers):
            if each.plugged and not each.listens_only:
                first, sender = node == broken.first, node in broken.senders
                error = BusError(broken.frame.identifier, broken.error, first, sender)
                self._send(node, _rounded_up(broken.end_ps), error)

    def _was_given_up(self, lost: GivenUp) -> None:
        when = _rounded_up(lost.when_ps)
        self._send(lost.node, when, ArbitrationLost(lost.frame.identifier))

    def _apply_faults(self) -> None:
        bus, faults = self._bus, self.fault
        for node, each in enumerate(bus.controllers):
            fault = faults[node]
            if fault not in FAULTS:
                raise InputError(f"{self.name}.{unknown(f'fault.{_NODES[node]}', fault, FAULTS)}")
            each.babbles = fault == "babbling"
            if each.plugged and fault == "off":
                bus.unplug(node)
            elif not each.plugged and fault != "off":
                bus.plug(node)
        nodes = len(bus.controllers)
        self._wrong.bit_error_rate = self.bit_error_rate
        self._wrong.receive_error_rate = list(self.receive_error_rate[:nodes])
        self._wrong.defective = [n for n in range(nodes) if faults[n] == "defective"]
        self._losses = [self.loss, *self.receive_loss[:nodes]]

    def _count_load(self, now_ns: int) -> None:
        self._busy.append([now_ns, self._bus.busy_ps])
        oldest = now_ns - round(self.load_window * NS)
        while len(self._busy) > 2 and self._busy[1][0] <= oldest:
            self._busy.pop(0)


def _rounded_up(time_ps: int) -> int:
    """Return a time in ns: nothing is reported before it has happened."""
    return -(-time_ps // _PS_PER_NS)


def _names(written: str, most: int) -> list[str]:
    names = written.split()
    if not 1 <= len(names) <= most or len(set(names)) < len(names):
        raise InputError(f"nodes is {written!r}, 1 to {most} different names are needed")
    return names


def _among(written: str, names: list[str], what: str) -> list[str]:
    for name in written.split():
        if name not in names:
            raise InputError(unknown(f"node in {what}", name, names))
    return written.split()


def _identifiers(written: str) -> list[list[Any]]:
    """Return (identifier, extended) of each; more than three digits are an extended one."""
    found = []
    for text in written.split():
        try:
            number = int(text, 16)
        except ValueError:
            raise InputError(f"watched: {text!r} is no identifier, such as 0x09F11217") from None
        extended = len(text.removeprefix("0x")) > 3
        Frame(number, extended=extended)
        found.append([number, extended])
    if len(found) > WATCHED:
        raise InputError(f"watched has {len(found)} identifiers, {WATCHED} at most")
    return found
