"""Refusals of `seatrial sketch check` and of runs: all that a board or its build would refuse."""

import pytest

from seatrial.errors import SimulationError
from tests.command import seatrial

from .bench import Bench, need, write_sketch

pytestmark = pytest.mark.interop

BACKENDS = ("host", "simavr")
both = pytest.mark.parametrize("backend", BACKENDS)
EMPTY = "void setup() {}\nvoid loop() {}\n"


def check(folder, source, backend, *more):
    """Return the exit status and the errors of `seatrial sketch check`."""
    need(backend)
    sketch = str(write_sketch(folder, source))
    done = seatrial("sketch", "check", sketch, "--backend", backend, *more, cwd=folder)
    assert ("nothing is unsupported" in done.stdout) == (done.returncode == 0)
    return done.returncode, done.stdout + done.stderr


@both
def test_check_names_all_libraries_that_are_not_there(tmp_path, backend):
    source = (
        "#include <Absent.h>\n#ifdef ESP32\n#include <NotOurs.h>\n#endif\n"
        '#ifdef __AVR__\n#include "AlsoAbsent.h"\n#endif\n' + EMPTY
    )
    status, text = check(tmp_path, source, backend)
    assert status == 2
    assert "one.ino:1: the library of <Absent.h> is not there" in text
    assert "one.ino:6: the library of <AlsoAbsent.h> is not there" in text
    assert "NotOurs" not in text


@both
def test_check_has_the_compilers_errors_of_every_file(tmp_path, backend):
    sketch = write_sketch(
        tmp_path, "void setup() { first(); }\nvoid loop() {}\n", other_dot_cpp="int x = second;\n"
    )
    need(backend)
    done = seatrial("sketch", "check", str(sketch), "--backend", backend, cwd=tmp_path)
    assert done.returncode == 2
    assert "one.ino:1:" in done.stderr
    assert "'first' was not declared" in done.stderr
    assert "other.cpp:1:" in done.stderr
    assert "'second' was not declared" in done.stderr


@both
@pytest.mark.parametrize(
    ("source", "board"),
    [
        ("#include <WiFi.h>\n#include <Preferences.h>\n", "ESP32 (WiFi.h, Preferences.h)"),
        ("#ifndef ESP32\n#error not this one\n#endif\n", "ESP32 (#error without ESP32)"),
        ("#include <FlexCAN_T4.h>\n", "Teensy (FlexCAN_T4.h)"),
        ("int pins[] = {PA5, PB10};\n", "STM32 (PA5, PB10)"),
        ("#include <RTCZero.h>\n", "SAMD (RTCZero.h)"),
    ],
)
def test_check_names_the_board_that_a_sketch_is_for(tmp_path, backend, source, board):
    status, text = check(tmp_path, source + EMPTY, backend)
    assert status == 2
    assert f"for the {board}" in text


@both
def test_a_sketch_for_several_boards_is_for_this_one_too(tmp_path, backend):
    source = "#ifdef ESP32\n#include <WiFi.h>\n#else\n#include <Wire.h>\n#endif\n" + EMPTY
    status, text = check(tmp_path, source, backend)
    assert status == 0, text
    assert "for the" not in text.replace("builds for the back end", "")


def test_check_names_the_pin_of_a_uart_in_software_that_has_no_line(tmp_path):
    """Both of its pins have to be right: bytes go from and to pins."""
    source = "#include <SoftwareSerial.h>\nSoftwareSerial ss(4, 3);\nvoid setup() { ss.begin(9600); }\nvoid loop() {}\n"
    (tmp_path / "hil_profiles").mkdir()
    (tmp_path / "hil_profiles" / "mine.toml").write_text(
        'title = "mine"\n[links.uno]\nkind = "arduino"\nmcu = "atmega328p"\n'
        'uarts = "0 115200; 1 9600"\nwires = "7 soft_rx 1; 3 soft_tx 1"\n'
    )
    status, text = check(tmp_path, source, "host", "--profile", "mine:uno")
    assert status == 2
    assert "one.ino:2: it reads at pin 4, and soft_rx of the profile is at pin 7" in text


@both
def test_bytes_come_only_from_the_pin_that_has_them(tmp_path, backend):
    source = """
#include <SoftwareSerial.h>
SoftwareSerial ss(4, 3);
void setup() { Serial.begin(115200); ss.begin(9600); ss.print("out"); }
void loop() { while (ss.available()) Serial.write(ss.read()); }
"""
    for wires, got, sent in (
        ("4 soft_rx 1; 3 soft_tx 1", b"in", b"out"),
        ("7 soft_rx 1; 3 soft_tx 1", b"", b"out"),
        ("4 soft_rx 1; 7 soft_tx 1", b"in", b""),
    ):
        sketch = write_sketch(tmp_path, source)
        values = {"mcu": "atmega328p", "uarts": "0 115200; 1 9600", "wires": wires}
        with Bench(sketch, backend, **values) as bench:
            bench.run(0.1)
            bench.receive(1, b"in")
            assert (bench.run(0.1), bench.sent[1]) == (got, sent), wires


