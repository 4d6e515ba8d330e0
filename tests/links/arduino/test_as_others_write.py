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
        "Deep/extra.h": "#define EXTRA 2",
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


def test_servo_pulses_of_a_timer_and_a_clock_that_is_divided(tmp_path):
    """Period and width by the data sheet: (ICR + 1) and (OCR + 1) cycles of the prescaled clock."""
    source = """
void setup() {
  cli(); CLKPR = _BV(CLKPCE); CLKPR = _BV(CLKPS0); sei();  // 8 MHz
  Serial.begin(38400 * 2L);
  pinMode(9, OUTPUT);
  TCCR1A = _BV(COM1A1) | _BV(WGM11); TCCR1B = _BV(WGM13) | _BV(WGM12) | _BV(CS11);
  ICR1 = 19999; OCR1A = 1249;
}
void loop() { if (Serial.available()) Serial.write(Serial.read()); if (millis() >= 250) OCR1A = 1749; }
"""
    sketch = write_sketch(tmp_path, source)
    with Bench(sketch, "simavr", mcu="atmega328p", uarts="0 38400", wires="9 servo 1") as bench:
        bench.run(0.2)
        assert bench.one.get("pulse.s1") == pytest.approx(0.00125, abs=1e-6)
        bench.receive(0, b"hello")
        assert bench.run(0.2) == b"hello"
        bench.run(0.2)  # millis() counts half as fast
        assert bench.one.get("pulse.s1") == pytest.approx(0.00175, abs=1e-6)


@both
def test_a_switch_to_ground_is_seen_whatever_the_pull_up_does(tmp_path, backend):
    """ATmega2560 data sheet, 13.2: a pull-up has 20 to 50 kOhm; a closed switch wins."""
    source = """
void setup() {
  Serial.begin(115200);
  pinMode(22, INPUT_PULLUP); pinMode(23, INPUT_PULLUP); pinMode(24, OUTPUT); pinMode(25, INPUT_PULLUP);
}
void loop() {
  delay(20);
  digitalWrite(24, !digitalRead(24));  // the same port
  Serial.print(digitalRead(22)); Serial.print(digitalRead(23)); Serial.print(digitalRead(25)); Serial.print(' ');
}
"""
    wires = "22 input 1; 23 input 2; 24 output 1"
    with Bench(write_sketch(tmp_path, source), backend, wires=wires) as bench:
        bench.one.set("level.i2", True)
        assert set(bench.run(0.1).split()[1:]) == {b"011"}  # closed, open, nothing there
        bench.one.set("level.i1", True)
        bench.one.set("level.i2", False)
        assert set(bench.run(0.1).split()[1:]) == {b"101"}


@both
def test_a_magnetometer_tests_itself(tmp_path, backend):
    """HMC5883L, data sheet rev E, "self test": 1.16 Ga in x and y, 1.08 in z, at 390 counts a gauss."""
    source = """
#include <Wire.h>
void set(byte at, byte value) { Wire.beginTransmission(0x1E); Wire.write(at); Wire.write(value); Wire.endTransmission(); }
void show() {
  Wire.beginTransmission(0x1E); Wire.write(3); Wire.endTransmission();
  Wire.requestFrom(0x1E, 6);
  for (int i = 0; i < 3; i++) { int high = Wire.read(), all = high << 8 | Wire.read(); Serial.print(all); Serial.print(' '); }
}
void setup() {
  Serial.begin(115200); Wire.begin();
  set(1, 0xA0);
  const byte modes[] = {0x11, 0x12, 0x10};
  for (byte mode : modes) { set(0, mode); set(2, 1); delay(10); show(); }
}
void loop() {}
"""
    field = {"magnetic_field.north": 2e-5, "magnetic_field.east": 0.0, "magnetic_field.down": 1e-5}
    with Bench(write_sketch(tmp_path, source), backend, wires="0x1E hmc5883l", **field) as bench:
        said = [int(number) for number in bench.run(0.2).split()]
    assert said == [452, 421, 452, -452, -421, -452, 78, 39, 0]  # x, z, y


