"""A driver at a modem, and a base station behind it, in simulated time."""

from seatrial.links.text import Inbox, Outbox
from seatrial_kits.gprs.base_station import BaseStation
from seatrial_kits.gprs.component import GprsModem
from tests.devices.running import started


class Dialogue:
    """Says lines to a modem and returns what it says back."""

    def __init__(self, step=0.02, base=None, **modem):
        self.step, self.steps = step, 0
        self.modem = started(GprsModem, **modem)
        self.base = started(BaseStation, **(base or {}))
        self._to, self._from = {}, {}

    @property
    def now(self):
        return self.steps * self.step

    def run(self, seconds):
        """Let time pass; return the bytes that the modem has said."""
        said = b""
        for _ in range(round(seconds / self.step)):
            self.modem.set("rx", Outbox(self._to).text)
            self.modem.set("downlink", self.base.get("tx"))
            self.base.set("rx", self.modem.get("uplink"))
            for each in (self.modem, self.base):
                each.advance(self.now, self.step)
            self.steps += 1
            for _, data in Inbox(self._from).take(self.modem.get("tx")):
                said += data
        return said

    def say(self, text, seconds=0.2):
        """Say a line, without its end; return what is said in that time."""
        return self.send(text.encode() + b"\r", seconds)

    def send(self, data, seconds=0.2):
        """Send bytes as they are."""
        box = Outbox(self._to)
        box.put(self.modem.now_ns, data)
        box.flush()
        return self.run(seconds)

    def until(self, text, most):
        """Return when something has been said, s from now; fails if it is not."""
        begin, said = self.now, b""
        while text not in said:
            assert self.now - begin < most, said
            said += self.run(self.step)
        return self.now - begin

    def connect(self, host="shore", port=5000):
        """Do what every driver does, to an established connection."""
        self.until(b"Call Ready", 60)
        self.run(5)
        self.say("ATE0")
        self.say('AT+CSTT="apn","",""')
        self.say("AT+CIICR", 5)
        self.say("AT+CIFSR")
        return self.say(f'AT+CIPSTART="TCP","{host}",{port}', 3)


def lines(said):
    """Return the lines of what was said, without the empty ones."""
    return [line for line in said.decode("latin-1").split("\r\n") if line.strip("\r")]
