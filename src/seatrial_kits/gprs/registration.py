"""The modem in its network: power, SIM card, registration, attachment, and the air between."""

from __future__ import annotations

from typing import Any, ClassVar

from seatrial.model.component import NS

from . import segments
from .at_commands import Command, result
from .ports import BEST, GprsPorts

NOT_ALLOWED, NO_SIM_PIN, WRONG_PIN, NO_NETWORK = 3, 11, 16, 30
ERRORS = {
    NOT_ALLOWED: "operation not allowed",
    NO_SIM_PIN: "SIM PIN required",
    WRONG_PIN: "incorrect password",
    NO_NETWORK: "no network service",
}
"""Codes and texts of +CME ERROR that it gives: 3GPP TS 27.007, section 9.2."""

INITIAL, STARTED, CONFIGURING, ACTIVE = "IP INITIAL", "IP START", "IP CONFIG", "IP GPRSACT"
STATUS, CONNECTING, CONNECTED = "IP STATUS", "TCP CONNECTING", "CONNECT OK"
CLOSED, DEACTIVATED = "TCP CLOSED", "PDP DEACT"


class RefusedError(Exception):
    """A command that is answered with an error: its code of `ERRORS`, 0 for ERROR alone."""

    def __init__(self, code: int = 0) -> None:
        super().__init__(code)
        self.code = code


class Silent(list[str]):
    """Lines of an answer after which there is no OK."""


LATER = None
"""What a command returns whose answer comes when something has happened."""

Answer = list[str] | None


