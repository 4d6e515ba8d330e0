"""PX4 as a component: lockstep, what goes on without it, and what cannot be."""

from __future__ import annotations

import logging
import math
import os
import signal
import threading
import time

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.links import watchdog

from .made import component, firmware, port_of
from .peer import Peer


def pulses(made):
    return [round(1e6 * each) for each in made.get("pulse")[:4]]


def test_each_step_waits_for_the_actuators_of_its_time():
    commands = [(0.5, 0.0, -0.5), (-1.0, 0.7, 1.0), (0.0, 0.0, 0.25)]

    def flies(peer):
        peer.sense()
        peer.act()  # it is armed: from now on each step waits
        for command in commands:
            peer.sense()
            time.sleep(0.1)
            peer.act(*command)

    with component() as made, firmware(made, flies):
        made.advance(0.0, 0.01)
        deadline = time.monotonic() + 10.0
        t = 0.01
        while not made.get("lockstep"):  # the first answer may come a step later
            assert time.monotonic() < deadline
            made._lockstep.idle(time.monotonic() + 0.01)
            made.outputs(t)
        seen = []
        for k in range(1, 4):
            begun = time.monotonic()
            made.advance(0.01 * k, 0.01)
            assert time.monotonic() - begun > 0.09
            seen.append(pulses(made))
        assert made.get("armed") is True
        assert made.get("missed") == 0
    # Channel 2 has no actuator; the neutral pulse of channel 3 is 1520 us.
    assert seen == [[1700, 0, 1310, 0], [1100, 0, 1900, 0], [1500, 0, 1615, 0]]


def test_nothing_is_waited_for_before_the_first_answer():
    def listens(peer):
        for _ in range(100):
            peer.sense()

    with component() as made, firmware(made, listens) as peer:
        begun = time.monotonic()
        for k in range(100):
            made.advance(0.01 * k, 0.01)
        assert time.monotonic() - begun < 5.0  # and not 100 times answer_limit
        assert made.get("connected") is True
        assert made.get("lockstep") is False
        assert pulses(made) == [1500, 0, 1520, 0]
    assert peer.us == 990_000


def test_without_lockstep_it_is_paced_so_that_the_firmware_keeps_up():
    def listens(peer):
        for _ in range(20):
            peer.sense()

    with component(speedup=1000.0) as made, firmware(made, listens):
        begun = time.monotonic()
        for k in range(20):
            made.advance(0.01 * k, 0.01)
        assert time.monotonic() - begun > 0.018  # ten times real time
    with component(speedup=0.5) as made, firmware(made, listens):
        begun = time.monotonic()
        for k in range(20):
            made.advance(0.01 * k, 0.01)
        assert time.monotonic() - begun > 0.38


def locked(made, peer):
    """Bring both in lockstep, in this thread; return the number of the next step."""
    made.advance(0.0, 0.01)
    peer.sense()
    peer.act(0.5)
    made._lockstep.idle(time.monotonic() + 0.05)
    made.outputs(0.01)
    assert made.get("lockstep") is True
    return 1


def test_when_none_come_in_time_it_goes_on_and_says_so(caplog):
    with component(answer_limit=0.2) as made:
        peer = Peer(port_of(made))
        k = locked(made, peer)
        begun = time.monotonic()
        with caplog.at_level(logging.WARNING):
            made.advance(0.01 * k, 0.01)
        assert 0.19 < time.monotonic() - begun < 5.0
        assert "PX4 is armed and gave no actuators within 0.2 s of wall time" in caplog.text
        assert (made.get("missed"), made.get("lockstep")) == (1, False)
        assert pulses(made)[0] == 1700  # what it gave last
        made.advance(0.01 * (k + 1), 0.01)  # without waiting
        assert made.get("missed") == 1
        peer.sense()
        peer.sense()
        peer.act(1.0)
        made._lockstep.idle(time.monotonic() + 0.05)
        made.outputs(0.03)
        assert (made.get("lockstep"), pulses(made)[0]) == (True, 1900)
        peer.close()


def test_at_shorter_steps_the_newest_actuators_are_as_old_as_their_period_at_most():
    """Controllers every 10 ms, steps of 4 ms: they answer the third, the fifth, the eighth ..."""

    def flies(peer):
        ran = -1
        for k in range(300):
            peer.sense()
            if k == 0 or 4 * k // 10 > ran:
                ran = 4 * k // 10
                peer.act(k / 1000)

    with component(answer_limit=30.0) as made, firmware(made, flies):
        begun = time.monotonic()
        late = []
        for k in range(300):
            made.advance(0.004 * k, 0.004)
            late.append(k - (1e6 * made.get("pulse")[0] - 1500.0) / 0.4)
        assert time.monotonic() - begun < 20.0
        assert made.get("missed") == 0
        assert made.get("lockstep") is True
    assert max(late[20:]) < 2.5


