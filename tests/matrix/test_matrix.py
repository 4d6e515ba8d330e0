"""Every engine with every link, whatever happens to them: status, message, neutral, nothing left.

The kinds of links are those of the registries; a new one is in the matrix by itself. ``make test``
runs cells among which is each pair of kind, carrier and event, those of one run together, ``make
test-long`` every cell alone.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections import Counter
from itertools import product
from pathlib import Path

import pytest

import seatrial_kits.live.session  # noqa: F401  every copy of this process has it then
from seatrial.cli.running import run_options

from . import kinds as reasons
from .cells import CARRIERS, EVENTS, applying, every, excuse, kinds, pairwise, runs
from .run import Rig, Run

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/proc, terminals")

EXCUSED = {
    reasons.RAW: 7,
    reasons.NO_CONNECTION: 5,
    reasons.COME_AND_GO: 11,
    reasons.NO_PORT: 6,
    reasons.ALONE: 2,
    reasons.NAMESPACE: 7,
    reasons.NODES: 14,
}
"""Kinds and events that do not apply, by their reason; each with every carrier."""
KEPT = hasattr(run_options, "HangAfter")
"""Whether there is a keeper, which ends runs that hang or have lost a link."""
CELLS = applying(every())
SHARED = [
    pytest.param(*run, names, id=" ".join(run)) for run, names in runs(pairwise(CELLS)).items()
]
ALONE = [pytest.param(c.carrier, c.event, [c.kind], id=" ".join(c)) for c in CELLS]


def test_every_kind_of_the_registries_has_another_end() -> None:
    assert [name for name in kinds() if reasons.Kind.of(name) is None] == []


def test_cells_that_do_not_apply_are_these() -> None:
    found = Counter(why for cell in every() if (why := excuse(cell)))
    assert {why: count / len(CARRIERS) for why, count in found.items()} == EXCUSED


def test_each_pair_is_among_the_chosen_cells() -> None:
    for one, other in ((0, 1), (0, 2), (1, 2)):
        wanted = {(cell[one], cell[other]) for cell in CELLS}
        assert {(cell[one], cell[other]) for cell in pairwise(CELLS)} == wanted
    assert {(c, e) for _, c, e in CELLS} == set(product(CARRIERS, EVENTS))
    assert pairwise(CELLS) == pairwise(applying(every()))


@pytest.mark.slow
@pytest.mark.parametrize(("carrier", "event", "names"), SHARED)
def test_pairs(carrier: str, event: str, names: list[str], tmp_path: Path) -> None:
    happens(carrier, event.partition(" of ")[0], names, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize(("carrier", "event", "names"), ALONE)
def test_every_cell(carrier: str, event: str, names: list[str], tmp_path: Path) -> None:
    happens(carrier, event, names, tmp_path)


def happens(carrier: str, event: str, names: list[str], folder: Path) -> None:
    """Let a thing happen to a run with links of some kinds, and look at what comes of it."""
    if event in ("hang", "unplug") and not KEPT:
        pytest.skip("there is no keeper yet")
    rig = Rig(folder, names, isolated=carrier == "isolated", hangs=event == "hang")
    rig.write_trial({"start": 1.0, "garbage": 2.0}.get(event, 1000.0))
    if event == "port taken":
        for peer in rig.peers.values():
            peer.take()
    # A link that is lost ends a run with devices alone.
    run = Run(rig, carrier, *(["--hardware"] if event == "unplug" else []))
    try:
        _HAPPEN[event](rig, run)
        assert "Traceback" not in run.said
        assert run.left(orderly=event not in ("hang", "kill")) == []
    finally:
        run.close()
        rig.close()


def _started(rig: Rig, run: Run) -> None:
    assert run.wait() == 0, run.said
    assert rig.silent() == []


def _garbled(rig: Rig, run: Run) -> None:
    """Send garbage as soon as a peer is there, and again; it is counted."""
    sent = dict.fromkeys(rig.peers, 0)

    def throw() -> bool:
        for own, peer in rig.peers.items():
            if peer.received and sent[own] < 20:
                sent[own] += 1
                peer.send(rig.kinds[own].garbage)
        return False

    run.wait_for(throw, "it does not end")
    assert run.wait() == 0, run.said
    row = run.last_row()
    counts = {own: int(row[f"{own}.{kind.counter}"]) for own, kind in rig.kinds.items()}
    assert [own for own, count in counts.items() if count == 0] == [], (counts, sent)


def _unplugged(rig: Rig, run: Run) -> None:
    ((own, peer),) = rig.peers.items()
    run.wait_until_received()
    peer.unplug()
    assert run.wait() == 3, run.said
    assert f"{own}: " in run.said
    assert "lost" in run.said
    assert _manifest(run)["status"] == "failed"


def _taken(rig: Rig, run: Run) -> None:
    assert run.wait() == 2, run.said
    ((own, _),) = rig.peers.items()
    assert f"{own}: " in run.said
    assert "cannot open the " in run.said
    assert not (run.folder / "run").exists()


def _hung(rig: Rig, run: Run) -> None:
    run.wait_until_received()
    assert run.wait() == 3, run.said
    assert "hanging: " in run.said
    _is_stopped(rig, run, "failed")


def _terminated(rig: Rig, run: Run) -> None:
    run.wait_until_received()
    os.kill(run.pid, signal.SIGTERM)
    assert run.wait() == 3, run.said
    _is_stopped(rig, run, "stopped")


def _killed(rig: Rig, run: Run) -> None:
    run.wait_until_received()
    os.kill(run.child(), signal.SIGKILL)
    assert run.wait() == 3, run.said
    assert "SIGKILL" in run.said
    _is_stopped(rig, run, "failed")


def _is_stopped(rig: Rig, run: Run, status: str) -> None:
    """Check the manifest, and that every link that moves something has sent neutral last."""
    assert _manifest(run)["status"] == status
    ends = {own: kind.neutral for own, kind in rig.kinds.items() if kind.neutral is not None}
    moving = [own for own, ends_so in ends.items() if not ends_so(rig.peers[own].received)]
    assert moving == [], ({own: rig.peers[own].received[-80:] for own in moving}, run.said)


def _manifest(run: Run) -> dict[str, object]:
    content: dict[str, object] = json.loads((run.folder / "run" / "manifest.json").read_text())
    return content


_HAPPEN = {
    "start": _started,
    "garbage": _garbled,
    "unplug": _unplugged,
    "port taken": _taken,
    "hang": _hung,
    "term": _terminated,
    "kill": _killed,
}
