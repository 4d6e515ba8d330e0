"""The modem's parameters, inputs and outputs."""

from __future__ import annotations

from typing import ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Component, Input, Output, Parameter, terminal

BEST = 31
"""Best signal quality that AT+CSQ counts: -51 dBm or more; each less is 2 dB."""


def _check_pin(text: str) -> None:
    if text and not (text.isdecimal() and 4 <= len(text) <= 8):
        raise InputError(f"pin is {text!r}, allowed are 4 to 8 digits, or nothing for no PIN")


class GprsPorts(Component):
    """Parameters, inputs and outputs of `GprsModem`."""

    boot_time = Parameter(3.0, "s", "from power to its first words", min=0.0)
    registration_time = Parameter(8.0, "s", "from a network in reach to being registered", min=0.0)
    attach_time = Parameter(2.0, "s", "to attach to GPRS", min=0.0)
    context_time = Parameter(2.0, "s", "to activate a context (AT+CIICR)", min=0.0)
    response_time = Parameter(0.02, "s", "from a command to its answer", min=1e-3)
    latency = Parameter(0.4, "s", "of the network, one way", min=0.0)
    uplink_rate = Parameter(20000.0, "1/s", "bit rate to the network", min=1.0)
    downlink_rate = Parameter(40000.0, "1/s", "bit rate from the network", min=1.0)
    connect_timeout = Parameter(75.0, "s", "after which a connection has failed", min=1e-3)
    send_timeout = Parameter(45.0, "s", "without acknowledgement, after which it is lost", min=1e-3)
    drop_time = Parameter(60.0, "s", "without a network, after which the context is gone", min=0.0)
    pin = Parameter("", "1", "PIN of the SIM card; empty for none", check=_check_pin)
    address = Parameter("10.64.12.7", "1", "IP address that the network gives")
    supply_min = Parameter(4.5, "V", "supply below which it is off", min=0.0)
    idle_current = Parameter(0.02, "A", "drawn when it does not send", min=0.0)
    sending_current = Parameter(0.3, "A", "drawn on average while it sends or searches", min=0.0)

    rx = Input("1", "bytes from the board, as text", type=str, role="bytes", optional=True)
    downlink = Input(
        "1", "segments from the base station, as text", type=str, role="bytes", optional=True
    )
    signal_quality = Input(
        "1",
        f"as AT+CSQ counts it, 0 to {BEST}; below 1 there is no network",
        start=20.0,
        optional=True,
    )
    supply = Input("V", "voltage of its supply", start=7.4, optional=True)

    tx = Output("1", "bytes to the board, as text", type=str, role="bytes")
    uplink = Output("1", "segments to the base station, as text", type=str, role="bytes")
    registered = Output("1", "whether it is registered in a network", type=bool)
    attached = Output("1", "whether it is attached to GPRS", type=bool)
    linked = Output("1", "whether its TCP connection is established", type=bool)
    state = Output("1", "as AT+CIPSTATUS says it; OFF without supply", type=str)
    bytes_up = Output("1", "bytes that the base station acknowledged", type=int)
    bytes_down = Output("1", "bytes received from the base station", type=int)
    current = Output("A", "drawn from its supply")

    terminals: ClassVar = {
        "serial": terminal(down="tx", up="rx"),
        "network": terminal(up="uplink", down="downlink"),
    }
