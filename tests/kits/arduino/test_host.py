"""The host back end: what a sketch may do, what is refused, and how it ends."""

import itertools
import os
import time
from pathlib import Path

import pytest
import serial

from seatrial.errors import InputError, SimulationError
from seatrial_kits.arduino.component import Arduino
from seatrial_kits.arduino.sources.dialect import narrowed
from seatrial_kits.arduino.sources.sketch import with_prototypes

from .bench import Bench, write_sketch

WAIT_S = 30.0
NOTHING = "void setup() {}\nvoid loop() {}\n"


def running(tmp_path, source, **values):
    return Bench(**{"sketch": write_sketch(tmp_path, source), **values})


@pytest.mark.interop
def test_tabs_libraries_and_prototypes(tmp_path):
    main = """
#include <Twice.h>
void setup() { Serial.begin(115200); }
void loop() { say(twice(second(4))); delay(1000); }  // they come later
"""
    sketch = write_sketch(
        tmp_path,
        main,
        b_tab_dot_ino="int second(int x) { return x + 1; }\nvoid say(int n) { Serial.println(n); }\n",
        libraries__Twice__src__Twice_dot_h="int twice(int x);\n",
        libraries__Twice__src__Twice_dot_cpp='#include "Twice.h"\nint twice(int x) { return 2 * x; }\n',
    )
    with Bench(sketch) as bench:
        assert bench.run(0.1) == b"10\r\n"


def test_what_is_meant_for_another_board_does_not_matter(tmp_path):
    source = """
#if defined(ESP32)
#include <WiFi.h>
#endif
void setup() { Serial.begin(115200); tell(2, 30, 4); }
void loop() {}
void tell(int count, ...) {
  va_list values;
  va_start(values, count);
  for (int i = 0; i < count; i++) Serial.println(va_arg(values, int));
  va_end(values);
}
"""
    with running(tmp_path, source) as bench:
        assert bench.run(0.1) == b"30\r\n4\r\n"


def test_time_passes_by_the_board_and_by_busy_waits(tmp_path):
    source = """
volatile bool ticked = false;
void tick() { ticked = true; }
void setup() { Serial.begin(115200); attachInterrupt(digitalPinToInterrupt(3), tick, RISING); }
void loop() {
  unsigned long begin = millis();
  while (millis() - begin < 250) {}
  ticked = false;
  while (!ticked) {}               // nothing is called: only an interrupt ends it
  Serial.println(millis());
}
"""
    with running(tmp_path, source, wires="3 anemometer 1") as bench:
        bench.one.set("wind_speed", 2.0)  # 2 Hz
        times = [int(each) for each in bench.run(2.1).split()]
    assert [b - a for a, b in itertools.pairwise(times)] == pytest.approx([500] * 3, abs=2)


def test_the_clock_is_the_trials(tmp_path):
    source = "void setup() { Serial.begin(115200); }\nvoid loop() { Serial.println(micros()); delay(1); }"
    with running(tmp_path, source) as bench:
        bench.run(5.0)
        last = int(bench.sent[0].split()[-2])
    assert last / 1e6 == pytest.approx(5.0, abs=0.01)


def test_a_line_of_nmea_arrives_whole_and_an_overrun_loses(tmp_path):
    source = """
void setup() { Serial.begin(115200); Serial1.begin(38400); }
void loop() { delay(20); while (Serial1.available()) Serial.write(Serial1.read()); }
"""
    with running(tmp_path, source, uarts="0 115200; 1 38400") as bench:
        bench.receive(1, b"x" * 60)
        bench.run(0.1)
        assert bench.sent[0] == b"x" * 60
        bench.receive(1, b"y" * 300)  # 78 ms; 76 bytes come in 20 ms, and 63 wait
        assert 200 < len(bench.run(0.2)) < 300


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        (
            "void setup() {\n  TCCR1A = 0;\n}\nvoid loop() {}\n",
            r"one\.ino:2: TCCR1A is a register.*simavr",
        ),
        (
            "#include <Ethernet.h>\n" + NOTHING,
            r"one\.ino:1: the library of <Ethernet\.h>.*libraries",
        ),
        ("#include <avr/sleep.h>\n" + NOTHING, r"one\.ino:1: <avr/sleep\.h>.*simavr"),
        (NOTHING + "ISR(TIMER1_OVF_vect) {}\n", r"one\.ino:3: ISR: .*attachInterrupt"),
        (
            "#include <avr/interrupt.h>\n#ifdef __AVR__\nSIGNAL(TIMER0_COMPA_vect) {}\n#endif\n"
            + NOTHING,
            r"TIMER0_COMPA_vect: interrupt routines .* simavr(?s:.)*one\.ino:3",
        ),
        (
            "#ifdef __AVR__\n#include <Ethernet.h>\n#endif\n" + NOTHING,
            r"one\.ino:2: the library of <Ethernet\.h>.*libraries",
        ),
        (
            "#include <Wire.h>\nvoid setup() {\n  Wire.begin(8);\n}\nvoid loop() {}\n",
            r"one\.ino:3:.*master of its I2C bus",
        ),
        ("void setup() {\n  int x = y;\n}\nvoid loop() {}\n", r"one\.ino:2:.*'y' was not declared"),
    ],
)
def test_what_cannot_be_is_refused_with_its_line(tmp_path, source, expected):
    with pytest.raises(InputError, match=expected):
        running(tmp_path, source)


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("void setup() {}\nvoid loop() { for (;;) {} }\n", "endless loop"),
        (
            "volatile int n;\nint deep(int x) { volatile char a[200]; a[0] = n; return deep(x + 1) + a[0]; }\n"
            "void setup() {}\nvoid loop() { n = deep(0); }\n",
            "overran its stack",
        ),
        (
            "volatile byte *nowhere = 0;\nvoid setup() {}\nvoid loop() {\n  delay(50);\n  *nowhere = 1;\n}\n",
            r"crashed: Segmentation fault at address 0x0 \(.*one\.ino:5\)",
        ),
        (
            "void setup() { Serial.begin(9600); }\nvoid loop() {}\n",
            "UART 0 open at 9600 baud.*115200",
        ),
    ],
)
def test_a_sketch_that_goes_wrong_ends_its_component_only(tmp_path, source, expected):
    with (
        running(tmp_path, source, patience=0.5) as bench,
        pytest.raises(SimulationError, match=f"(?s)mega: at .* s of its time .*{expected}"),
    ):
        bench.run(2.1)


