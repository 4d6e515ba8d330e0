"""Idioms of other people's sketches, rebuilt small; the firmware is the reference."""

import pytest

from seatrial.errors import InputError, SimulationError

from .bench import Bench, write_sketch

pytestmark = pytest.mark.interop

BACKENDS = ("host", "simavr")
both = pytest.mark.parametrize("backend", BACKENDS)

LANGUAGE = r"""
#include <avr/pgmspace.h>
#include "src/deep/twice.h"
enum State { IDLE, RUN, DONE };
inline State operator++(State &state, int) { State was = state; state = (State)(was + 1); return was; }
const char first[] PROGMEM = "north";
const char second[] PROGMEM = "south-west";
const char *const names[] PROGMEM = {first, second};
const uint16_t numbers[] PROGMEM = {513, 65535};
struct Packet { uint8_t id; uint16_t speed; uint32_t time; float angle; uint8_t end; };
struct Held { uint8_t flag; Packet packet; };
void setup() {
  Serial.begin(115200);
  State state = IDLE;
  state++; state++;
  Serial.println(state);
  char text[20];
  for (int i = 0; i < 2; i++) {
    strcpy_P(text, (char *)pgm_read_word(&(names[i])));
    Serial.println(text);
    Serial.println(pgm_read_word(&numbers[i]));
    Serial.println((const __FlashStringHelper *)pgm_read_word(names + i));
  }
  Serial.println(sizeof(Packet)); Serial.println(sizeof(Held)); Serial.println(offsetof(Held, packet.angle));
  Packet packet = {1, 515, 0x01020304UL, 1.0, 9};
  Serial.write((const uint8_t *)&packet, sizeof(packet)); Serial.println();
  packet.speed++; uint16_t &speed = packet.speed; speed *= 2; Serial.println(packet.speed);
  Serial.println("Kurs 90\260");
  Serial.println(twice(21)); Serial.println(GIVEN);
}
void loop() {}
"""


@pytest.fixture(scope="module")
def language(tmp_path_factory):
    """What the sketch says in each back end; its degree sign is Latin-1."""
    folder = tmp_path_factory.mktemp("language")
    sketch = write_sketch(
        folder,
        "",
        src__deep__twice_dot_h="int twice(int x);\n",
        src__deep__twice_dot_cpp='#include "twice.h"\nint twice(int x) { return 2 * x; }\n',
    )
    text = LANGUAGE.replace("\\260", "\xb0")
    (sketch / "one.ino").write_bytes(text.encode("latin-1"))
    said = {}
    for backend in BACKENDS:
        with Bench(sketch, backend, flags="-DGIVEN=77") as bench:
            said[backend] = bench.run(0.2).split(b"\r\n")
    return said


def test_language_is_the_same_in_both(language):
    assert language["host"] == language["simavr"]


@both
def test_language_is_the_boards(language, backend):
    said = language[backend]
    assert said[:7] == [b"2", b"north", b"513", b"north", b"south-west", b"65535", b"south-west"]
    assert said[7:10] == [b"12", b"13", b"8"]  # no padding: 1 + 2 + 4 + 4 + 1
    assert said[10] == b"\x01\x03\x02\x04\x03\x02\x01\x00\x00\x80\x3f\x09"
    assert said[11:15] == [b"1032", b"Kurs 90\xb0", b"42", b"77"]


@both
def test_libraries_of_headers_conditions_and_other_folders(tmp_path, backend):
    shelf = tmp_path / "sketchbook"
    for name, text in {
        "Deep/src/deep.h": "int deep();",
        "Deep/src/deep.cpp": '#include "deep.h"\nint deep() { return 5; }',
        "Deep/examples/e/e.cpp": "#error an example",
        "Wide/wide.h": '#include <Deep/extra.h>\n#include "deep.h"\ninline int wide() { return deep() + EXTRA; }',
        "Deep/extra.h": "#include <pins_arduino.h>\n#define EXTRA 2",
        "Other/other.h": "int other();",
        "Other/other.cpp": "#error for another board",
    }.items():
        file = shelf / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text + "\n")
    sketch = write_sketch(
        tmp_path,
        '#include "mine.h"\nvoid setup() { Serial.begin(115200); Serial.print(wide()); }\nvoid loop() {}\n',
        mine_dot_h="#ifdef ESP32\n#include <other.h>\n#endif\n#include <wide.h>\n",
    )
    with Bench(sketch, backend, libraries="../sketchbook") as bench:
        assert bench.run(0.1) == b"7"
    with pytest.raises(InputError, match=r"libraries: '\.\./nowhere': there is no folder"):
        Bench(sketch, backend, libraries="../nowhere")
    with pytest.raises(InputError, match=r"flags: '-o' is not allowed"):
        Bench(sketch, backend, flags="-o x")


