"""Link kinds: how a rig has one, who is at its other end, what garbage is to it, how it stops."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import all as mavlink

from .peers import Caller, Firmware, Guest, Peer, Receiver, Sender, Server, Terminal

NO_CONNECTION = "datagrams have no connection that could be lost"
COME_AND_GO = "programs come and go: that one has left is no loss of the link"
NO_PORT = "the link takes nothing that another program could have"
RAW = "bytes are passed on as they are: none of them is garbage to the link"
ALONE = "python-can's virtual bus ends at this process: nobody is at its other end"
NAMESPACE = "multicast needs a network namespace of its own: tests/kits/can has the gateway in one"
NODES = "nodes of ROS 2 are its other ends: tests/kits/ros2 has those that go and send nonsense"

NOISE = b"\xff\xfe\x00garbage\r\n>\r<\x80\r\n" * 3
LINES = b"t12\rT0000zzzz8\rt1239\r\xff\xfe\rr\r" + NOISE
SAFE = "FAAF0100000F5B0000000000000000000000FFFFFFFF00"
FRAME = "18FF0001#00"


@dataclass(frozen=True)
class Kind:
    """One kind. ``set`` are the component's parameters, with the peer's ``{port}`` and so on."""

    component: str
    peer: type[Peer]
    set: str
    hello: bytes = b""
    garbage: bytes = NOISE
    counter: str = ""
    """Output that counts what was garbage."""
    neutral: Callable[[bytes], bool] | None = None
    """Says whether what was received ends with what stops something; None for what moves nothing."""
    excuses: dict[str, str] = field(default_factory=dict)
    """Why events, or all (``*``), do not apply."""

    @staticmethod
    def of(name: str) -> Kind | None:
        """Return a kind by its name, None if nobody has said how it is played."""
        return _KINDS.get(name)


def _serial(peer: type[Peer], url: str, **excuses: str) -> Kind:
    text = f'links = "{url}", safe_state = "{SAFE}"'
    never = {key.replace("_", " "): why for key, why in excuses.items()}
    stops = bytes.fromhex(SAFE)
    return Kind(
        "serial-gateway", peer, text, b"?",
        neutral=lambda received: received.endswith(stops), excuses={"garbage": RAW, **never},
    )  # fmt: skip


def _can(peer: type[Peer], url: str, hello: bytes, neutral: bytes, **excuses: str) -> Kind:
    text = f'link = "{url}", safe_state = "{FRAME}"'
    never = {key.replace("_", " "): why for key, why in excuses.items()}
    return Kind(
        "can-gateway", peer, text, hello, LINES, "frames_refused",
        (lambda received: neutral in received[-200:]) if neutral else None, never,
    )  # fmt: skip


def _disarmed(received: bytes) -> bool:
    """Say if the last frame of a MAVLink vehicle is a HEARTBEAT that says disarmed."""
    messages = mavlink.MAVLink(None).parse_buffer(received) or [None]
    last = messages[-1]
    return isinstance(last, mavlink.MAVLink_heartbeat_message) and not (
        last.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    )


_SLCAN, _RAW_MODE = b"O\r", b"< open can0 >< rawmode >"
_KINDS = {
    "serial-gateway udpout": _serial(
        Receiver, "udpout:127.0.0.1:{port}", unplug=NO_CONNECTION, port_taken=NO_PORT
    ),
    "serial-gateway udpin": _serial(Sender, "udpin:127.0.0.1:{port}", unplug=NO_CONNECTION),
    "serial-gateway tcpin": _serial(Caller, "tcpin:127.0.0.1:{port}", unplug=COME_AND_GO),
    "serial-gateway tcpout": _serial(Server, "tcpout:127.0.0.1:{port}", port_taken=NO_PORT),
    "serial-gateway serial": _serial(Terminal, "serial:{device}:115200"),
    "serial-gateway pty": _serial(Guest, "pty:{path}", unplug=COME_AND_GO),
    "can-gateway socketcand": _can(
        Caller, "socketcand:127.0.0.1:{port}", _RAW_MODE, b"< frame 18FF0001 ", unplug=COME_AND_GO
    ),
    "can-gateway slcan-tcp": _can(
        Caller, "slcan-tcp:127.0.0.1:{port}", _SLCAN, b"T18FF0001100\r", unplug=COME_AND_GO
    ),
    "can-gateway slcan-pty": _can(
        Guest, "slcan-pty", _SLCAN, b"T18FF0001100\r", unplug=COME_AND_GO, port_taken=NO_PORT
    ),
    "can-gateway yd-raw-tcp": _can(
        Caller, "yd-raw-tcp:127.0.0.1:{port}", b"", b"18FF0001 00\r\n", unplug=COME_AND_GO
    ),
    "can-gateway yd-raw-udp": _can(
        Receiver,
        "yd-raw-udp:127.0.0.1:{port}",
        b"",
        b"18FF0001 00\r\n",
        unplug=NO_CONNECTION,
        port_taken=NO_PORT,
    ),
    "can-gateway dronecan-multicast": _can(
        Peer, "dronecan-multicast:7", b"", b"", **{"*": NAMESPACE}
    ),
    "can-gateway virtual": _can(
        Peer,
        "virtual:matrix",
        b"",
        b"",
        garbage=ALONE,
        unplug=ALONE,
        port_taken=NO_PORT,
    ),
    "can-gateway python-can": _can(
        Terminal, "python-can:slcan:{device}:250000", b"", b"T18FF0001100\r", port_taken=NO_PORT
    ),
    "ardupilot": Kind(
        "ardupilot",
        Firmware,
        'link = "udpin:127.0.0.1:{port}"',
        counter="frames_refused",
        excuses={"unplug": NO_CONNECTION},
    ),
    "arduino": Kind(
        "arduino",
        Caller,
        'sketch = "sketch", monitors = "0=tcpin:127.0.0.1:{port}"',
        excuses={"unplug": COME_AND_GO, "garbage": RAW},
    ),
    "ground-station": Kind(
        "ground-station",
        Sender,
        'link = "udpin:127.0.0.1:{port}"',
        b"?",
        counter="frames_refused",
        excuses={"unplug": NO_CONNECTION},
    ),
    "landing-target": Kind(
        "landing-target",
        Caller,
        'link = "tcpin:127.0.0.1:{port}"',
        counter="frames_refused",
        excuses={"unplug": COME_AND_GO},
    ),
    "mavlink": Kind(
        "mavlink",
        Caller,
        'links = "tcpin:127.0.0.1:{port}", armed_start = "on"',
        counter="frames_refused",
        neutral=_disarmed,
        excuses={"unplug": COME_AND_GO},
    ),
    "nmea0183": Kind(
        "nmea0183",
        Caller,
        'links = "tcpin:127.0.0.1:{port}"',
        counter="lines_refused",
        excuses={"unplug": COME_AND_GO},
    ),
    "px4": Kind(
        "px4",
        Caller,
        'link = "tcpin:127.0.0.1:{port}"',
        counter="frames_refused",
        excuses={"unplug": COME_AND_GO},
    ),
    "ros2": Kind("ros2", Peer, "", excuses={"*": NODES}),
    "vrx-task": Kind("vrx-task", Peer, "", excuses={"*": NODES}),
}
