"""The modem's TCP connection and the AT commands for it: SIMCom's +CIP... set."""

from __future__ import annotations

from typing import ClassVar

from seatrial.errors import InputError

from . import segments
from .at_commands import Command, result
from .registration import (
    ACTIVE,
    CLOSED,
    CONFIGURING,
    CONNECTED,
    CONNECTING,
    DEACTIVATED,
    INITIAL,
    LATER,
    NOT_ALLOWED,
    STARTED,
    STATUS,
    Answer,
    RefusedError,
    Registration,
    Silent,
)

LARGEST = 1460
"""Bytes of one AT+CIPSEND."""
_INDICES = 8
_CTRL_Z, _ESCAPE = 0x1A, 0x1B


class Connection(Registration):
    """Mix-in of `GprsModem`: context, one TCP connection, data out and in."""

    def _prefix(self) -> str:
        """Return what stands before results of a connection where there may be several."""
        return f"{self._index}, " if self._multiple else ""

    # ------------------------------------------------------------------ context

    def _start_task(self, command: Command) -> Answer:
        if command.form == "write" and self._ip_state == INITIAL:
            self._ip_state = STARTED
            return []
        raise RefusedError(NOT_ALLOWED)

    def _bring_up(self, command: Command) -> Answer:
        if self._ip_state != STARTED or not self._attached:
            raise RefusedError(NOT_ALLOWED)
        self._ip_state = CONFIGURING
        self._after(self.context_time, "context")
        return LATER

    def _own_address(self, command: Command) -> Answer:
        if self._ip_state in (INITIAL, STARTED, CONFIGURING, DEACTIVATED):
            raise RefusedError(NOT_ALLOWED)
        if self._ip_state == ACTIVE:
            self._ip_state = STATUS
        return Silent([self.address])

    def _shut(self, command: Command) -> Answer:
        self._close_connection(notify=True)
        self._ip_state = INITIAL
        return Silent(["SHUT OK"])

    def _deactivate(self) -> None:
        """Lose the context, after too long without a network."""
        if self._ip_state not in (INITIAL, STARTED):
            self._close_connection(notify=False)
            self._ip_state = DEACTIVATED
            self._unsolicited("+PDP: DEACT")

    # ------------------------------------------------------------------ connection

    def _connect(self, command: Command) -> Answer:
        if command.form == "test":
            return []
        place = 1 if self._multiple else 0
        index = command.number(0) if self._multiple else 0
        if len(command.fields) < place + 3 or index >= _INDICES:
            raise RefusedError(NOT_ALLOWED)
        kind, host, port = command.fields[place : place + 3]
        if kind.upper() != "TCP" or not port.isdecimal() or not 0 < int(port) < 65536 or not host:
            raise RefusedError(NOT_ALLOWED)
        if self._ip_state in (CONNECTED, CONNECTING):
            text = f"{index}, ALREADY CONNECT" if self._multiple else "ALREADY CONNECT"
            self._after(2.0 * self.response_time, "say", text)
            raise RefusedError(0)
        direct = self._ip_state == INITIAL and not self._multiple and self._attached
        self._index, self._peer = index, [host, port]
        if not (direct or self._ip_state in (STATUS, CLOSED)) or not self._attached:
            text = (
                "CONNECT FAIL" if self._multiple else f"STATE: {self._ip_state}\r\n\r\nCONNECT FAIL"
            )
            self._after(2.0 * self.response_time, "say", self._prefix() + text)
            return []
        self._after(self.context_time if direct else self.response_time, "connect")
        self._ip_state = CONNECTING
        return []

    def _open(self) -> None:
        self._connection = (self._connection + 1) % 65536
        self._sent = self._acknowledged = 0
        peer = ":".join(self._peer).encode("latin-1", "replace")
        self._transmit(segments.Segment(segments.OPEN, self._connection, peer))
        self._after(self.connect_timeout, "no connection")

    def _connect_failed(self) -> None:
        self._forget("no connection")
        self._air = []
        self._ip_state = STATUS if self._multiple else CLOSED
        text = "CONNECT FAIL" if self._multiple else f"STATE: {CLOSED}\r\n\r\nCONNECT FAIL"
        self._unsolicited(self._prefix() + text)

    def _close_connection(self, notify: bool) -> None:
        if notify and self._ip_state == CONNECTED:
            self._transmit(segments.Segment(segments.CLOSE, self._connection))
        elif not notify:
            self._air = []
        if self._ip_state in (CONNECTED, CONNECTING):
            self._ip_state = CLOSED
        self._forget("no connection", "connect", "send failed")
        if self._prompted != -1 or self._outgoing:
            self._prompted, self._outgoing, self._busy = -1, "", False

    def _close(self, command: Command) -> Answer:
        if self._ip_state not in (CONNECTED, CONNECTING):
            raise RefusedError(NOT_ALLOWED)
        if self._multiple and command.number(0) != self._index:
            raise RefusedError(NOT_ALLOWED)
        self._close_connection(notify=True)
        return Silent([f"{self._prefix()}CLOSE OK"])

    def _status(self, command: Command) -> Answer:
        there = self._ip_state in (CONNECTED, CLOSED, CONNECTING) and self._peer[0]
        word = {CONNECTED: "CONNECTED", CONNECTING: "CONNECTING"}.get(self._ip_state, "CLOSED")

        def about(index: int) -> str:
            if there and index == self._index:
                return f'{index},0,"TCP","{self._peer[0]}","{self._peer[1]}","{word}"'
            return f'{index},,"","","","INITIAL"'

        if command.form == "write":
            index = command.number(0)
            if not self._multiple or index >= _INDICES:
                raise RefusedError(NOT_ALLOWED)
            return [f"+CIPSTATUS: {about(index)}"]
        if not self._multiple:
            return Silent(["OK", f"STATE: {self._ip_state}"])
        busy = self._ip_state in (CONNECTED, CONNECTING, CLOSED)
        lines = [f"C: {about(index)}" for index in range(_INDICES)]
        return Silent(["OK", f"STATE: {'IP PROCESSING' if busy else self._ip_state}", *lines])

    # ------------------------------------------------------------------ data out

    def _send(self, command: Command) -> Answer:
        if command.form == "read":
            return [f"+CIPSEND: {LARGEST}"]
        if command.form == "test":
            return [f"+CIPSEND: <{'n>,<' * self._multiple}length>"]
        place = 1 if self._multiple else 0
        if self._ip_state != CONNECTED or (place and command.number(0) != self._index):
            raise RefusedError(NOT_ALLOWED)
        length = command.number(place, 0)
        if length > LARGEST or (len(command.fields) > place and not length):
            raise RefusedError(NOT_ALLOWED)
        self._prompted = length
        return Silent()

    def _take_data(self, byte: int) -> None:
        """Take in one byte of what is to be sent: so many, or until Ctrl-Z; Escape: nothing."""
        if self._echo:
            self._say(bytes([byte]))
        by_length = self._prompted > 0
        if not by_length and byte == _ESCAPE:
            self._prompted, self._outgoing = -1, ""
            self._unsolicited("OK")
            return
        whole = not by_length and byte == _CTRL_Z
        if not whole:
            self._outgoing += chr(byte)
            whole = len(self._outgoing) >= (self._prompted or LARGEST)
        if whole:
            data, self._outgoing, self._prompted = self._outgoing.encode("latin-1"), "", -1
            self._send_data(data)

    def _send_data(self, data: bytes) -> None:
        self._sent += len(data)
        if data:
            self._transmit(segments.Segment(segments.DATA, self._connection, data))
        if self._quick:
            count = f"{self._index},{len(data)}" if self._multiple else f"{len(data)}"
            self._after(self.response_time, "say", f"DATA ACCEPT:{count}")
        else:
            self._busy = True
            self._after(self.send_timeout, "send failed")
            self._acknowledge(self._acknowledged)

    def _acknowledge(self, count: int) -> None:
        """Take in that so many bytes have arrived."""
        self._delivered += max(0, count - self._acknowledged)
        self._acknowledged = max(self._acknowledged, count)
        waiting = any(entry[2] == "send failed" for entry in self._agenda)
        if waiting and self._acknowledged >= self._sent:
            self._forget("send failed")
            self._after(self.response_time, "sent", f"{self._prefix()}SEND OK")

    def _send_failed(self) -> None:
        self._busy = False
        self._close_connection(notify=False)
        self._unsolicited(f"{self._prefix()}SEND FAIL")
        self._unsolicited(f"{self._prefix()}CLOSED")

    # ------------------------------------------------------------------ data in

    def _arrive(self, chunk: bytes) -> None:
        """Take in a segment of the base station. What belongs to no connection is dropped."""
        try:
            segment = segments.decode(chunk)
        except InputError:
            return
        if segment.connection != self._connection:
            return
        if segment.kind == segments.ACCEPT and self._ip_state == CONNECTING:
            self._forget("no connection")
            self._ip_state = CONNECTED
            self._unsolicited(f"{self._prefix()}{CONNECTED}")
        elif segment.kind == segments.REFUSE and self._ip_state == CONNECTING:
            self._connect_failed()
        elif self._ip_state != CONNECTED:
            return
        elif segment.kind == segments.ACKNOWLEDGE:
            self._acknowledge(int.from_bytes(segment.data[:4]))
        elif segment.kind == segments.CLOSE:
            self._close_connection(notify=False)
            self._unsolicited(f"{self._prefix()}CLOSED")
        elif segment.kind == segments.DATA:
            self._arrived += len(segment.data)
            if self._by_hand and not self._incoming:
                self._unsolicited(f"+CIPRXGET: 1{f',{self._index}' * self._multiple}")
            self._incoming += segment.data.decode("latin-1")

    def _pass_on(self) -> None:
        """Give the board what has arrived, unless it fetches it itself or is in a dialogue."""
        if self._by_hand or not self._incoming or self._busy or self._prompted != -1:
            return
        data, self._incoming = self._incoming.encode("latin-1"), ""
        if self._multiple:
            self._say(result(f"+RECEIVE,{self._index},{len(data)}:") + data)
        elif self._head:
            self._say(f"\r\n+IPD,{len(data)}:".encode() + data)
        else:
            self._say(data)

    def _fetch(self, command: Command) -> Answer:
        if command.form == "read":
            return [f"+CIPRXGET: {int(self._by_hand)}"]
        if command.form != "write":
            return []
        mode = command.number(0)
        if mode < 2:
            if self._ip_state in (CONNECTED, CONNECTING):
                raise RefusedError(NOT_ALLOWED)
            self._by_hand = mode == 1
            return []
        place = 2 if self._multiple else 1
        if not self._by_hand or mode > 4 or (self._multiple and command.number(1) >= _INDICES):
            raise RefusedError(NOT_ALLOWED)
        own = not self._multiple or command.number(1) == self._index
        index, there = (
            f"{command.fields[1]}," if self._multiple else "",
            self._incoming if own else "",
        )
        if mode == 4:
            return [f"+CIPRXGET: 4,{index}{len(there)}"]
        size = command.number(place)
        if not 0 < size <= LARGEST // (mode - 1):
            raise RefusedError(NOT_ALLOWED)
        data = there[:size]
        if own:
            self._incoming = there[size:]
        head = f"+CIPRXGET: {mode},{index}{len(data)},{len(there) - len(data)}"
        return [f"{head}\r\n{data.encode('latin-1').hex().upper() if mode == 3 else data}"]

    _TCP: ClassVar = {
        "+CSTT": "_start_task",
        "+CIICR": "_bring_up",
        "+CIFSR": "_own_address",
        "+CIPSHUT": "_shut",
        "+CIPSTART": "_connect",
        "+CIPCLOSE": "_close",
        "+CIPSTATUS": "_status",
        "+CIPSEND": "_send",
        "+CIPRXGET": "_fetch",
    }