@pytest.mark.parametrize("mcu", ["atmega2560", "atmega328p"])
def test_i2c_by_its_registers(tmp_path, mcu):
    """Statuses of a master as the ATmega2560 data sheet has them in tables 24-2 and 24-3."""
    source = """
byte go(byte control) { TWCR = _BV(TWINT) | _BV(TWEN) | control; while (!(TWCR & _BV(TWINT))) {} return TWSR & 0xF8; }
byte send(byte data) { TWDR = data; return go(0); }
void say(byte status) { Serial.print(status, HEX); Serial.print(' '); }
void stop() { TWCR = _BV(TWINT) | _BV(TWEN) | _BV(TWSTO); while (TWCR & _BV(TWSTO)) {} }
void setup() {
  Serial.begin(115200);
  TWBR = 12;
  say(go(_BV(TWSTA))); say(send(0x68 << 1)); say(send(0x75));
  say(go(_BV(TWSTA))); say(send(0x68 << 1 | 1)); say(go(_BV(TWEA))); say(TWDR); say(go(0)); stop();
  say(go(_BV(TWSTA))); say(send(0x11 << 1)); stop();
  say(go(_BV(TWSTA))); say(send(0x11 << 1 | 1)); stop();
}
void loop() {}
"""
    with Bench(write_sketch(tmp_path, source), "simavr", mcu=mcu, wires="0x68 mpu6050") as bench:
        assert bench.run(0.1).decode().split() == (
            ["8", "18", "28", "10", "40", "50", "68", "58", "8", "20", "8", "48"]
        )


@both
def test_wire_tells_an_absent_device_from_a_deaf_one(tmp_path, backend):
    """Arduino's reference of Wire: 2 is a NACK of the address."""
    source = """
#include <Wire.h>
byte ask(byte at) { Wire.beginTransmission(at); Wire.write(0); return Wire.endTransmission(); }
void setup() { Serial.begin(115200); Wire.begin(); Serial.print(ask(0x68)); Serial.print(ask(0x69)); }
void loop() {}
"""
    with Bench(write_sketch(tmp_path, source), backend, wires="0x68 mpu6050") as bench:
        assert bench.run(0.1) == b"02"


@pytest.mark.parametrize(("mcu", "uart", "pin"), [("atmega2560", 1, 19), ("atmega328p", 0, 0)])
def test_bits_of_a_line_are_at_the_pin_of_its_uart(tmp_path, mcu, uart, pin):
    """A start bit and the six zeros of '@' last 7 bits; the line is high at rest (RS-232's mark)."""
    source = f"""
void setup() {{
  Serial.begin(9600);
  int rest = digitalRead({pin});
  long width = pulseIn({pin}, LOW, 2000000);
  Serial.print(rest); Serial.print(' '); Serial.print(width);
}}
void loop() {{}}
"""
    rates = "; ".join(f"{each} 9600" for each in range(uart + 1))
    with Bench(write_sketch(tmp_path, source), "simavr", mcu=mcu, uarts=rates) as bench:
        bench.run(0.5)
        bench.receive(uart, b"@")
        rest, width = bench.run(0.2).split()
    assert rest == b"1"
    assert int(width) == pytest.approx(7 / 9600 * 1e6, rel=0.01)


@both
def test_a_constructor_that_reads_before_the_adc_is_on_goes_on(tmp_path, backend):
    source = """
struct Knob { int first; Knob() { first = analogRead(A0); } } knob;
void setup() { Serial.begin(115200); Serial.print(analogRead(A0)); }
void loop() {}
"""
    sketch = write_sketch(tmp_path, source)
    with Bench(sketch, backend, wires="A0 voltage 1", patience=0.1) as bench:
        bench.one.set("voltage.v1", 2.5)
        assert bench.run(0.2) == b"512"