def test_a_disarmed_firmware_may_be_silent(caplog):
    with component(answer_limit=0.1) as made:
        peer = Peer(port_of(made))
        k = locked(made, peer)
        peer.act(0.9, armed=False, us=10_000)
        with caplog.at_level(logging.WARNING):
            made.advance(0.01 * k, 0.01)
            made.advance(0.01 * (k + 1), 0.01)
        assert "gave no actuators" not in caplog.text
        assert (made.get("armed"), pulses(made)) == (False, [1500, 0, 1520, 0])
        peer.close()


def test_what_is_no_number_is_neutral_and_limits_hold():
    with component() as made:
        peer = Peer(port_of(made))
        locked(made, peer)
        peer.act(math.nan, 0.0, 7.0, us=10_000)
        made.advance(0.01, 0.01)
        assert pulses(made) == [1500, 0, 1900, 0]
        peer.act(-3.0, 0.0, -math.inf, us=20_000)
        made.advance(0.02, 0.01)
        assert pulses(made) == [1100, 0, 1520, 0]
        peer.close()


def test_a_firmware_that_goes_leaves_neutral_and_one_that_comes_again_goes_on(caplog):
    with component() as made:
        peer = Peer(port_of(made))
        k = locked(made, peer)
        peer.close()
        others = []
        comes = threading.Timer(0.2, lambda: others.append(Peer(port_of(made))))
        comes.start()
        with caplog.at_level(logging.WARNING):
            made.advance(0.01 * k, 0.01)
        assert (made.get("connected"), made.get("armed")) == (True, False)
        assert pulses(made) == [1500, 0, 1520, 0]
        comes.join(20.0)
        (another,) = others
        another.sense()
        assert another.us == 10_000  # simulated time stood still
        assert made.get("restarts") == 1
        assert "PX4 connected again, at t = 0.01 s" in caplog.text
        another.close()


def test_one_that_goes_while_it_is_waited_for_ends_the_wait():
    with component(answer_limit=60.0) as made:
        peer = Peer(port_of(made))
        k = locked(made, peer)
        threading.Timer(0.2, peer.close).start()
        begun = time.monotonic()
        made.advance(0.01 * k, 0.01)
        assert time.monotonic() - begun < 5.0
        assert (made.get("connected"), made.get("missed")) == (False, 0)
        assert pulses(made) == [1500, 0, 1520, 0]


def test_a_second_firmware_is_left_out_while_the_first_is_there():
    with component() as made:
        first = Peer(port_of(made))
        k = locked(made, first)
        second = Peer(port_of(made))
        second.act(-1.0, us=10_000)
        first.act(0.25, us=10_000)
        made.advance(0.01 * k, 0.01)
        assert pulses(made)[0] == 1600
        with pytest.raises(TimeoutError):
            second.sense(0.1)
        assert made.get("restarts") == 0
        first.close()
        made._lockstep.idle(time.monotonic() + 0.05)
        made.advance(0.02, 0.01)
        second.sense()
        assert made.get("restarts") == 1
        second.close()


@pytest.fixture
def requests():
    """Signals that a program's own handler was given."""
    given = []
    before = signal.signal(signal.SIGINT, lambda number, frame: given.append(number))
    yield given
    signal.signal(signal.SIGINT, before)


def test_a_request_to_end_ends_the_wait_for_a_connection(requests):
    with component(wait_limit=0.0) as made:
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        made.advance(0.0, 0.01)
        assert requests == [signal.SIGINT]
        assert made.get("connected") is False
        peer = Peer(port_of(made))  # and it goes on if the run does
        made.advance(0.01, 0.01)
        peer.sense()
        assert peer.us == 10_000
        peer.close()


def test_a_request_to_end_ends_the_wait_for_actuators(requests):
    with component(answer_limit=60.0) as made:
        peer = Peer(port_of(made))
        k = locked(made, peer)
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        begun = time.monotonic()
        made.advance(0.01 * k, 0.01)
        assert time.monotonic() - begun < 5.0
        assert requests == [signal.SIGINT]
        assert (made.get("missed"), made.get("lockstep")) == (0, True)
        peer.close()


