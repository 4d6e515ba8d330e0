"""A record, played to nodes of ROS 2."""

from __future__ import annotations

import heapq
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from operator import itemgetter
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.plugins import service
from seatrial.sim.clock import Pacer
from seatrial.trial.records.run_folder import Run

from .joining import join
from .messages.definitions import INSTALL, type_store
from .messages.packing import packed
from .topics import LATCHED, PUBLISHED

_CLOCK = PUBLISHED["clock"]
_KEPT = tuple(PUBLISHED[key].name for key in LATCHED)
_MET_S = 1.0
"""Wall time that nodes are given to find the topics, before the first message."""
Message = tuple[int, str, bytes]
"""Time, ns, topic and bytes."""


def play(run: Run, stop_requested: Callable[[], int]) -> int:
    """Write a record's messages in real time, until it ends or a stop is requested.

    They are those of the bags that links wrote into the run's folder (``bag`` = "on"), else those
    of `seatrial export --ros2`; of the latter not the components' own types, which no node knows.
    The clock is written at every new time, where the bag has none. Returns how many were written.

    Raises InputError without the packages cyclonedds and rosbags, for a domain that cannot be
    joined, for types of another distribution, and for a run of which there is nothing to play.
    """
    try:
        from rosbags.rosbag2 import Reader
    except ImportError:
        raise InputError(f"ROS 2 needs rosbags, which is not installed: {INSTALL}") from None
    with ExitStack() as stack:
        bags = sorted(each.parent for each in run.folder.glob("*/metadata.yaml"))
        export = not bags
        if export:
            bags = [Path(stack.enter_context(tempfile.TemporaryDirectory()), "bag")]
            service("logs.bag")(run, bags[0])
        readers = [stack.enter_context(Reader(bag)) for bag in bags]
        topics = {
            each.topic: each.msgtype
            for reader in readers
            for each in reader.connections
            if each.msgtype in type_store().fielddefs
        }
        for each in (one for reader in readers for one in reader.connections):
            if each.topic in topics and each.digest != type_store().hash_rihs01(each.msgtype):
                raise InputError(
                    f"{run.folder}: {each.topic} is {each.msgtype} of another distribution than "
                    "this shell's: set ROS_DISTRO as it was in the run"
                )
        if not topics:
            raise InputError(f"{run.folder} has no craft: there is nothing to play to nodes")
        messages: Iterator[Message] = heapq.merge(
            *(_messages(reader, topics) for reader in readers), key=itemgetter(0)
        )
        if export:
            topics[_CLOCK.name] = _CLOCK.kind
            messages = _with_clock(messages)
        return _play(topics, messages, stop_requested)


def _messages(reader: Any, topics: dict[str, str]) -> Iterator[Message]:
    wanted = [each for each in reader.connections if each.topic in topics]
    for connection, at, data in reader.messages(connections=wanted):
        yield at, connection.topic, bytes(data)


def _with_clock(messages: Iterator[Message]) -> Iterator[Message]:
    """Yield the clock too, behind the messages of each time."""
    before = None
    for message in messages:
        if before is not None and message[0] != before:
            yield before, _CLOCK.name, packed(_CLOCK.kind, {"clock": before})
        before = message[0]
        yield message
    if before is not None:
        yield before, _CLOCK.name, packed(_CLOCK.kind, {"clock": before})


def _play(
    topics: dict[str, str], messages: Iterator[Message], stop_requested: Callable[[], int]
) -> int:
    transport, written = join(-1, "/seatrial_play"), 0
    try:
        writers = {
            topic: transport.writer(topic, kind, "latched" if topic.endswith(_KEPT) else "volatile")
            for topic, kind in topics.items()
        }
        time.sleep(_MET_S)
        pacer, now = Pacer(1.0, "slip"), None
        for at, topic, data in messages:
            if now is None:
                pacer.start(at)
            if at != now:
                pacer.keep(at, stop_requested)
                now = at
                if stop_requested():
                    break
            writers[topic].write(data)
            written += 1
    finally:
        transport.close()
    return written
