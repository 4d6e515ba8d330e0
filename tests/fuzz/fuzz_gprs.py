"""Bytes on the line of a GPRS modem, and text on a base station's connection."""

from __future__ import annotations

import contextlib

from seatrial.errors import InputError
from seatrial.links.text import Outbox
from seatrial.model.component import Component
from seatrial_kits.gprs.at_commands import LONGEST, Line, read_line
from seatrial_kits.gprs.component import GprsModem
from seatrial_kits.gprs.segments import decode, encode
from seatrial_kits.gprs.sentences import decode as read_sentence
from seatrial_kits.gprs.sentences import encode as write_sentence


def one(data: bytes) -> None:
    """Read lines; say them to a modem that is awake; read segments and sentences."""
    memory: dict[str, object] = {}
    line = Line(memory)
    for byte in data:
        whole = line.take(byte)
        assert len(str(memory["line"])) <= LONGEST + 1
        for command in read_line(whole) or () if whole is not None else ():
            assert command.name
            assert command.form in ("execute", "read", "test", "write")
    _say(data)
    with contextlib.suppress(InputError):
        assert encode(decode(data)) == data
    sentence = read_sentence(data.decode("latin-1"))
    if sentence is not None:
        assert read_sentence(write_sentence(sentence).decode().strip()) == sentence


def _say(data: bytes) -> None:
    """Say it to a modem in a network, in two parts; whatever that was, it lives."""
    modem: Component = GprsModem("modem")
    for name in ("boot_time", "registration_time", "attach_time", "context_time"):
        modem.set(name, 0.001)
    modem.set("send_timeout", 0.5)
    modem.initialise()
    modem.begin()
    box = Outbox({})
    begun = b'ATE0\rAT+CSTT="a"\rAT+CIICR\rAT+CIFSR\r'
    for k, part in enumerate(
        (b"", begun, b"", b"", b"", data[: len(data) // 2], data[len(data) // 2 :], b"")
    ):
        if part:
            box.put(modem.now_ns, part)
            modem.set("rx", box.flush())
        modem.advance(0.1 * k, 0.1)
    assert modem.get("state")
    modem.get_state()