@both
def test_a_sketch_of_one_cpp_or_of_another_name(tmp_path, backend):
    text = "#include <Arduino.h>\nvoid setup() { Serial.begin(115200); Serial.print(4); }\nvoid loop() {}\n"
    folder = write_sketch(tmp_path, "", "plain")
    (folder / "plain.ino").unlink()
    (folder / "Main.cpp").write_text(text)
    with Bench(folder / "Main.cpp", backend) as bench:
        assert bench.run(0.1) == b"4"
    (folder / "Main.cpp").rename(folder / "motor.ino")
    with Bench(folder, backend) as bench:
        assert bench.run(0.1) == b"4"


@both
def test_a_sketch_with_lines_of_another_tool_and_a_copy_for_older_ones(tmp_path, backend):
    source = """#line 1 "Other.ino"
#include <Arduino.h>
#line 5
void setup() { Serial.begin(115200); Serial.print(__LINE__); later(); }
  # line 40
void later() { Serial.print(__LINE__); }
void loop() {}
"""
    folder = write_sketch(tmp_path, source)
    (folder / "one.pde").write_text(source)
    with Bench(folder, backend) as bench:
        assert bench.run(0.1) == b"540"
    (folder / "one.ino").write_text(source.replace("later();", "nowhere();"))
    with pytest.raises(InputError, match=r"Other\.ino:5.*nowhere"):
        Bench(folder, backend)


@pytest.mark.parametrize(("mcu", "timer"), [("atmega2560", 5), ("atmega328p", 1)])
def test_a_timer_is_the_sketchs_as_long_as_it_has_no_servo(tmp_path, mcu, timer):
    source = """
volatile unsigned int ticks = 0;
ISR(TIMER@_COMPA_vect) { ticks++; }
void setup() {
  Serial.begin(115200);
  TCCR@A = 0; TCCR@B = _BV(WGM@2) | _BV(CS@1) | _BV(CS@0); OCR@A = 2499; TIMSK@ = _BV(OCIE@A);
}
void loop() { delay(500); Serial.println(ticks); }
""".replace("@", str(timer))
    with Bench(write_sketch(tmp_path, source), "simavr", mcu=mcu) as bench:
        assert int(bench.run(0.6)) == pytest.approx(50, abs=1)


@both
def test_a_uart_that_stays_at_another_rate_than_its_line_is_noticed(tmp_path, backend):
    source = "void setup() { Serial.begin(9600); }\nvoid loop() { Serial.print('x'); delay(50); }\n"
    with Bench(write_sketch(tmp_path, source), backend) as bench:
        assert bench.run(1.9) == b""
        with pytest.raises(SimulationError, match=r"UART 0 open at 96\d\d baud.*115200"):
            bench.run(0.2)


@both
def test_a_uart_that_is_not_open_has_no_rate(tmp_path, backend):
    sketch = write_sketch(tmp_path, "void setup() {}\nvoid loop() {}\n")
    with Bench(sketch, backend, uarts="0 9600; 1 4800") as bench:
        assert bench.run(2.5) == b""


@both
def test_a_sketch_finds_the_rate_of_its_instrument(tmp_path, backend):
    source = """
const long rates[] = {4800, 9600, 115200, 38400};
void setup() {
  Serial.begin(115200);
  for (long rate : rates) {
    Serial1.begin(rate);
    for (unsigned long begun = millis(); millis() - begun < 1200;) {
      if (Serial1.read() == '$') { Serial.print(rate); return; }
    }
    Serial1.end();
  }
}
void loop() {}
"""
    sketch = write_sketch(tmp_path, source)
    with Bench(sketch, backend, uarts="0 115200; 1 38400") as bench:
        for _ in range(50):
            bench.receive(1, b"$GPHDT,1,T*00\r\n")
            bench.run(0.1)
        assert bench.sent[0] == b"38400"


@both
@pytest.mark.parametrize("rate", [300, 9600, 38400, 57600, 115200, 250000, 1000000])
def test_the_usual_rates_are_none(tmp_path, backend, rate):
    source = f"void setup() {{ Serial.begin({rate}); Serial.print('x'); }}\nvoid loop() {{}}\n"
    with Bench(write_sketch(tmp_path, source), backend, uarts=f"0 {rate}") as bench:
        assert bench.run(0.2) == b"x"