@both
def test_every_analogue_channel_has_its_voltage(tmp_path, backend):
    """ATmega2560 data sheet, 26.7: ADC = V 1024 / Vref."""
    source = """
const byte pins[] = {A0, A7, A8, A15};
void setup() { Serial.begin(115200); for (byte at : pins) { Serial.print(analogRead(at)); Serial.print(' '); } }
void loop() {}
"""
    wires = "A0 voltage 1; A7 voltage 2; A8 voltage 3; A15 voltage 4"
    with Bench(write_sketch(tmp_path, source), backend, wires=wires) as bench:
        for number, volts in enumerate((1.0, 2.5, 3.3, 5.0), 1):
            bench.one.set(f"voltage.v{number}", volts)
        assert bench.run(0.1).split() == [b"204", b"512", b"675", b"1023"]


@pytest.mark.parametrize("mcu", ["atmega2560", "atmega328p"])
def test_voltages_against_the_internal_reference_and_the_band_gap_against_the_supply(tmp_path, mcu):
    """1.1 V, both: what an input of 0.5 V counts, and how a sketch measures its own 5 V."""
    source = """
void setup() {
  Serial.begin(115200);
#ifdef INTERNAL1V1
  analogReference(INTERNAL1V1); Serial.print(analogRead(A1)); Serial.print(' ');
  ADMUX = _BV(REFS0) | 0x1E;
#else
  analogReference(INTERNAL); Serial.print(analogRead(A1)); Serial.print(' ');
  ADMUX = _BV(REFS0) | 0x0E;
#endif
  delay(2);
  ADCSRA |= _BV(ADSC);
  while (ADCSRA & _BV(ADSC)) {}
  Serial.print(ADC);
}
void loop() {}
"""
    with Bench(write_sketch(tmp_path, source), "simavr", mcu=mcu, wires="A1 voltage 1") as bench:
        bench.one.set("voltage.v1", 0.5)
        counted, gap = map(int, bench.run(0.1).split())
    assert counted == 465  # 0.5 / 1.1 * 1024
    assert gap == pytest.approx(1.1 / 5.0 * 1024, abs=1)


@both
def test_modulation_that_is_switched_off_is_none(tmp_path, backend):
    source = """
void setup() { pinMode(7, OUTPUT); analogWrite(7, 128); }
void loop() { if (millis() > 100) analogWrite(7, 0); }
"""
    with Bench(write_sketch(tmp_path, source), backend, wires="7 pwm 1") as bench:
        bench.run(0.08)
        assert bench.one.get("duty.p1") == pytest.approx(128 / 255, abs=0.005)
        bench.run(0.1)
        assert bench.one.get("duty.p1") == 0.0


@pytest.mark.parametrize(("use", "says"), [("= 1", "writes to"), ("+ 0", "reads from")])
def test_a_pointer_to_nowhere_ends_it_with_its_address_and_line(tmp_path, use, says):
    source = (
        f"void setup() {{}}\nvoid loop() {{\n  delay(5);\n  *(volatile byte *)0x9000 {use};\n}}\n"
    )
    with (
        Bench(write_sketch(tmp_path, source), "simavr") as bench,
        pytest.raises(SimulationError, match=rf"{says} address 0x9000, .*one\.ino:[345]"),
    ):
        bench.run(0.1)


@both
@pytest.mark.parametrize(
    ("mcu", "which", "volts"),
    [
        ("atmega2560", "INTERNAL2V56", 2.56),
        ("atmega2560", "INTERNAL1V1", 1.1),
        ("atmega328p", "INTERNAL", 1.1),
    ],
)
def test_an_internal_reference_is_that_of_the_board(tmp_path, backend, mcu, which, volts):
    source = f"""
void setup() {{
  Serial.begin(115200); analogReference({which}); Serial.print(analogRead(A2));
  analogReference(DEFAULT); Serial.print(' '); Serial.print(analogRead(A2));
}}
void loop() {{}}
"""
    with Bench(write_sketch(tmp_path, source), backend, mcu=mcu, wires="A2 voltage 1") as bench:
        bench.one.set("voltage.v1", 0.7)
        counted = [int(word) for word in bench.run(0.1).split()]
    assert counted == [int(0.7 / volts * 1024), int(0.7 / 5.0 * 1024)]
