"""A GPRS modem as a component: AT commands on one side, one TCP connection on the other."""

from __future__ import annotations

from typing import Any, ClassVar

from seatrial.links.text import Inbox, Outbox
from seatrial.model.component import NS

from .at_commands import Command, Line, read_line, result
from .connection import Connection
from .registration import ACTIVE, ERRORS, INITIAL, NO_SIM_PIN, Answer, RefusedError, Silent

_BUFFER = 2048
"""Characters that wait for it while it is busy; more are lost."""
_LINE_FEED, _RETURN = 0x0A, 0x0D
_KEPT_FOR_COMPATIBILITY = (
    *(
        "V",
        "Q",
        "X",
        "S",
        "&W",
        "&D",
        "&K",
        "H",
        "+IPR",
        "+IFC",
        "+ICF",
        "+CSCLK",
        "+CLTS",
        "+CMGF",
    ),
    *("+CGDCONT", "+CGACT", "+CDNSCFG", "+CIPSRIP", "+CIPSPRT", "+CNMI", "+CSCS", "+CLIP"),
)
"""Commands that are answered with OK and change nothing here."""
_TEXTS = {
    **dict.fromkeys(("I", "+CGMM", "+GMM"), "SIMCOM_SIM900"),
    **dict.fromkeys(("+CGMI", "+GMI"), "SIMCOM_Ltd"),
    **dict.fromkeys(("+CGMR", "+GMR"), "Revision:1137B00SIM900_SEATRIAL"),
    **dict.fromkeys(("+CGSN", "+GSN"), "000000000000000"),
    **dict.fromkeys(("+CCID", "+ICCID"), "00000000000000000000"),
    "+CIMI": "000000000000000",
}
_BEFORE_PIN = ("+CPIN", "+CFUN", "+CMEE", "+CREG", "+CPOWD", "+CSQ", "+CBC", *_TEXTS)
"""Extended commands that a locked SIM card does not hinder."""


