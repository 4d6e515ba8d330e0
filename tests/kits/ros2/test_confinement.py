"""Sockets of a participant, as the kernel has them: nothing but the loopback interface."""

import json
import subprocess
import sys

import pytest

# Prints the sockets of a process that joins the domain by a transport, and the groups of DDS that
# it is in more than before.
SHOW = """
import json, os, socket, sys
from seatrial_kits.ros2.joining import join

def sockets():
    for name in os.listdir("/proc/self/fd"):
        try:
            opened = socket.socket(fileno=os.dup(int(name)))
        except OSError:
            continue
        with opened:
            if opened.family in (socket.AF_INET, socket.AF_INET6):
                device = opened.getsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, 16)
                yield opened.getsockname()[0], device.rstrip(bytes(1)).decode()

groups = open("/proc/net/igmp").read().count("0100FFEF")  # 239.255.0.1, the group of DDS
participant = join(int(sys.argv[1]), "/seatrial", sys.argv[2])
more = open("/proc/net/igmp").read().count("0100FFEF") - groups
print(json.dumps([list(sockets()), more]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="Linux binds sockets to a device")
def test_nothing_comes_in_but_over_the_loopback_interface(domain):
    done = subprocess.run(
        [sys.executable, "-c", SHOW, str(domain), "dds"], capture_output=True, text=True, check=True
    )
    opened, groups = json.loads(done.stdout)
    assert len(opened) > 1
    assert not groups
    for address, device in opened:
        assert address == "127.0.0.1" or device == "lo"