@both
def test_a_hung_sketch_is_noticed_with_its_line(tmp_path, backend):
    source = """volatile bool never = false;
void setup() { Serial.begin(115200); Serial.print("begun"); }
void loop() {
  delay(100);
  while (!never) {}
}
"""
    with Bench(write_sketch(tmp_path, source), backend, patience=0.5) as bench:
        with pytest.raises(
            SimulationError, match=r"at 0\.6\d+ s.*for 0\.5\d* s.*endless loop"
        ) as error:
            bench.run(2.0)
        assert bench.sent[0] == b"begun"
    if backend == "simavr":
        assert "one.ino:5" in str(error.value)


@both
def test_waiting_is_no_hang(tmp_path, backend):
    source = """
volatile bool ticked = false;
void tick() { ticked = true; }
void setup() { Serial.begin(115200); attachInterrupt(digitalPinToInterrupt(2), tick, RISING); }
void loop() {
  delay(1500);
  unsigned long begun = millis();
  while (millis() - begun < 1500) {}
  ticked = false;
  while (!ticked) {}
  Serial.print("on");
}
"""
    with Bench(
        write_sketch(tmp_path, source), backend, patience=0.6, wires="2 anemometer 2"
    ) as bench:
        bench.one.set("wind_speed", 1.0)
        assert bench.run(4.0) == b"on"


RESET = """
#include <avr/wdt.h>
#include <EEPROM.h>
int lives = 1;
void setup() {
  uint8_t why = MCUSR;
  MCUSR = 0;
  wdt_disable();
  Serial.begin(115200);
  Serial.print(lives++); Serial.print(why & _BV(WDRF) ? 'w' : '-'); Serial.print(EEPROM.read(1)); Serial.print(' ');
  EEPROM.write(1, EEPROM.read(1) + 1);
  digitalWrite(7, HIGH); pinMode(7, OUTPUT); digitalWrite(7, HIGH);
  delay(100);
  if (EEPROM.read(1) < 13) { wdt_enable(WDTO_15MS); while (true) {} }
  Serial.print("goes on at "); Serial.print(Serial.available()); Serial.print(' '); Serial.print(analogRead(A0));
}
void loop() {}
"""


@both
def test_the_watchdog_starts_the_board_again_and_the_eeprom_is_kept(tmp_path, backend):
    before, after = tmp_path / "before.bin", tmp_path / "after.bin"
    before.write_bytes(bytes([7, 10, 9]))
    values = {
        "eeprom": str(before),
        "eeprom_after": str(after),
        "wires": "A0 voltage 1; 7 output 1",
    }
    with Bench(write_sketch(tmp_path, RESET), backend, **values) as bench:
        bench.one.set("voltage.v1", 3.0)
        said = bench.run(0.6)
        before_adc, _, adc = said.rpartition(b" ")
        assert before_adc == b"1-10 1w11 1w12 goes on at 0"
        assert int(adc) == pytest.approx(614, abs=1)  # 3 V of 5 V
        assert bench.one.get("resets") == 2
        assert bench.one.get("output.o1")
    assert after.read_bytes() == bytes([7, 13, 9]) + b"\xff" * 4093
    assert before.read_bytes() == bytes([7, 10, 9])


@both
def test_an_eeprom_by_avr_libcs_names(tmp_path, backend):
    source = """
#include <avr/eeprom.h>
struct Gains { uint8_t kind; float p; };
void setup() {
  Serial.begin(115200);
  Gains gains;
  eeprom_read_block(&gains, (const void *)16, sizeof(gains));
  Serial.print(gains.kind); Serial.print(' '); Serial.print(gains.p);
  eeprom_update_word((uint16_t *)2, 0x1234);
  Serial.print(' '); Serial.print(eeprom_read_byte((uint8_t *)3), HEX);
}
void loop() {}
"""
    given = tmp_path / "given.bin"
    given.write_bytes(b"\xff" * 16 + b"\x05\x00\x00\x20\x40")
    with Bench(write_sketch(tmp_path, source), backend, eeprom=str(given)) as bench:
        assert bench.run(0.2) == b"5 2.50 12"


def test_an_eeprom_that_is_too_large_is_refused(tmp_path):
    large = tmp_path / "large.bin"
    large.write_bytes(bytes(1025))
    sketch = write_sketch(tmp_path, "void setup() {}\nvoid loop() {}\n")
    with pytest.raises(InputError, match="1025 bytes, the EEPROM of the Uno 1024"):
        Bench(sketch, mcu="atmega328p", eeprom=str(large))