class GprsModem(Connection):
    """A modem of the kind that GSM/GPRS shields have (SIMCom SIM900), in simulated time.

    **Serial side.** ``rx`` are bytes of the board, ``tx`` those to it. It takes one line after the
    other: a line is answered ``response_time`` after it, and what comes meanwhile waits. Echo,
    results, states and errors are those of SIMCom's AT command set V1.07: registration (CPIN, CREG,
    CGREG, CSQ, COPS, CGATT, CFUN, CPOWD), context (CSTT, CIICR, CIFSR, CIPSHUT), TCP (CIPSTART,
    CIPSEND with a length or until Ctrl-Z, CIPCLOSE, CIPSTATUS) with the options CIPMUX, CIPQSEND,
    CIPHEAD, CIPRXGET, CMEE. One connection at a time, with CIPMUX=1 too.

    **Network.** Times from power: ``boot_time``, then, where ``signal_quality`` is at least 1,
    ``registration_time``, ``attach_time``. A segment of n bytes takes

        8 (n + 40) / rate + latency

    on its way, one after the other (``uplink_rate``, ``downlink_rate``). SEND OK follows the
    acknowledgement of the base station. Without a network it is not registered at once and nothing
    passes; what was sent waits. After ``drop_time`` the context is gone (+PDP: DEACT); a send that
    is not acknowledged for ``send_timeout`` fails, and with it the connection (SEND FAIL, CLOSED).
    So a loss of the network is a fault ``fixed`` of ``signal_quality`` at 0.

    **Supply.** Below ``supply_min`` it is off, and begins anew when that returns. ``current`` is
    ``idle_current``, or ``sending_current`` in steps in which it sends or searches.

    Not modelled: voice, SMS, UDP, transparent mode (CIPMODE=1), DNS (every name resolves), several
    connections, the baud rate (the board's line has it), loss within the network (give the streams
    a fault), cells.

    Defaults, all assumed: SIMCom's current figures of the SIM900, GPRS of class 10 in a fair cell.
    """

    feedthrough: ClassVar = {}
    discrete = True
    exercised: ClassVar = {"boot_time": 0.1, "registration_time": 0.1, "attach_time": 0.1}

    def start(self, t: float) -> None:
        """Begin without a word; with a supply it boots."""
        self._rx: dict[str, Any] = {}
        self._tx: dict[str, Any] = {}
        self._from_base: dict[str, Any] = {}
        self._to_base: dict[str, Any] = {}
        self._powered = False
        self._begin()
        self._power_on()

    def step(self, t: float, h: float) -> None:
        """Take in bytes and segments, and let happen what is due until ``t + h``."""
        self._clock, end_ns = self.now_ns, self.now_ns + round(h * NS)
        incoming = Inbox(self._rx).take(self.rx)
        chunks = Inbox(self._from_base).take(self.downlink)
        if self.supply < self.supply_min:
            self._powered = False
            self._flush()
            return
        if not self._powered:
            self._powered = True
            self._power_on()
        self._follow_network()
        for time_ns, data in chunks:
            self._receive_chunk(time_ns, data)
        text = b"".join(data for _, data in incoming).decode("latin-1")
        if self._awake:
            self._waiting = (self._waiting + text)[:_BUFFER]
        self._work()
        self._use_air(end_ns)
        while self._agenda and self._agenda[0][0] <= end_ns:
            time_ns, _, name, data = self._agenda.pop(0)
            self._clock = max(self._clock, time_ns)
            self._happen(name, data)
            self._work()
            self._use_air(end_ns)
        self._flush()

    def outputs(self, t: float) -> None:
        """Publish bytes, segments and what is known of the network."""
        self.tx, self.uplink = Outbox(self._tx).text, Outbox(self._to_base).text
        on = self._powered
        self.registered, self.attached = on and self._registered, on and self._attached
        self.linked = on and self._ip_state == "CONNECT OK"
        self.state = self._ip_state if on else "OFF"
        self.bytes_up, self.bytes_down = self._delivered, self._arrived
        drawn = self.sending_current if self._on_air else self.idle_current
        self.current = drawn if on else 0.0

    # ------------------------------------------------------------------ inside

    def _flush(self) -> None:
        box, self._spoken, spoken = Outbox(self._tx), [], self._spoken
        for time_ns, text in spoken:
            box.put(time_ns, text.encode("latin-1"))
        box.flush()
        Outbox(self._to_base).flush()

    def _happen(self, name: str, data: str) -> None:
        """Let something happen that is due."""
        match name:
            case "boot":
                self._boot()
                self._follow_network()
            case "register":
                self._register()
            case "attach":
                self._attached = True
                if data:
                    self._finish([])
            case "context":
                self._ip_state = ACTIVE
                self._finish([])
            case "drop":
                self._deactivate()
            case "connect":
                self._open()
            case "no connection":
                self._connect_failed()
            case "answer":
                self._busy = False
                self._say(bytes.fromhex(data))
            case "say":
                self._unsolicited(data)
            case "sent":
                self._busy = False
                self._unsolicited(data)
            case "send failed":
                self._send_failed()
            case "up":
                Outbox(self._to_base).put(self._clock, bytes.fromhex(data))
            case "down":
                if self._registered and not self._held:
                    self._arrive(bytes.fromhex(data))
                else:
                    self._held.append(data)
            case "restart":
                self._power_on()
            case "off":
                self._unsolicited("NORMAL POWER DOWN")
                self._power_on()
                self._agenda = []

    def _work(self) -> None:
        """Take in what the board has sent, as far as it may be taken in now."""
        line, place = Line(self._line), 0
        text, self._waiting = self._waiting, ""
        while place < len(text) and not self._busy:
            byte = ord(text[place])
            place += 1
            ended, self._line_ended = self._line_ended, False
            if ended and byte == _LINE_FEED:  # of the line before, not the first byte of data
                continue
            if self._prompted != -1:
                self._take_data(byte)
                continue
            if self._echo:
                self._say(bytes([byte]))
            whole = line.take(byte)
            self._line_ended = byte == _RETURN
            if whole is not None:
                self._obey(whole)
        self._waiting = text[place:] + self._waiting
        self._pass_on()

    def _obey(self, line: str) -> None:
        """Begin to answer a line. What is no command is not answered, as by the modem."""
        if not line.strip().upper().startswith("AT"):
            return
        commands = read_line(line)
        self._busy, self._said = True, ""
        if commands is None:
            self._answer(self._error(0))
            return
        self._rest = [list(command) for command in commands]
        self._finish([])

    def _finish(self, lines: list[str]) -> None:
        """Go on with the commands of a line: after one that has taken its time, or at the first."""
        final = True
        while True:
            self._said += "".join(f"\r\n{text}\r\n" for text in lines)
            if not self._rest:
                break
            name, form, fields = self._rest.pop(0)
            try:
                answer = self._execute(Command(name, form, tuple(fields)))
            except RefusedError as refused:
                self._rest = []
                self._answer(self._said.encode("latin-1") + self._error(refused.code))
                return
            if answer is None:
                return
            lines, final = answer, not isinstance(answer, Silent)
        said = self._said.encode("latin-1")
        if self._prompted != -1:
            said += b"\r\n> "
        self._answer(said + (result("OK") if final else b""))

    def _answer(self, data: bytes) -> None:
        self._after(self.response_time, "answer", data.hex())

    def _error(self, code: int) -> bytes:
        if not code or not self._verbose_errors:
            return result("ERROR")
        return result(f"+CME ERROR: {code if self._verbose_errors == 1 else ERRORS[code]}")

    def _execute(self, command: Command) -> Answer:
        """Return the lines of an answer. Raises RefusedError."""
        name = command.name
        locked = not self._unlocked and name.startswith("+") and name not in _BEFORE_PIN
        if locked and command.form != "test":
            raise RefusedError(NO_SIM_PIN)
        handler = {**self._NETWORK, **self._TCP, **self._OPTIONS}.get(name)
        try:
            if handler:
                found: Answer = getattr(self, handler)(command)
                return found
        except ValueError:
            raise RefusedError(0) from None
        if name in _TEXTS:
            return [_TEXTS[name]]
        if name in _KEPT_FOR_COMPATIBILITY:
            return []
        raise RefusedError(0)

    # ------------------------------------------------------------------ options

    def _echo_command(self, command: Command) -> Answer:
        self._echo = bool(command.number(0, 0))
        return []

    def _factory(self, command: Command) -> Answer:
        self._echo, self._verbose_errors, self._creg = True, 0, 0
        return []

    def _errors_command(self, command: Command) -> Answer:
        if command.form == "read":
            return [f"+CMEE: {self._verbose_errors}"]
        if command.form == "test":
            return ["+CMEE: (0-2)"]
        value = command.number(0)
        if value > 2:
            raise RefusedError(0)
        self._verbose_errors = value
        return []

    def _flag(self, command: Command, attribute: str) -> Answer:
        """Obey one of the options that are 0 or 1."""
        if command.form == "read":
            return [f"{command.name}: {int(getattr(self, attribute))}"]
        if command.form == "test":
            return [f"{command.name}: (0,1)"]
        if command.number(0) > 1:
            raise RefusedError(0)
        setattr(self, attribute, bool(command.number(0)))
        return []

    def _several(self, command: Command) -> Answer:
        if command.form == "write" and self._ip_state != INITIAL:
            raise RefusedError(0)
        return self._flag(command, "_multiple")

    def _quick_command(self, command: Command) -> Answer:
        return self._flag(command, "_quick")

    def _head_command(self, command: Command) -> Answer:
        return self._flag(command, "_head")

    def _mode_command(self, command: Command) -> Answer:
        if command.form == "read":
            return ["+CIPMODE: 0"]
        if command.form == "write" and command.number(0):
            raise RefusedError(0)
        return []

    def _battery_command(self, command: Command) -> Answer:
        return [f"+CBC: 0,100,{round(1e3 * min(self.supply, 4.2))}"]

    def _power_down(self, command: Command) -> Answer:
        self._after(self.response_time, "off")
        return Silent()

    def _bearer(self, command: Command) -> Answer:
        """Answer for the bearer of the IP applications, which is kept for compatibility."""
        if command.form == "write" and command.number(0) == 2:
            active = self._attached
            return [f'+SAPBR: 1,{1 if active else 3},"{self.address if active else "0.0.0.0"}"']
        return []

    _OPTIONS: ClassVar = {
        "E": "_echo_command",
        "Z": "_factory",
        "&F": "_factory",
        "+CMEE": "_errors_command",
        "+CIPMUX": "_several",
        "+CIPQSEND": "_quick_command",
        "+CIPHEAD": "_head_command",
        "+CIPMODE": "_mode_command",
        "+CBC": "_battery_command",
        "+CPOWD": "_power_down",
        "+SAPBR": "_bearer",
    }
