"""simavr: a user's own firmware, and microcontrollers that come and go."""

import os
import subprocess
from pathlib import Path

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial_kits.arduino.component import Arduino
from seatrial_kits.arduino.emulator import build_firmware
from seatrial_kits.arduino.mcus import MCUS
from seatrial_kits.arduino.sources.sketch import find_sketch

from .bench import Bench, need, write_sketch

pytestmark = pytest.mark.interop

SOURCE = (
    "void setup() { Serial.begin(9600); }\nvoid loop() { Serial.println(millis()); delay(50); }\n"
)


@pytest.mark.parametrize("mcu", ["atmega2560", "atmega328p"])
def test_a_hex_file_runs_as_its_elf(tmp_path, mcu):
    need("simavr")
    sketch = write_sketch(tmp_path, SOURCE)
    elf = build_firmware(find_sketch(sketch), MCUS[mcu])
    hexadecimal = tmp_path / "one.hex"
    subprocess.run(["avr-objcopy", "-O", "ihex", elf, hexadecimal], check=True)
    sent = []
    for values in ({}, {"firmware": str(elf)}, {"firmware": str(hexadecimal)}):
        with Bench(sketch, "simavr", mcu=mcu, uarts="0 9600", **values) as bench:
            bench.run(0.3)
            sent.append(bench.stamps)
    assert sent[0] == sent[1] == sent[2]
    assert sent[0][0][2].startswith(b"0\r\n")


def test_registers_and_interrupts_of_the_hardware_work(tmp_path):
    source = """
volatile unsigned int ticks = 0;
ISR(TIMER1_COMPA_vect) { ticks++; }
void setup() {
  Serial.begin(9600);
  TCCR1A = 0; TCCR1B = _BV(WGM12) | _BV(CS11) | _BV(CS10);  // 250 kHz, clear on compare
  OCR1A = 2499; TIMSK1 = _BV(OCIE1A);                       // 100 Hz
}
void loop() { delay(500); Serial.println(ticks); }
"""
    with Bench(write_sketch(tmp_path, source), "simavr", uarts="0 9600") as bench:
        sent = bench.run(1.1).split()
    assert [int(each) for each in sent] == pytest.approx([50, 100], abs=1)


def children():
    """Return the processes that this one has begun, those that nobody has waited for too."""
    return Path(f"/proc/self/task/{os.getpid()}/children").read_text("ascii").split()


def test_boards_come_and_go_without_a_trace(tmp_path):
    sketch = write_sketch(tmp_path, SOURCE)
    with Bench(sketch, "simavr", uarts="0 9600") as bench:
        bench.run(0.02)
    before = len(os.listdir("/proc/self/fd")), children()
    for _ in range(200):
        with Bench(sketch, "simavr", uarts="0 9600") as bench:
            bench.run(0.02)
    assert (len(os.listdir("/proc/self/fd")), children()) == before


def test_what_is_no_firmware_is_refused(tmp_path):
    need("simavr")
    board = Arduino("mega")
    board.set("backend", "simavr")
    board.set("firmware", str(tmp_path / "one.bin"))
    with pytest.raises(InputError, match=r"neither a \.hex nor a \.elf"):
        board.initialise()
    (tmp_path / "one.hex").write_text("this is none\n")
    board.set("firmware", str(tmp_path / "one.hex"))
    board.initialise()
    board.begin()
    os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOWAIT)  # what it says must outlive its program
    with pytest.raises(SimulationError, match="cannot load the firmware"):
        board.advance(0.0, 0.02)
    board.close()
