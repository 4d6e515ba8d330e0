"""Faults of streams against their definitions: chunks of a text port."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from seatrial.errors import SimulationError
from seatrial.links import text
from seatrial.model.faults.catalogue import STREAMS
from seatrial.sim.master import Master

from .conftest import Bench, value
from .test_faults import inject

SENDER = '''
from seatrial.model.component import Component, Input, Output
from seatrial.links.text import Inbox, Outbox

class Sender(Component):
    """Sends its step's number, twice, in four bytes each: at its beginning and in its midst."""

    tx = Output("1", "bytes", type=str)

    def start(self, t):
        self.memory, self.count = {}, 0

    def step(self, t, h):
        for late in (0, 50_000_000):
            Outbox(self.memory).put(round(t * 1e9) + late, self.count.to_bytes(4, "big"))
            self.count += 1
        Outbox(self.memory).flush()

    def outputs(self, t):
        self.tx = Outbox(self.memory).text


class Reader(Component):
    """Lists what arrives, as TIME:NUMBER."""

    rx = Input("1", "bytes", type=str)
    got = Output("1", "what arrived", type=str)

    def start(self, t):
        self.memory, self.seen = {}, ""

    def step(self, t, h):
        for when, data in Inbox(self.memory).take(self.rx):
            self.seen += f" {when // 1_000_000}:{data.hex()}"

    def outputs(self, t):
        self.got = self.seen
