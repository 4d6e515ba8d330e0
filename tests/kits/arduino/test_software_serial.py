"""SoftwareSerial: the sketch's own UART at two pins, in the real library and in the host's."""

import pytest

from seatrial.errors import SimulationError

from .bench import Bench, write_sketch

pytestmark = pytest.mark.interop

SKETCH = """
#include <SoftwareSerial.h>
SoftwareSerial gps(4, 3), other(7, 8);
void setup() {
  Serial.begin(57600);
  other.begin(9600);
  gps.begin(9600);
  gps.print("hello "); gps.println(42);
  Serial.print(gps.isListening()); Serial.println(other.isListening());
}
void loop() {
  while (gps.available()) {
    char c = gps.read();
    Serial.write(c);
    if (c == '*') gps.write("got");   // and is deaf meanwhile
    if (c == '!') delay(200);         // and its buffer runs over
  }
  if (gps.overflow()) Serial.print(F("<over>"));
}
"""
WIRES = "4 soft_rx 1; 3 soft_tx 1"
NMEA = b"$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*"
"""It ends where the sketch goes deaf: of more, the hardware takes the middle of a byte for its start."""


def received(backend, sketch, **values):
    """Output of the sketch at its UART and at its pins, with times of the latter."""
    with Bench(sketch, backend, **values) as bench:
        bench.run(0.1)
        for _ in range(2):
            bench.receive(1, b"\r\n" + NMEA)
            bench.run(0.14)
        bench.receive(1, b"!" + bytes(range(40, 127)) * 2)
        bench.run(0.6)
        return bench.sent[0], bench.sent[1], [when for uart, when, _ in bench.stamps if uart == 1]


def test_both_back_ends_receive_and_send_the_same_at_two_pins(tmp_path):
    sketch = write_sketch(tmp_path, SKETCH)
    uno = {"mcu": "atmega328p", "uarts": "0 57600; 1 9600", "wires": WIRES}
    host, simavr = (received(each, sketch, **uno) for each in ("host", "simavr"))
    lines = simavr[0].split(b"\r\n")
    assert lines[0] == b"10"
    assert lines[2] == NMEA
    assert b"<over>" in simavr[0]
    assert host[:2] == simavr[:2]
    assert host[2] == pytest.approx(simavr[2], abs=1_500_000)  # ns; a byte lasts 1.04 ms


def test_bytes_that_arrive_while_it_sends_are_lost(tmp_path):
    """By the library's documentation it cannot do both at once; the host loses whole bytes."""
    sketch = write_sketch(tmp_path, SKETCH)
    with Bench(sketch, mcu="atmega328p", uarts="0 57600; 1 9600", wires=WIRES) as bench:
        bench.run(0.1)
        bench.receive(1, b"*abcd")
        bench.run(0.1)
        assert bench.sent[0] == b"10\r\n*d"


def test_pins_of_a_mega_take_the_line_of_its_uart(tmp_path):
    sketch = write_sketch(tmp_path, SKETCH.replace("gps(4, 3)", "gps(10, 11)"))
    mega = {"uarts": "0 57600; 1 9600", "wires": "10 soft_rx 1; 11 soft_tx 1"}
    host, simavr = (received(each, sketch, **mega) for each in ("host", "simavr"))
    assert simavr[1].startswith(b"hello 42\r\n")
    assert host[:2] == simavr[:2]


def test_another_rate_than_the_lines_ends_it(tmp_path):
    sketch = write_sketch(tmp_path, SKETCH)
    with (
        Bench(sketch, mcu="atmega328p", uarts="0 57600; 1 4800", wires=WIRES) as bench,
        pytest.raises(SimulationError, match=r"UART 1 open at 9600 baud.*4800"),
    ):
        bench.run(2.1)
