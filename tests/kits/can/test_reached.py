"""Gateways to other hosts and to devices: nothing reaches one unless it is allowed."""

import pytest

from seatrial.errors import InputError
from seatrial.links.hardware import ALLOWED, NETWORK_ALLOWED
from seatrial_kits.can.gateways.url import FORMS, open_gateway

DEVICE, NETWORK = r"--hardware \(or SEATRIAL_HARDWARE=1", r"--network \(or SEATRIAL_NETWORK=1"
BUSES = {
    "socketcand": ("socketcand:0.0.0.0:0", rf"listens at 0\.0\.0\.0.*{NETWORK}"),
    "slcan-tcp": ("slcan-tcp:192.0.2.1:0", rf"listens at 192\.0\.2\.1.*{NETWORK}"),
    "slcan-pty": None,
    "yd-raw-tcp": ("yd-raw-tcp:0.0.0.0:0", rf"listens at 0\.0\.0\.0.*{NETWORK}"),
    "yd-raw-udp": ("yd-raw-udp:192.0.2.1:2002", rf"reaches the host 192\.0\.2\.1.*{NETWORK}"),
    "dronecan-multicast": None,  # on the loopback interface alone: TTL 0
    "virtual": None,  # within the process
    "python-can": ("python-can:socketcan:can0", rf"reaches the bus can0.*{DEVICE}"),
}


def test_every_kind_of_gateway_is_here():
    """A kind that is new must say here what it reaches."""
    assert set(BUSES) == set(FORMS)


@pytest.mark.parametrize(
    ("url", "refusal"),
    [
        *filter(None, BUSES.values()),
        ("python-can:slcan:socket://192.0.2.1:29537", rf"reaches the host 192\.0\.2\.1.*{NETWORK}"),
        ("python-can:slcan:/dev/ttyACM0:250000", rf"reaches the device /dev/ttyACM0.*{DEVICE}"),
        (
            "python-can:udp_multicast:239.0.0.1",
            rf"reaches the hosts of the group 239\.0\.0\.1.*{NETWORK}",
        ),
        ("python-can:socketcan:vcan0", rf"reaches the bus vcan0, .*not proven virtual.*{DEVICE}"),
    ],
)
def test_every_gateway_beyond_this_machine_is_refused(url, refusal, monkeypatch):
    for variable in (ALLOWED, NETWORK_ALLOWED):
        monkeypatch.delenv(variable, raising=False)
    with pytest.raises(InputError, match=rf"^gateway '{url}' {refusal}") as caught:
        open_gateway(url)
    assert "\n" not in str(caught.value)