def test_two_of_one_sketch_have_nothing_in_common(tmp_path):
    source = "int n = 0;\nvoid setup() { Serial.begin(115200); }\nvoid loop() { Serial.println(n++); delay(100); }"
    sketch = write_sketch(tmp_path, source)
    with Bench(sketch) as one, Bench(sketch) as other:
        one.run(1.0)
        assert other.run(0.15) == b"0\r\n1\r\n"


def test_its_state_cannot_be_saved(tmp_path):
    with running(tmp_path, NOTHING) as bench, pytest.raises(SimulationError, match="no state"):
        bench.one.get_state()


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"wires": "9 serbo 1"}, "did you mean 'servo'"),
        ({"wires": "99 servo 1"}, "pin '99': the Mega has 0 to 69"),
        ({"wires": "9 servo 1; 9 pwm 1"}, "used twice"),
        ({"wires": "9 servo 13"}, "13 is not in 1 to 12"),
        ({"uarts": "1 fast"}, "'1 fast' is not 'UART BAUD'"),
        ({"sketch": "/nowhere"}, "no sketch there"),
        ({"backend": "board", "links": ""}, "UART=URL"),
    ],
)
def test_wrong_parameters_are_named(tmp_path, values, expected):
    with pytest.raises(InputError, match=expected):
        running(tmp_path, NOTHING, **values)


def children():
    """Return the processes that this one has begun, those that nobody has waited for too."""
    return Path(f"/proc/self/task/{os.getpid()}/children").read_text("ascii").split()


@pytest.mark.interop
def test_boards_come_and_go_without_a_trace(tmp_path):
    sketch = write_sketch(tmp_path, NOTHING)
    with Bench(sketch) as bench:
        bench.run(0.02)
    before = len(os.listdir("/proc/self/fd")), children()
    for _ in range(200):
        with Bench(sketch) as bench:
            bench.run(0.02)
    assert (len(os.listdir("/proc/self/fd")), children()) == before


def test_it_is_much_faster_than_the_clock(tmp_path):
    source = "void setup() { Serial.begin(115200); }\nvoid loop() { if (millis() % 100 == 0) digitalWrite(13, HIGH); }"
    with running(tmp_path, source) as bench:
        bench.run(0.1)
        begin = time.process_time(), time.monotonic()
        bench.run(10.0)
        assert time.monotonic() - begin[1] < 10.0


def test_prototypes_and_widths():
    source = "int a = 1;\nint f(int x) {\n  return g(x);\n}\nlong g(long y = 2) { return y; }\nvoid h() {}\n"
    text = with_prototypes(f'#line 1 "x.ino"\n{source}')
    assert "int f ( int x ) ;" in text.replace(");", ") ;")
    assert "h ( )" in text
    assert "long g (" not in text  # it has a default argument
    given = 'unsigned long a = 5UL; int b; long long c; double d; char e[] = "int long"; // int'
    assert narrowed(given) == (
        'unsigned int a = 5u; short b; long long c; double d; char e[] = "int long"; // int'
    )


def test_a_monitor_receives_and_types_beside_what_is_connected(tmp_path):
    source = """
      void setup() { Serial.begin(115200); }
      void loop() { if (Serial.available()) Serial.write(toupper(Serial.read())); }
    """
    place = tmp_path / "uart0"
    with Bench(write_sketch(tmp_path, source), monitors=f"0=pty:{place}") as bench:
        assert bench.one.get("reached_at") == str(place)
        with serial.Serial(str(place), 115200, timeout=WAIT_S) as port:
            bench.receive(0, b"wire ")
            assert bench.run(0.1) == b"WIRE "
            assert port.read(5) == b"WIRE "
            port.write(b"typed")
            deadline = time.monotonic() + WAIT_S
            while bench.sent[0] != b"WIRE TYPED":
                assert time.monotonic() < deadline
                bench.run(0.02)
            assert port.read(5) == b"TYPED"
    assert not place.exists()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("pty:/tmp/a", "not UART=URL"),
        ("4=pty:/tmp/a", "not UART=URL"),
        ("0=pty:/tmp/a 0=pty:/tmp/b", "UART 0 has a link already"),
        ("0=tty:/tmp/a", "unknown kind of link 'tty'"),
    ],
)
def test_a_monitor_that_cannot_be(text, expected):
    one = Arduino("mega")
    one.set("monitors", text)
    with pytest.raises(InputError, match=rf"monitors.*{expected}"):
        one.initialise()