class Registration(GprsPorts):
    """Mix-in of `GprsModem`: what is due, power, registration, attachment, the queue to send."""

    def _begin(self) -> None:
        """Begin to count."""
        self._clock, self._number = self.now_ns, 0
        self._delivered = self._arrived = 0
        self._spoken: list[list[Any]] = []

    def _power_on(self) -> None:
        """Begin as after power: nothing said, nothing known, no network."""
        self._agenda: list[list[Any]] = []
        self._line: dict[str, Any] = {}
        self._waiting, self._said = "", ""
        self._rest: list[list[Any]] = []
        self._busy = self._awake = self._unlocked = self._on_air = self._line_ended = False
        self._echo, self._verbose_errors, self._creg, self._radio = True, 0, 0, True
        self._attached = self._wants_attach = self._registered = False
        self._covered_since = self._lost_since = -1
        self._air: list[str] = []
        self._air_free_ns = self._down_free_ns = self._clock
        self._held: list[str] = []
        self._ip_state, self._multiple, self._quick = INITIAL, False, False
        self._head, self._by_hand, self._prompted = False, False, -1
        self._connection, self._index, self._peer = 0, 0, ["", ""]
        self._outgoing = self._incoming = ""
        self._sent = self._acknowledged = 0
        self._after(self.boot_time, "boot")

    # ------------------------------------------------------------------ what is due

    def _after(self, seconds: float, name: str, data: str = "") -> None:
        """Have something happen after some time; what is due together comes in its order."""
        self._number += 1
        self._agenda.append([self._clock + round(seconds * NS), self._number, name, data])
        self._agenda.sort(key=lambda entry: (entry[0], entry[1]))

    def _forget(self, *names: str) -> None:
        self._agenda = [entry for entry in self._agenda if entry[2] not in names]

    def _say(self, data: bytes) -> None:
        text = data.decode("latin-1")
        if self._spoken and self._spoken[-1][0] == self._clock:
            self._spoken[-1][1] += text
        else:
            self._spoken.append([self._clock, text])

    def _unsolicited(self, text: str) -> None:
        self._say(result(text))

    # ------------------------------------------------------------------ network

    def _boot(self) -> None:
        self._awake = True
        self._unlocked = not self.pin
        for text in ("RDY", "+CFUN: 1", f"+CPIN: {'READY' if self._unlocked else 'SIM PIN'}"):
            self._unsolicited(text)

    def _follow_network(self) -> None:
        """Take in whether a network is in reach, at the beginning of a step."""
        covered = self._awake and self._unlocked and self._radio and self.signal_quality >= 1.0
        if covered and self._covered_since < 0:
            self._covered_since, self._lost_since = self._clock, -1
            self._forget("drop")
            self._after(self.registration_time, "register")
        elif not covered and self._covered_since >= 0:
            self._covered_since, self._lost_since = -1, self._clock
            self._forget("register", "attach")
            self._set_registered(False)
            self._attached = False
            self._after(self.drop_time, "drop")

    def _set_registered(self, registered: bool) -> None:
        if registered == self._registered:
            return
        self._registered = registered
        if self._creg:
            self._unsolicited(f"+CREG: {self._registration()}")

    def _registration(self) -> int:
        """Return <stat>: 0 not searching, 1 registered, 2 searching."""
        return 1 if self._registered else 2 if self._unlocked and self._radio else 0

    def _register(self) -> None:
        first = not self._wants_attach
        self._set_registered(True)
        if first:
            self._unsolicited("Call Ready")
            self._wants_attach = True
        self._after(self.attach_time, "attach")
        held, self._held = self._held, []
        for data in held:
            self._after(0.0, "down", data)

    # ------------------------------------------------------------------ the air

    def _transmit(self, segment: segments.Segment) -> None:
        """Queue a segment for the base station."""
        self._air.append(segments.encode(segment).hex())

    def _use_air(self, end_ns: int) -> None:
        """Send what is queued until ``end_ns``; it arrives after the latency."""
        begun = self._clock
        self._air_free_ns = max(self._air_free_ns, begun)
        used = 0
        while self._air and self._registered and self._air_free_ns < end_ns:
            size = len(self._air[0]) // 2 - 3 + segments.HEADERS
            taken = round(NS * 8.0 * size / self.uplink_rate)
            if not used:
                self._air_free_ns = max(self._air_free_ns, begun)
            self._air_free_ns += taken
            used += taken
            late = (self._air_free_ns - self._clock) / NS + self.latency
            self._after(late, "up", self._air.pop(0))
        searching = self._covered_since >= 0 and not self._registered
        self._on_air = used > 0 or searching or self._air_free_ns > end_ns

    def _receive_chunk(self, time_ns: int, data: bytes) -> None:
        """Have a chunk from the base station arrive when the network has brought it."""
        begin = max(time_ns, self._clock, self._down_free_ns)
        size = max(0, len(data) - 3) + segments.HEADERS
        self._down_free_ns = begin + round(NS * 8.0 * size / self.downlink_rate)
        late = (self._down_free_ns - self._clock) / NS + self.latency
        self._after(late, "down", data.hex())

    # ------------------------------------------------------------------ commands

    def _pin_command(self, command: Command) -> Answer:
        if command.form == "read":
            return [f"+CPIN: {'READY' if self._unlocked else 'SIM PIN'}"]
        if self._unlocked:
            raise RefusedError(NOT_ALLOWED)
        if command.fields[:1] != (self.pin,):
            raise RefusedError(WRONG_PIN)
        self._unlocked = True
        return []

    def _registration_command(self, command: Command) -> Answer:
        if command.form == "test":
            return ["+CREG: (0-1)"]
        if command.form == "read":
            return [f"+CREG: {self._creg},{self._registration()}"]
        value = command.number(0)
        if value > 1:
            raise RefusedError(NOT_ALLOWED)
        self._creg = value
        return []

    def _gprs_registration_command(self, command: Command) -> Answer:
        state = 1 if self._attached else self._registration() if not self._registered else 0
        return [f"+CGREG: 0,{state}"] if command.form == "read" else []

    def _quality_command(self, command: Command) -> Answer:
        quality = int(min(max(self.signal_quality, 0.0), BEST))
        return [f"+CSQ: {quality},0"]

    def _operator_command(self, command: Command) -> Answer:
        if command.form != "read":
            return []
        return ['+COPS: 0,0,"seatrial"' if self._registered else "+COPS: 0"]

    def _attach_command(self, command: Command) -> Answer:
        if command.form == "test":
            return ["+CGATT: (0,1)"]
        if command.form == "read":
            return [f"+CGATT: {int(self._attached)}"]
        if not self._registered:
            raise RefusedError(NO_NETWORK if self._unlocked else NO_SIM_PIN)
        if not command.number(0):
            self._forget("attach")
            self._attached = False
            self._close_connection(notify=True)
            self._ip_state = INITIAL
            return []
        if self._attached:
            return []
        self._forget("attach")
        self._after(self.attach_time, "attach", "asked")
        return LATER

    def _function_command(self, command: Command) -> Answer:
        if command.form == "read":
            return [f"+CFUN: {int(self._radio)}"]
        if command.form == "test":
            return ["+CFUN: (0,1,4),(0,1)"]
        if command.number(1, 0):
            self._after(self.response_time, "restart")
        else:
            self._radio = command.number(0) == 1
        return []

    _NETWORK: ClassVar = {
        "+CPIN": "_pin_command",
        "+CREG": "_registration_command",
        "+CGREG": "_gprs_registration_command",
        "+CSQ": "_quality_command",
        "+COPS": "_operator_command",
        "+CGATT": "_attach_command",
        "+CFUN": "_function_command",
    }

    def _close_connection(self, notify: bool) -> None:
        """End the connection; ``notify`` the base station of it or not."""
        raise NotImplementedError
