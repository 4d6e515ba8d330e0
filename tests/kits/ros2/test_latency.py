"""Latency of commands in free running: to the very step that uses them."""

import time

import pytest

from benchmarks import ros2
from seatrial import Simulation

from . import peer


@pytest.mark.slow  # 50 ms of transport are for a machine that is not busy
def test_what_has_come_before_a_step_is_used_by_it(domain, monkeypatch, write):
    monkeypatch.setenv("CYCLONEDDS_URI", peer.LOOPBACK)
    write("probe.py", ros2.PROBE)
    rig = write("rig.toml", ros2.RIG % {"domain": domain, "period": 0.01})
    node = peer.Node(domain)
    writer = node.writer("/left/cmd_vel", peer.Twist)
    with Simulation(rig) as simulation:
        simulation.step(2)
        until = time.monotonic() + 10.0
        while not writer.get_matched_subscriptions():
            assert time.monotonic() < until
            time.sleep(0.01)
        for k in range(1, 11):
            writer.write(peer.Twist(peer.Vector3(x=0.1 * k), peer.Vector3()))
            time.sleep(0.05)  # it has come
            simulation.step(1)
            assert simulation.get("probe.used") == pytest.approx(0.1 * k)
    node.participant.__del__()


@pytest.mark.long
def test_99_of_100_commands_act_within_a_step_of_a_trial_in_real_time(domain):
    """From reception, which another process notes; steps of 50 ms, for machines that are busy."""
    _, shares = ros2.latencies(15, 0.05, domain)
    assert len(shares) > 100
    assert shares[int(0.99 * len(shares))] < 1.0