'''
PARTS = 'sender = { fmu = "sender.py:Sender" }\nreader = { fmu = "sender.py:Reader" }'


def arrived(bench: Bench, steps: int, *faults: dict[str, Any]) -> list[tuple[int, str]]:
    """Return the time in ms and the bytes of all that arrives in so many steps."""
    (bench.folder / "sender.py").write_text(SENDER, "utf-8")
    master = Master(bench.system(PARTS, '"sender.tx" = "reader.rx"'))
    for fault in faults:
        inject(master, **fault)
    master.initialise()
    for _ in range(steps):
        master.step()
    parts = [part.split(":") for part in value(master, "reader.got").split()]
    return [(int(when), data) for when, data in parts]


def sent(steps: int) -> list[tuple[int, str]]:
    return [(50 * k, k.to_bytes(4, "big").hex()) for k in range(2 * steps)]


def fault(what: str, **more: Any) -> dict[str, Any]:
    return {"what": what, "where": "sender.tx", **more}


def test_every_fault_of_a_stream_is_tested() -> None:
    assert set(STREAMS) == {"loss", "latency", "reorder", "duplicate", "corruption"}


@pytest.mark.parametrize("where", ["sender.tx", "reader.rx"])
def test_a_broken_link_loses_what_is_sent_meanwhile_and_nothing_else(
    bench: Bench, where: str
) -> None:
    loss = {"what": "loss", "where": where, "at": "0.3 s", "for": "0.2 s"}
    all_of = sent(9)
    assert arrived(bench, 10, loss) == [one for one in all_of if not 300 <= one[0] < 500]


def test_a_share_is_lost(direct: Bench) -> None:
    found = arrived(direct, 1001, fault("loss", probability=0.2))
    assert abs(2000 - len(found) - 400) < 3.9 * (2000 * 0.2 * 0.8) ** 0.5
    assert found == sorted(set(found))
    assert set(found) <= set(sent(1000))


def test_latency_is_the_same_for_all(bench: Bench) -> None:
    found = arrived(bench, 12, fault("latency", time="230 ms"))
    # Due at 50 k + 230 ms, shown at the next point and read in the step after it.
    assert found == [(when + 230, data) for when, data in sent(9) if when + 230 <= 1100]


def test_jitter_is_uniform_and_keeps_the_order(direct: Bench) -> None:
    found = arrived(direct, 1001, fault("latency", jitter="40 ms"))
    late = np.array([when - 50 * k for k, (when, _) in enumerate(found)])
    assert [data for _, data in found] == [data for _, data in sent(1000)][: len(found)]
    assert late.min() >= 0
    assert late.max() < 40  # below 50 ms nothing waits for the one before
    assert abs(late.mean() - 19.5) < 3.9 * 40 / (12 * len(late)) ** 0.5


def test_what_is_held_back_is_overtaken(direct: Bench) -> None:
    found = arrived(direct, 1010, fault("reorder", probability=0.1, time="120 ms"))
    order = [int(data, 16) for _, data in found]
    late = {k for k in range(2000) if k in order and order.index(k) > k - 1 and any(
        j > k for j in order[: order.index(k)]
    )}  # fmt: skip
    assert abs(len(late) - 200) < 3.9 * (2000 * 0.1 * 0.9) ** 0.5
    assert {when - 50 * int(data, 16) for when, data in found if int(data, 16) in late} == {120}


def test_a_share_comes_twice(direct: Bench) -> None:
    found = arrived(direct, 1001, fault("duplicate", probability=0.25))
    assert sorted(set(found)) == sent(1000)
    assert abs(len(found) - 2500) < 3.9 * (2000 * 0.25 * 0.75) ** 0.5


def test_each_bit_is_wrong_alike(direct: Bench) -> None:
    found = arrived(direct, 1001, fault("corruption", probability=0.02))
    flips = np.array(
        [
            [(int(got, 16) ^ int(was, 16)) >> bit & 1 for bit in range(32)]
            for (_, got), (_, was) in zip(found, sent(1000), strict=True)
        ]
    )
    assert abs(flips.sum() - 64000 * 0.02) < 3.9 * (64000 * 0.02 * 0.98) ** 0.5
    assert abs(flips.sum(axis=0) - 40).max() < 5 * (2000 * 0.02 * 0.98) ** 0.5


def test_several_faults_end_one_by_one_and_the_stream_goes_on(bench: Bench) -> None:
    found = arrived(
        bench,
        12,
        fault("latency", time="100 ms", at="0.1 s", **{"for": "0.4 s"}),
        fault("loss", at="0.4 s", **{"for": "0.1 s"}),
    )
    expected, last = [], 0
    for when, data in sent(11):  # the loss is of what comes late, and nothing overtakes
        last = max(when + (100 if 100 <= when < 500 else 0), last)
        if not 400 <= last < 500:
            expected.append((last, data))
    assert found == expected


@pytest.mark.parametrize("what", ["hang", "crash"])
@pytest.mark.parametrize("where", ["sender", "reader"])
def test_streams_of_a_component_that_stops_go_on_with_it(
    bench: Bench, what: str, where: str
) -> None:
    found = arrived(bench, 10, {"what": what, "where": where, "at": "0.3 s", "for": "0.3 s"})
    numbers = [int(data, 16) for _, data in found]
    if (what, where) == ("crash", "sender"):  # it counts from the beginning
        assert numbers == [0, 1, 2, 3, 4, 5, *range(6)]
    elif (what, where) == ("crash", "reader"):  # it has forgotten what it had
        assert numbers == [12, 13, 14, 15, 16, 17]
    else:
        assert numbers == [*range(6), *range(12, 18)]


def test_what_is_no_stream_is_said(direct: Bench) -> None:
    master = direct.master('turn = { fmu = "users.py:Turn" }')
    inject(master, what="loss", where="turn.text")
    with pytest.raises(SimulationError, match="no stream to disturb"):
        master.faults.act(master)


def test_the_numbers_of_texts_follow_each_other(direct: Bench) -> None:
    (direct.folder / "sender.py").write_text(SENDER, "utf-8")
    master = Master(direct.system(PARTS, '"sender.tx" = "reader.rx"'))
    inject(master, what="loss", where="sender.tx", probability=0.5, at="0.2 s", **{"for": "1 s"})
    master.initialise()
    seen = []
    for _ in range(20):
        master.step()
        seen.append(text.decode(value(master, "sender.tx"))[0])
    assert set(np.diff(seen)) <= {0, 1}
    assert np.diff(seen)[-5:].tolist() == [1] * 5
