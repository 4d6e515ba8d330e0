"""Sketches made from seeds, as the differential test of the two back ends runs them.

A sketch is a list of cases, each a function in its own slot of time: what one prints and does at pins
is compared with its own beginning, whatever the code before it cost.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random

SLOT_MS = 80
PINS = (22, 23, 24, 25)
"""Watched outputs."""
LEVELS = {30: True, 31: False}
VOLTS = {"A0": 0.8, "A1": 2.5, "A2": 4.2}
WAVE_HZ = 200.0
"""Of the square wave at pin 2."""
WIRES = (
    "22 output 1; 23 output 2; 24 output 3; 25 step 1; 30 input 1; 31 input 2; A0 voltage 1; "
    "A1 voltage 2; A2 voltage 3; 2 anemometer 1; 6 pwm 1; 0x68 mpu6050; 33 receiver 1"
)

_TYPES = {"int": 15, "unsigned int": 16, "long": 31, "unsigned long": 32, "byte": 8, "int8_t": 7}
_HEAD = """#include <EEPROM.h>
#include <Wire.h>
#include <util/atomic.h>
volatile unsigned int edges;
void counted() { edges++; }
template <typename T> void say(T value) { Serial.print(value); Serial.print(' '); }
void near(long value) { Serial.print('~'); Serial.print(value); Serial.print(' '); }
"""


def sketch(seed: int, cases: int) -> str:
    """Return the source of a sketch with the cases ``seed`` to ``seed + cases - 1``."""
    functions = [f"void case{n}() {{\n{_case(Random(seed + n))}}}\n" for n in range(cases)]
    calls = "\n".join(
        f"  while (millis() < {SLOT_MS * (n + 1)}UL) {{}}\n"
        f'  Serial.print("\\n#{n} "); case{n}(); Serial.flush();'
        for n in range(cases)
    )
    setup = "Serial.begin(115200); Serial1.begin(38400); Wire.begin();"
    setup += "".join(f" pinMode({pin}, OUTPUT);" for pin in PINS)
    return f"{_HEAD}{''.join(functions)}void setup() {{\n  {setup}\n{calls}\n}}\nvoid loop() {{}}\n"


def _case(draw: Random) -> str:
    return "".join(draw.choice(_KINDS)(draw) for _ in range(draw.randint(1, 2)))


def _number(draw: Random, kind: str) -> str:
    bits = _TYPES[kind]
    value = draw.choice((0, 1, draw.getrandbits(bits), draw.getrandbits(bits // 2), 2**bits - 1))
    negative = kind in ("int", "long", "int8_t") and draw.random() < 0.4
    suffix = {"long": "L", "unsigned long": "UL", "unsigned int": "U"}.get(kind, "")
    return f"{'-' if negative else ''}{value}{suffix}"


def _arithmetic(draw: Random) -> str:
    """Products and sums are long, or stored at once: between stores the host has more bits."""
    lines = []
    for name in "abc":
        kind = draw.choice(list(_TYPES))
        lines.append(f"  volatile {kind} {name} = {_number(draw, kind)};")
    for _ in range(draw.randint(2, 6)):
        to, one, two = (draw.choice("abc") for _ in range(3))
        operation = draw.choice("+-*&|^")
        lines.append(
            draw.choice(
                (
                    f"  {to} = (long){one} {operation} {two};",
                    f"  {to} = {one} / (long)(({two} & 63) + 1);",
                    f"  {to} = {one} % (long)(({two} & 63) + 1);",
                    f"  {to} = {one} >> {draw.randint(0, 7)};",
                    f"  {to} {operation}= {two};",
                    f"  if ({one} < (long){two}) {to}++; else {to}--;",
                )
            )
        )
    return _block(*lines, "  say(a); say(b); say(c);")


def _printing(draw: Random) -> str:
    base = draw.choice(("DEC", "HEX", "BIN", "OCT"))
    real = draw.uniform(-1, 1) * 10 ** draw.randint(-2, 5)
    kind = draw.choice(("int", "long", "unsigned long"))
    return _block(
        f"  {kind} x = {_number(draw, kind)};",
        f"  Serial.print(x, {base}); Serial.print(' '); Serial.print({real:.6g}, {draw.randint(0, 5)});",
        f'  char text[40]; snprintf(text, sizeof text, "%{draw.choice(("5", "06", "-7", "+", ""))}d|%ld|%04X|%s", '
        f'{draw.randint(-999, 999)}, (long)x, {draw.randint(0, 65535)}u, "end");',
        "  Serial.print(' '); say(text);",
    )


def _strings(draw: Random) -> str:
    word = "".join(draw.choice("abcXYZ 0123,.-") for _ in range(draw.randint(3, 12))).strip() or "a"
    return _block(
        f'  String s = "{word}"; s += {draw.randint(-500, 500)};',
        f"  s.replace('{draw.choice('aX1,')}', '_'); s.{draw.choice(('toUpperCase', 'toLowerCase', 'trim'))}();",
        f"  say(s); say(s.length()); say(s.indexOf('{draw.choice('bY2.')}')); say(s.substring({draw.randint(0, 3)}));",
        f'  say(s.toInt()); say(s.startsWith("{word[:2]}")); say(s.charAt({draw.randint(0, 3)}));',
    )


def _pins(draw: Random) -> str:
    lines = ["  pinMode(30, INPUT); pinMode(31, INPUT_PULLUP); pinMode(32, INPUT_PULLUP);"]
    for _ in range(draw.randint(2, 8)):
        pin = draw.choice(PINS[:3])
        lines.append(
            draw.choice(
                (
                    f"  digitalWrite({pin}, {draw.choice(('HIGH', 'LOW'))});",
                    f"  digitalWrite({pin}, !digitalRead({pin}));",
                    f"  delayMicroseconds({draw.randint(100, 3000)});",
                    f"  delay({draw.randint(1, 3)});",
                    f"  say(digitalRead({draw.choice((30, 31, 32, pin))}));",
                    f"  pinMode(32, {draw.choice(('INPUT_PULLUP', 'OUTPUT'))}); say(digitalRead(32));",
                    f"  shiftOut({PINS[0]}, {PINS[1]}, {draw.choice(('LSBFIRST', 'MSBFIRST'))}, {draw.randint(0, 255)});",
                )
            )
        )
    return _block(*lines)


def _timers(draw: Random) -> str:
    wait = draw.choice(
        (f"delay({draw.randint(1, 20)})", f"delayMicroseconds({draw.randint(100, 9999)})")
    )
    return _block(
        "  unsigned long at = micros(), since = millis();",
        f"  {wait};",
        "  near(micros() - at); near((millis() - since) * 1000);",
        f"  while (micros() - at < {draw.randint(10000, 22000)}UL) {{}}",
        f"  digitalWrite({PINS[0]}, !digitalRead({PINS[0]}));",
    )


def _sound(draw: Random) -> str:
    lines = [
        f"  tone(25, {draw.randint(100, 3000)}, {draw.randint(2, 15)}); delay({draw.randint(3, 12)});"
    ]
    if draw.random() < 0.5:
        lines.append(f"  noTone(25); say(digitalRead(25)); delay({draw.randint(1, 5)});")
    return _block(*lines, "  noTone(25);")


def _modulation(draw: Random) -> str:
    return _block(f"  analogWrite(6, {draw.choice((0, 255, draw.randint(1, 254)))});")


def _analog(draw: Random) -> str:
    reference = draw.choice(("DEFAULT", "INTERNAL1V1", "INTERNAL2V56"))
    pins = draw.sample(sorted(VOLTS), 2)
    return _block(
        f"  analogReference({reference});",
        *(f"  say(analogRead({pin}));" for pin in pins),
        "  analogReference(DEFAULT); say(analogRead(A1));",
    )


def _interrupts(draw: Random) -> str:
    mode = draw.choice(("CHANGE", "RISING", "FALLING"))
    off = draw.choice(
        (
            "noInterrupts(); delayMicroseconds(900); interrupts();",
            "byte was = SREG; cli(); unsigned int n = edges; SREG = was; say(n < 9999);",
            "ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { delayMicroseconds(300); }",
            "",
        )
    )
    return _block(
        f"  edges = 0; attachInterrupt(digitalPinToInterrupt(2), counted, {mode});",
        f"  delay({draw.randint(5, 25)}); {off}",
        "  detachInterrupt(digitalPinToInterrupt(2)); near(edges * 1000L);",
    )


def _eeprom(draw: Random) -> str:
    at = draw.randint(0, 4000)
    return _block(
        f"  EEPROM.{draw.choice(('write', 'update'))}({at}, {draw.randint(0, 255)});",
        f"  long x = {_number(draw, 'long')}; EEPROM.put({at + 1}, x); long y; EEPROM.get({at + 1}, y);",
        f"  say(y); say(EEPROM.read({at})); say(EEPROM[{at + 7}]); say(EEPROM.length());",
    )


def _serial(draw: Random) -> str:
    text = "".join(draw.choice("abc123 -") for _ in range(draw.randint(1, 20)))
    return _block(
        f'  Serial1.print("{text}"); Serial1.print({draw.randint(-9999, 9999)});',
        f"  say(Serial1.available()); {draw.choice(('Serial1.flush();', ''))}",
        f"  Serial1.setTimeout({draw.randint(1, 4)}); say(Serial1.parseInt());",
    )


def _random(draw: Random) -> str:
    low = draw.randint(-100, 100)
    return _block(
        f"  randomSeed({draw.randint(1, 2**31)}UL); say(random({draw.randint(1, 10**6)}L));",
        f"  say(random({low}, {low + draw.randint(1, 5000)})); say(rand());",
        f"  say(map({draw.randint(0, 1023)}, 0, 1023, {low}, {-low + 1})); say(constrain({low}, -20, 30));",
    )


def _reals(draw: Random) -> str:
    a, b = (draw.uniform(-1, 1) * 10 ** draw.randint(-2, 3) for _ in range(2))
    return _block(
        f"  volatile float a = {a:.6g}, b = {b:.6g};",
        "  say(a + b); say(a * b); say((int)a); say((long)(a * 100)); say(a < b);",
        f"  Serial.print({draw.choice(('sqrt(fabs(a))', 'sin(a)', 'atan2(a, b)', 'fabs(b)'))}, 3); say(' ');",
    )


def _bus(draw: Random) -> str:
    address = draw.choice((0x68, 0x68, 0x1E, 0x40))
    register = draw.choice((0x75, 0x6B, 0x1B))
    return _block(
        f"  Wire.beginTransmission({address}); Wire.write({register}); say(Wire.endTransmission());",
        f"  say(Wire.requestFrom({address}, {draw.randint(1, 2)})); say(Wire.available()); say(Wire.read());",
    )


def _block(*lines: str) -> str:
    return "  {\n" + "\n".join(f"  {line}" for line in lines if line.strip()) + "\n  }\n"


_KINDS: tuple[Callable[[Random], str], ...] = (
    _arithmetic,
    _printing,
    _strings,
    _pins,
    _timers,
    _sound,
    _modulation,
    _analog,
    _interrupts,
    _eeprom,
    _serial,
    _random,
    _reals,
    _bus,
)
