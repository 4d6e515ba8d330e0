"""Lockstep: one answer per frame, whatever is repeated, lost or sent by others."""

import signal
import time

import pytest

from seatrial.links.endpoints.udp import UdpListener
from seatrial_kits.ardupilot.lockstep import SILENT_S, Lockstep

from .peer import Peer


class Clock:
    now = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def asked():
    """Signals that a program's own handler was given."""
    given = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: given.append(number))
    yield given
    signal.signal(signal.SIGTERM, before)


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def lockstep(clock):
    made = Lockstep(UdpListener(("127.0.0.1", 0)), clock)
    yield made
    made.close()


@pytest.fixture
def peer(lockstep):
    made = another(lockstep)
    yield made
    made.close()


def another(lockstep, **options):
    return Peer(int(lockstep.endpoint.url.rpartition(":")[2]), **options)


def waited():
    """Fail where nothing should be waited for twice."""
    waited.calls += 1
    assert waited.calls < 100


@pytest.fixture(autouse=True)
def _waits():
    waited.calls = 0


def served(lockstep):
    """Answer one frame, and return it."""
    frame = lockstep.wait_for_frame(waited)
    lockstep.answer(b"\n%d\n" % frame.count)
    return frame


@pytest.mark.parametrize("channels", [16, 32])
def test_both_magics_have_their_channels(lockstep, channels):
    peer = another(lockstep, channels=channels, rate=400)
    peer.send(*range(1001, 1001 + channels))
    frame = lockstep.wait_for_frame(waited)
    assert frame.pwm == tuple(range(1001, 1001 + channels))
    assert (frame.rate, frame.count) == (400, 0)
    peer.close()


def test_what_is_no_servo_packet_is_left_alone(lockstep, peer):
    for data in (b"", b"hello", bytes(40), (18458).to_bytes(2, "little") + bytes(39)):
        peer.socket.send(data)
    peer.send(1500)
    assert lockstep.wait_for_frame(waited).pwm[0] == 1500
    assert lockstep.repeated == 0


def test_a_wait_ends_when_a_frame_comes(lockstep, peer):
    def send():
        peer.send(1234)

    assert lockstep.wait_for_frame(send).pwm[0] == 1234


def test_what_is_repeated_before_the_answer_is_answered_once(lockstep, peer):
    for _ in range(5):
        peer.send(1500)
    served(lockstep)
    assert peer.receive().line == b"0"
    assert peer.receive(0.05) is None  # it would be taken for the answer to the next frame
    assert lockstep.repeated == 4


def test_a_lost_answer_is_sent_again_and_nothing_else_happens(lockstep, peer):
    peer.send(1500)
    served(lockstep)
    peer.receive()  # lost, says the peer
    peer.send(1500)
    sent = []

    def later():
        if not sent:
            sent.append(peer.receive())
            peer.count += 1
            peer.send(1600)

    assert lockstep.wait_for_frame(later).pwm[0] == 1600
    assert sent[0].line == b"0"
    assert (lockstep.repeated, lockstep.restarts, lockstep.lost) == (1, 0, 0)


def test_lost_frames_are_counted(lockstep, peer):
    for count in (0, 1, 4):
        peer.count = count
        peer.send()
        served(lockstep)
    assert lockstep.lost == 2


def test_a_number_that_goes_back_is_a_restart(lockstep, peer):
    for count in (5, 6, 0, 1):
        peer.count = count
        peer.send()
        served(lockstep)
    assert lockstep.restarts == 1


def test_a_restart_from_a_new_port_is_taken_at_once(lockstep, peer):
    peer.count = 50
    peer.send(1500)
    served(lockstep)
    again = another(lockstep)
    again.send(1600)
    assert served(lockstep).pwm[0] == 1600
    assert again.receive().line == b"0"
    assert lockstep.restarts == 1
    again.close()


def test_another_firmware_is_left_out_while_the_first_sends(lockstep, peer, clock):
    peer.count = 50
    peer.send(1500)
    served(lockstep)
    stranger = another(lockstep)
    stranger.count = 70
    stranger.send(1100)
    peer.count = 51
    peer.send(1510)
    while served(lockstep).count != 51:
        pass
    assert lockstep.refused == 1
    clock.now += 1.1 * SILENT_S
    stranger.send(1100)
    assert served(lockstep).pwm[0] == 1100
    stranger.close()


def test_the_run_begins_in_the_middle_of_a_firmware_s(lockstep, peer):
    peer.count = 12345
    peer.send(1500)
    assert served(lockstep).count == 12345
    assert lockstep.restarts == 0


@pytest.mark.parametrize("rate", [50, 400])
def test_no_frame_is_dropped_however_fast_they_come(lockstep, rate):
    peer = another(lockstep, channels=32, rate=rate)
    begun = time.monotonic()
    for count in range(2000):
        peer.count = count
        peer.send(1500)
        assert served(lockstep).count == count
        assert peer.receive().line == b"%d" % count
    assert time.monotonic() - begun < 20.0
    assert lockstep.endpoint.budget.exceeded == 0
    peer.close()


def test_a_request_to_end_before_the_wait_is_not_missed(asked, lockstep, peer):
    signal.raise_signal(signal.SIGTERM)
    assert lockstep.wait_for_frame(waited) is None
    assert asked == [signal.SIGTERM]


@pytest.mark.parametrize("first", [0, 1])
def test_two_that_wait_are_asked_both_and_leave_the_handler_as_it_was(asked, first):
    handler = signal.getsignal(signal.SIGTERM)
    both = [Lockstep(UdpListener(("127.0.0.1", 0))) for _ in range(2)]
    both.pop(first).close()
    signal.raise_signal(signal.SIGTERM)
    assert both[0].wait_for_frame(waited) is None
    both[0].close()
    assert asked == [signal.SIGTERM]
    assert signal.getsignal(signal.SIGTERM) is handler