def test_it_says_what_to_start_and_who_is_being_waited_for(caplog, monkeypatch, tmp_path):
    monkeypatch.setattr(watchdog, "FIRST_S", 0.1)
    defaults = tmp_path / "boat.px4"
    defaults.write_text("MAV_TYPE 11 # boat\n\nPWM_MAIN_FUNC1   102\n")
    settings = {"defaults": str(defaults), "airframe": 50000.0, "imu": (0.1, 0.0, 0.0)}
    with component(**settings) as made, caplog.at_level(logging.WARNING):
        step = threading.Thread(target=made.advance, args=(0.0, 0.01))
        step.start()
        time.sleep(0.3)
        Peer(port_of(made)).close()
        step.join(10.0)
        port = port_of(made)
    said = caplog.text
    assert "start PX4, in a folder of its own:" in said
    assert "PX4_SYS_AUTOSTART=50000 PX4_SIMULATOR=none " in said
    assert " PX4_PARAM_MAV_TYPE=11 PX4_PARAM_PWM_MAIN_FUNC1=102 " in said
    assert " PX4_PARAM_EKF2_IMU_POS_X=0.1 " in said
    assert f"BUILD/bin/px4 -d -i {port - 4560} BUILD/etc" in said
    assert f"waiting for PX4, which is to connect to 127.0.0.1:{port}, since " in said


def test_nobody_waits_without_end_for_a_firmware_that_does_not_come():
    with component(wait_limit=0.2) as made:
        begun = time.monotonic()
        with pytest.raises(SimulationError, match=r"autopilot: nothing came .* within 0\.2 s"):
            made.advance(0.0, 0.01)
        assert time.monotonic() - begun < 5.0


def test_a_step_that_is_too_long_is_refused():
    with component() as made, pytest.raises(SimulationError, match=r"0\.05 s, at most 0\.02 s"):
        made.advance(0.0, 0.05)


@pytest.fixture
def build(tmp_path):
    """A folder as a build for SITL leaves it."""
    program = tmp_path / "build" / "bin" / "px4"
    program.parent.mkdir(parents=True)
    program.write_text("#!/bin/sh\necho no such airframe\nexit 1\n")
    program.chmod(0o755)
    start = tmp_path / "build" / "etc" / "init.d-posix" / "rcS"
    start.parent.mkdir(parents=True)
    start.touch()
    return program


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("link", "udpin:127.0.0.1:4560", "one tcpin:HOST:PORT is needed"),
        ("link", "tcpin:127.0.0.1:0 tcpin:127.0.0.1:0", "one tcpin:HOST:PORT is needed"),
        ("link", "tcpin:192.0.2.1:4560", "network"),
        ("actuators", "1 port 1900 1500 1100", "rising pulses"),
        ("date", "noon", "a day like '2026-02-05' is needed"),
        ("program", "/nowhere/px4", "there is no file /nowhere/px4"),
        ("program", "/etc/passwd", "is not executable"),
        ("program", "/bin/sh", "is of no build of PX4 for SITL: there is no file /.*etc/init"),
        ("defaults", "/nowhere/boat.px4", "parameter file /nowhere/boat.px4: No such file"),
    ],
)
def test_what_cannot_be_is_refused_at_the_start(name, value, said):
    with pytest.raises(InputError, match=said), component(**{name: value}):
        pass


def test_a_program_connects_to_its_instances_port_only(build):
    said = "link: a program connects to a port from 4560 to 4814, not to 4559"
    link = {"link": "tcpin:127.0.0.1:4559"}
    with pytest.raises(InputError, match=said), component(program=str(build), **link):
        pass


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("MAV_TYPE", "NAME VALUE is needed, not 'MAV_TYPE'"),
        ("MAV_TYPE boat", "NAME VALUE is needed"),
        ("mav_type 11", "NAME VALUE is needed"),
        ("MAV_TYPE 11 12", "NAME VALUE is needed"),
        ("NAV_ACC_RAD 3", "NAV_ACC_RAD is there twice"),
    ],
)
def test_a_parameter_file_is_checked_line_by_line(tmp_path, line, said):
    defaults = tmp_path / "boat.px4"
    defaults.write_text(f"NAV_ACC_RAD 2\n{line}\n")
    wanted = rf"boat\.px4, line 2: {said}"
    with pytest.raises(InputError, match=wanted), component(defaults=str(defaults)):
        pass
