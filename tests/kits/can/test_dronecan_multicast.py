"""The multicast gateway, with many senders on the loopback interface."""

import os
import socket
from contextlib import ExitStack

import pytest

from seatrial_kits.can.frame import Frame
from seatrial_kits.can.gateways.dronecan_multicast import (
    GROUP,
    LOOPBACK,
    MOST_SENDERS,
    PORT,
    DroneCanMulticastGateway,
    packed,
)


@pytest.fixture
def bus():
    """A bus, and its gateway: of this process, others may test beside it."""
    number = os.getpid() % 256
    try:
        gateway = DroneCanMulticastGateway(number)
    except OSError as error:
        pytest.skip(f"no multicast here: {error}")
    yield GROUP.format(number), gateway
    gateway.close()


def sent(group, identifier, opened=None):
    """Send a frame from a socket, a new one if none is given; return that."""
    if opened is None:
        opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        interface = socket.inet_aton(LOOPBACK)
        opened.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        opened.bind((LOOPBACK, 0))
    opened.sendto(packed(Frame(identifier, b"", True)), (group, PORT))
    return opened


def test_senders_are_bounded_and_numbers_are_never_used_again(bus):
    group, gateway = bus
    numbers = []
    with ExitStack() as all_open:  # a port that was closed may be given again
        faithful = all_open.enter_context(sent(group, 0))
        ((first, _),) = gateway.poll()
        for identifier in range(1, 2 * MOST_SENDERS):
            all_open.enter_context(sent(group, identifier))
            ((number, frame),) = gateway.poll()
            assert frame.identifier == identifier
            numbers.append(number)
            if identifier % 50 == 0:  # it is not the one silent longest
                sent(group, 0, faithful)
                assert [each for each, _ in gateway.poll()] == [first]
    assert len({first, *numbers}) == 2 * MOST_SENDERS
    assert gateway.clients == MOST_SENDERS
