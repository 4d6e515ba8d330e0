"""Devices and other hosts: nothing reaches one unless it is allowed, whatever opens it."""

import ast
import os
import pty
import shutil
import signal
import socket
import subprocess
import sys
from pathlib import Path

import can
import pytest

import seatrial
from seatrial.errors import InputError
from seatrial.fmi.components.index import component_class, shipped_names
from seatrial.kits import OURS
from seatrial.links.endpoints.url import TRANSPORTS, open_endpoint
from seatrial.links.hardware import (
    ALLOWED,
    NETWORK_ALLOWED,
    check_can_bus,
    check_host,
    confined,
    is_this_machine,
    is_virtual_can,
)
from seatrial.links.own_terminals import is_own
from seatrial.model.component import Reachable
from tests.command import SEATRIAL

RIG = """\
step = "10 ms"
[components]
gateway = { fmu = "serial-gateway", set = { links = "LINK", safe_state = "" } }
"""
DEVICE, NETWORK = r"--hardware \(or SEATRIAL_HARDWARE=1", r"--network \(or SEATRIAL_NETWORK=1"


@pytest.fixture(autouse=True)
def _nothing_allowed(monkeypatch):
    for variable in (ALLOWED, NETWORK_ALLOWED):
        monkeypatch.delenv(variable, raising=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("link", "flags", "expected"),
    [
        ("serial:/dev/null:57600", [], "gateway: links: link 'serial:/dev/null:57600' reaches "
         "the device /dev/null; allow it with --hardware"),
        ("serial:/dev/null:57600", ["--network"], "allow it with --hardware"),
        ("serial:/dev/null:57600", ["--hardware"], "cannot open the link"),
        ("tcpin:192.0.2.1:5760", ["--hardware"], "gateway: links: link 'tcpin:192.0.2.1:5760' "
         "listens at 192.0.2.1, where other hosts reach it; allow it with --network"),
        ("tcpin:192.0.2.1:5760", ["--network"], "cannot open the link"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("isolated", ["false", pytest.param("true", marks=pytest.mark.interop)])
def test_the_command_line_opens_what_is_allowed(link, flags, expected, isolated, write, tmp_path):
    text = RIG.replace("set =", f"isolated = {isolated}, set =").replace("LINK", link)
    write("rig.toml", text)
    trial = write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
    run = subprocess.run(
        [SEATRIAL, "run", str(trial), "--engine", "direct", *flags],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert run.returncode == 2
    assert expected in " ".join(run.stderr.split())
    assert not (tmp_path / "runs").exists()


# ---------------------------------------------------------------------- every kind of link

ENDPOINTS = {
    "udpout": ("udpout:192.0.2.1:14550", rf"reaches the host 192\.0\.2\.1.*{NETWORK}"),
    "udpin": ("udpin:0.0.0.0:14550", rf"listens at 0\.0\.0\.0.*{NETWORK}"),
    "tcpin": ("tcpin:192.0.2.1:5760", rf"listens at 192\.0\.2\.1.*{NETWORK}"),
    "tcpout": ("tcpout:192.0.2.1:5760", rf"reaches the host 192\.0\.2\.1.*{NETWORK}"),
    "serial": ("serial:/dev/null:9600", rf"reaches the device /dev/null.*{DEVICE}"),
    "pty": None,  # a terminal of its own
}


def test_every_kind_of_link_is_here():
    """A kind that is new must say here what it reaches."""
    assert set(ENDPOINTS) == set(TRANSPORTS.shipped)


@pytest.mark.parametrize(("url", "refusal"), [*filter(None, ENDPOINTS.values())])
def test_every_endpoint_beyond_this_machine_is_refused(url, refusal):
    with pytest.raises(InputError, match=rf"^link '{url}' {refusal}") as caught:
        open_endpoint(url)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("interface", sorted({*can.VALID_INTERFACES, "unknown"} - {"virtual"}))
def test_every_bus_of_python_can_but_the_virtual_one_is_refused(interface):
    with pytest.raises(InputError, match="allow it with --"):
        check_can_bus("gateway 'x'", interface, "can0")


COMPONENTS = {
    "mavlink": {"links": "tcpout:192.0.2.1:5760"},
    "nmea0183": {"links": "udpout:192.0.2.1:10110"},
    "serial-gateway": {"links": "tcpin:0.0.0.0:0"},
    "can-gateway": {"link": "yd-raw-udp:192.0.2.1:2002"},
    "ardupilot": {"link": "udpin:0.0.0.0:0"},
    "px4": {"link": "tcpin:0.0.0.0:0"},
    "arduino": {"monitors": "0=tcpin:0.0.0.0:0"},
}
"""Of the core and of the kits, which may lack."""
ON_A_BOARD = {"backend": "board", "links": "0=tcpout:192.0.2.1:1", "safe_state": ""}
ON_THE_AIR = {"mcu": "esp32", "network": "192.0.2.1"}
HERE = [
    (name, given)
    for name, given in [*COMPONENTS.items(), ("arduino", ON_A_BOARD), ("arduino", ON_THE_AIR)]
    if name in shipped_names()
]


def test_every_component_that_opens_something_is_here():
    found = {n for n in shipped_names() if issubclass(component_class(n), Reachable)}
    # DDS has no address of its own: tests/kits/ros2/test_confinement.py looks at its sockets.
    assert found - {"ros2"} == {name for name, _ in HERE}


@pytest.mark.parametrize(("name", "given"), HERE)
def test_every_component_says_which_key_it_is(name, given):
    made, key = component_class(name)("it"), next(k for k in given if k not in ("backend", "mcu"))
    for parameter, value in given.items():
        made.set(parameter, value)
    with pytest.raises(InputError, match=rf"^it: {key}: .*{NETWORK}"):
        made.initialise()


@pytest.mark.slow
def test_nothing_else_opens_sockets_or_ports():
    """Modules that could: one that is new must ask `hardware`, and be in a test above."""
    folder = Path(seatrial.__file__).parents[1]
    opening = {"socket", "serial", "can", "asyncio", "http", "urllib", "ssl", "socketserver", "pty"}
    found = set()
    for path in [p for top in OURS for p in (folder / top).rglob("*.py")]:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = [str(node.module)]
            if isinstance(node, ast.Attribute) and node.attr == "openpty":
                names = ["pty"]
            if {n.partition(".")[0] for n in names if n != "urllib.parse"} & opening:
                found.add(path.relative_to(folder).as_posix())
    between_processes = {  # sockets that no program outside can reach
        "seatrial/links/own_terminals.py",
        "seatrial/links/safe_state.py",
        "seatrial/trial/running/forked.py",
        "seatrial/trial/running/keeper.py",
        "seatrial/trial/running/link.py",
    }
    files = {"seatrial_kits/can/recorded.py"}  # python-can reads a log, no bus
    opened_before = {"seatrial/links/safe_state_keeper.py", "seatrial_kits/can/safe_state.py"}
    bound = {"seatrial_kits/ros2/confinement.py"}  # those of DDS, to the loopback device
    of_tests = {"seatrial_kits/mavlink/testing.py"}  # the other end, on the loopback only
    # On the loopback, with a token: tests/kits/live/test_server.py. The stage only wakes its loop.
    pages = {
        "seatrial_kits/live/server.py",
        "seatrial_kits/live/stage.py",
        "seatrial_kits/live/gate.py",
    }
    asking = {
        "seatrial/links/hardware.py",
        "seatrial/links/endpoints/pseudo_terminal.py",
        "seatrial/links/endpoints/descriptor.py",
        "seatrial/links/endpoints/tcp.py",
        "seatrial/links/endpoints/udp.py",
        "seatrial_kits/can/gateways/dronecan_multicast.py",
        "seatrial_kits/can/gateways/python_can.py",
        "seatrial_kits/can/run_log.py",
        "seatrial_kits/can/messages.py",
        "seatrial_kits/arduino/attached/network.py",
        "seatrial_kits/arduino/attached/tcp.py",  # at the addresses that network.py asked for
    }
    lacking = {path for path in asking if not (folder / path).parent.is_dir()}  # a kit's
    assert found - between_processes - files - opened_before - bound - of_tests - pages == (
        asking - lacking
    )


# ---------------------------------------------------------------------- the questions


@pytest.mark.parametrize(
    ("address", "here"),
    [
        ("127.0.0.1", True), ("127.8.9.10", True), ("::1", True),
        ("0.0.0.0", False), ("::", False), ("192.168.1.2", False), ("10.0.0.1", False),
        ("239.65.82.0", False), ("255.255.255.255", False), ("fe80::1", False),
    ],
)  # fmt: skip
def test_loopback_is_this_machine(address, here):
    assert is_this_machine(address) is here


def test_a_name_is_resolved_first():
    endpoint = open_endpoint("udpin:localhost:0")
    endpoint.close()
    assert endpoint.url.startswith("udpin:127.0.0.1:")


def test_other_hosts_are_allowed_by_their_own_variable(monkeypatch):
    monkeypatch.setenv(ALLOWED, "1")
    with pytest.raises(InputError, match=NETWORK):
        check_host("x", "192.0.2.1")
    monkeypatch.setenv(NETWORK_ALLOWED, "1")
    check_host("x", "192.0.2.1")
    with confined(), pytest.raises(InputError, match="run it with seatrial run --network"):
        check_host("x", "192.0.2.1")
    check_host("x", "192.0.2.1")


def test_the_name_of_a_can_interface_proves_nothing():
    """In a network of its own: an Ethernet device called vcan0, and a vcan if the kernel has it."""
    if shutil.which("unshare") is None or shutil.which("ip") is None:
        pytest.skip("needs unshare and ip")
    asked = "import seatrial.links.hardware as h; print(h.is_virtual_can('vcan0'), h.is_virtual_can('x'))"
    script = (
        "ip link add vcan0 type veth && { ip link add x type vcan 2>/dev/null && echo has; "
        f'{sys.executable} -c "{asked}"; }}'
    )
    run = subprocess.run(["unshare", "-rn", "sh", "-c", script], capture_output=True, text=True)
    if not run.stdout:
        pytest.skip(f"no network of its own: {run.stderr}")
    assert run.stdout.split() in (["has", "False", "True"], ["False", "False"])
    assert not is_virtual_can("lo")


def test_a_terminal_of_another_program_is_a_device():
    """A bridge to a real board would be one too."""
    ours, theirs = pty.openpty()
    device = os.ttyname(theirs)
    try:
        refusal = rf"{device}, a terminal that no run of seatrial has opened.*{DEVICE}"
        with pytest.raises(InputError, match=refusal):
            open_endpoint(f"serial:{device}:9600")
    finally:
        os.close(ours)
        os.close(theirs)


def test_a_terminal_of_a_run_is_none_also_from_another_process(tmp_path):
    place = tmp_path / "port"
    code = f"""
import sys
from seatrial.links.endpoints.url import open_endpoint
endpoint = open_endpoint("pty:{place}")
print("open", flush=True)
sys.stdin.read()
"""
    run = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    try:
        assert run.stdout.readline() == b"open\n"
        assert is_own(str(place))
        open_endpoint(f"serial:{place}:9600").close()
    finally:
        run.send_signal(signal.SIGKILL)
        run.communicate()
    assert not is_own(str(place))


def test_a_claim_ends_with_its_terminal():
    endpoint = open_endpoint("pty")
    device = endpoint.url
    assert is_own(device)
    endpoint.close()
    assert not is_own(device)


def test_what_a_link_leads_to_counts(tmp_path):
    endpoint = open_endpoint("pty")
    link, other = tmp_path / "port", tmp_path / "other"
    link.symlink_to(endpoint.url)
    other.symlink_to("/dev/ttyS0")
    assert is_own(str(link))
    assert not is_own(str(other))
    endpoint.close()


def test_an_allowed_host_is_reached(monkeypatch):
    monkeypatch.setenv(NETWORK_ALLOWED, "1")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
        except OSError:
            pytest.skip("no route to anywhere")
    open_endpoint("udpout:192.0.2.1:9").close()  # a socket that is connected sends nothing yet
