"""Restored checkpoints: every value of components, network, loops and algorithms as it was."""

from __future__ import annotations

import pytest

from tests.snapshot import changed, snapshot

from .conftest import Bench

PARTS = """
ramp = { fmu = "users.py:Ramp" }
scale = { fmu = "users.py:Scale", set = { gain = -0.9 } }
back = { fmu = "users.py:Scale", set = { gain = 0.9 } }
sum = { fmu = "users.py:Sum" }
clock = { fmu = "users.py:Clock" }
"""
CONNECTIONS = """
"scale.y" = ["back.u", "clock.u"]
"back.y" = "scale.u"
"ramp.y" = "sum.u"
"""
STATISTICS = frozenset({"times", "_checkpoint"})


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "algorithm", ["jacobi", "plain-jacobi", "gauss-seidel", "extrapolated", "iterated"]
)
def test_everything_is_as_it_was_saved(direct: Bench, algorithm: str) -> None:
    top = f'step = "100 ms"\nalgorithm = "{algorithm}"'
    master = direct.master(PARTS, CONNECTIONS, top=top)
    master.step()
    master.override("ramp", "y", 7.0)  # what it is by itself is restored too
    master.step()
    rollback = master._rollback
    rollback._save(master.steps)
    saved = snapshot(rollback, STATISTICS)
    for _ in range(3):
        rollback.algorithm.advance(master.steps, master.time_ns, master.step_ns)
        master.steps += 1
    for group in master._feedthrough.groups:
        group.relaxation /= 2.0
    different = changed(saved, snapshot(rollback, STATISTICS))
    rollback.restore(rollback._checkpoint)
    assert different
    assert changed(saved, snapshot(rollback, STATISTICS)) == set()


@pytest.mark.parametrize("algorithm", ["extrapolated", "iterated"])
def test_algorithms_that_remember_repeat_their_steps(direct: Bench, algorithm: str) -> None:
    """The steps after a checkpoint, once more from it, give the same bits."""
    top = f'step = "100 ms"\nalgorithm = "{algorithm}"'
    connections = '"one.x" = "two.u"\n"two.x" = "one.u"'
    parts = 'one = { fmu = "users.py:Sum" }\ntwo = { fmu = "users.py:Sum", set = { rate = -3 } }'
    ramp = '\nramp = { fmu = "users.py:Ramp" }\nthree = { fmu = "users.py:Sum" }'
    master = direct.master(parts + ramp, connections + '\n"ramp.y" = "three.u"', top=top)
    rollback = master._rollback
    advance = rollback.algorithm.advance
    for k in range(3):
        advance(k, k * master.step_ns, master.step_ns)
    rollback._save(3)
    runs = []
    for _ in range(2):
        rollback.restore(rollback._checkpoint)
        for k in range(3, 6):
            advance(k, k * master.step_ns, master.step_ns)
        runs.append(list(master.signals))
    assert runs[0] == runs[1]