@both
@pytest.mark.parametrize(
    "use", ["digitalWrite(pin, 1)", "pinMode(pin, OUTPUT)", "digitalRead(pin)", "tone(pin, 440, 1)"]
)
@pytest.mark.parametrize(("mcu", "pins"), [("atmega2560", 70), ("atmega328p", 20)])
def test_a_pin_that_is_none_ends_it_with_the_pin_and_the_line(tmp_path, backend, use, mcu, pins):
    source = f"volatile byte pin = {pins - 1};\nvoid setup() {{}}\nvoid loop() {{\n  {use};\n  delay(10);\n  pin = {pins};\n}}\n"
    expected = rf"uses pin {pins}: the (Mega|Uno) has 0 to {pins - 1} \(.*one\.ino:[34]\)"
    with (
        Bench(write_sketch(tmp_path, source), backend, mcu=mcu) as bench,
        pytest.raises(SimulationError, match=expected),
    ):
        bench.run(0.1)


@pytest.mark.parametrize(
    "use",
    [
        "*(volatile int *)nowhere = 1",
        "strcpy((char *)nowhere, text)",
        "kept = strlen((char *)nowhere)",
    ],
)
@pytest.mark.parametrize("nowhere", ["0", "0x7fff1234"])
def test_an_access_to_nowhere_ends_it_with_the_line_of_the_sketch(tmp_path, use, nowhere):
    source = (
        f'volatile uintptr_t nowhere = {nowhere};\nchar text[4] = "abc";\n'
        f"volatile long kept;\nvoid use() {{\n  {use};\n}}\n"
        "void setup() {}\nvoid loop() { delay(5); use(); }\n"
    )
    with (
        Bench(write_sketch(tmp_path, source)) as bench,
        pytest.raises(SimulationError, match=r"Segmentation fault at address .*one\.ino:[56]\)"),
    ):
        bench.run(0.1)


@both
def test_the_status_register_saves_and_restores_the_flag_of_interrupts(tmp_path, backend):
    source = """
volatile unsigned n;
void count() { n++; byte was = SREG; cli(); SREG = was; }
void setup() {
  Serial.begin(115200); attachInterrupt(digitalPinToInterrupt(2), count, CHANGE);
  byte was = SREG; cli(); byte off = SREG; SREG = was; byte on = SREG;
  Serial.print(off >> 7); Serial.print(on >> 7); Serial.print(bitRead(was, SREG_I));
  cli(); was = SREG; cli(); SREG = was; Serial.print(SREG >> 7); sei();
  bitClear(SREG, SREG_I); delayMicroseconds(30000); unsigned none = n; SREG |= _BV(SREG_I);
  delay(95); Serial.print(none == n); Serial.print(' '); cli(); unsigned all = n; sei(); Serial.print(all);
}
void loop() {}
"""
    with Bench(write_sketch(tmp_path, source), backend, wires="2 anemometer 1") as bench:
        bench.one.set("wind_speed", 100.0)
        bits, edges = bench.run(0.3).split()
    assert bits == b"01100"
    assert int(edges) == pytest.approx(20, abs=1)  # 200 edges a second for 95 ms, one that waited


@both
@pytest.mark.parametrize("frequency", [40, 440, 3000, 20000])
def test_a_tone_has_its_frequency_and_duration(tmp_path, backend, frequency):
    """ATmega2560 data sheet, 20.7.2: f = f_clk / (2 N (1 + OCR)), with 8 bits of OCR and N of 1 to 1024."""
    source = f"""
void setup() {{ Serial.begin(115200); tone(8, {frequency}, 150); delay(200); Serial.print(digitalRead(8)); tone(8, {frequency}); }}
void loop() {{}}
"""
    with Bench(write_sketch(tmp_path, source), backend, wires="8 step 1") as bench:
        bench.run(0.18)
        assert bench.one.get("steps.m1") == pytest.approx(0.15 * frequency, abs=1.01)
        bench.run(0.02)
        before = bench.one.get("steps.m1")
        bench.run(0.5)
        assert bench.sent[0] == b"0"
        assert bench.one.get("steps.m1") - before == pytest.approx(0.5 * frequency, rel=0.02, abs=1)


@both
def test_a_library_that_announces_its_interrupt_to_spi_works(tmp_path, backend):
    source = """
#include <SPI.h>
void setup() { Serial.begin(115200); SPI.begin(); SPI.usingInterrupt(digitalPinToInterrupt(2));
  SPI.beginTransaction(SPISettings(1000000, MSBFIRST, SPI_MODE0)); SPI.endTransaction(); SPI.notUsingInterrupt(0);
  Serial.print("on"); }
void loop() {}
"""
    with Bench(write_sketch(tmp_path, source), backend) as bench:
        assert bench.run(0.1) == b"on"
