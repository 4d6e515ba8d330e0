"""Pins, UARTs, I2C, ADC and timers as the data sheets have them."""

import math

import pytest

from seatrial.errors import SimulationError

from .bench import Bench, write_sketch

pytestmark = pytest.mark.interop

both = pytest.mark.parametrize("backend", ["host", "simavr"])


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


@pytest.mark.long
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


def test_without_a_field_there_is_the_earths_at_home(tmp_path):
    """WMM2025 at 42.283 N 71.35 W, 1000 m, 4 July 2028: 20139, -4905, 46532 nT (MathWorks)."""
    source = """
#include <Wire.h>
int two() { byte high = Wire.read(); return (int)(high << 8 | Wire.read()); }
void setup() {
  Serial.begin(115200); Wire.begin();
  Wire.beginTransmission(0x1E); Wire.write(2); Wire.write(0); Wire.endTransmission();
  delay(100);
  Wire.beginTransmission(0x1E); Wire.write(3); Wire.endTransmission();
  Wire.requestFrom(0x1E, 6);
  for (int i = 0; i < 3; i++) { Serial.print(two()); Serial.print(' '); }
}
void loop() {}
"""
    place = {"latitude": math.radians(42.283), "longitude": math.radians(-71.35)}
    home = {**place, "altitude": 1000.0, "date": "2028-07-04"}
    with Bench(write_sketch(tmp_path, source), "host", wires="0x1E hmc5883l", **home) as bench:
        said = [int(number) for number in bench.run(0.3).split()]
    counts = [each * 1e-5 * 1090 for each in (20139, 46532, -4905)]  # x, z, y; 1090 per gauss
    assert said == pytest.approx(counts, abs=1.0)


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
