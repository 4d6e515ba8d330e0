"""seatrial sketch."""

import os
import subprocess
import sys

import pytest
import serial

from seatrial.shipped import shipped_folder
from tests.command import seatrial
from tests.kits.arduino.bench import need, write_sketch

MAIN = "from seatrial.cli import main; main()"
GLORIA = shipped_folder("harness") / "kits/arduino/firmware" / "gloria_autopilot"


def test_check_says_what_it_is_made_of(tmp_path):
    done = seatrial("sketch", "check", str(GLORIA), "--profile", "gloria:mega", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for text in ("Mega (atmega2560)", "pin 9: servo 1", "0x68: mpu6050", "an overflow of 16 bits"):
        assert text in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("void setup() {\n  DDRB = 1;\n}\nvoid loop() {}\n", "one.ino:2: DDRB is a register"),
        (
            "void setup() {\n  Serial3.begin(9600);\n}\nvoid loop() {}\n",
            "one.ino:2: this board has no",
        ),
    ],
)
def test_check_refuses(tmp_path, source, expected):
    sketch = write_sketch(tmp_path, source)
    done = seatrial("sketch", "check", str(sketch), "--mcu", "atmega328p", cwd=tmp_path)
    assert done.returncode == 2
    assert expected in done.stderr


@pytest.mark.slow
def test_check_counts_registers_and_leaves_them_to_the_emulator(tmp_path):
    source = "void setup() {\n  DDRB = 1;\n  DDRB = 2; DDRB = 4;\n  cli();\n}\nvoid loop() {}\n"
    sketch = str(write_sketch(tmp_path, source))
    done = seatrial("sketch", "check", sketch, cwd=tmp_path)
    assert done.returncode == 2
    assert "one.ino:2: DDRB is a register" in done.stderr
    assert done.stderr.count("DDRB") == 1
    assert "(and 2 more)" in done.stderr
    done = seatrial("sketch", "check", sketch, "--backend", "simavr", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "nothing is unsupported" in done.stdout
    done = seatrial("sketch", "check", sketch, "--backend", "avr", cwd=tmp_path)
    assert "back end 'avr': 'host' or 'simavr' is needed" in done.stderr


def test_check_names_pins_that_have_no_line(tmp_path):
    source = "#include <SoftwareSerial.h>\nSoftwareSerial gps(4, 3);\nvoid setup() { gps.begin(9600); }\nvoid loop() {}\n"
    sketch = write_sketch(tmp_path, source)
    done = seatrial("sketch", "check", str(sketch), "--profile", "gloria:mega", cwd=tmp_path)
    assert done.returncode == 2
    assert (
        "one.ino:2: the profile has no line at pins 4 and 3: wires of '4 soft_rx 1" in done.stderr
    )


@pytest.mark.interop
def test_build_and_run(tmp_path):
    need("host")
    sketch = write_sketch(tmp_path, "void setup() { Serial.begin(9600); }\nvoid loop() {}\n")
    built = seatrial("sketch", "build", str(sketch), cwd=tmp_path)
    assert os.access(built.stdout.strip(), os.X_OK)
    run = seatrial("sketch", "run", str(sketch), "--seconds", "0.1", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert "UART 0: /dev/pts/" in run.stdout


def test_whoever_opens_the_terminal_of_a_uart_talks_with_the_sketch(tmp_path):
    need("host")
    source = """
      void setup() { Serial1.begin(38400); }
      void loop() { if (Serial1.available()) Serial1.write(Serial1.read() + 1); }
    """
    command = [sys.executable, "-c", MAIN, "sketch", "run", str(write_sketch(tmp_path, source))]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as run:
        try:
            line = run.stdout.readline()
            assert line.startswith("UART 1: /dev/pts/")
            with serial.Serial(line.split()[-1], 38400, timeout=30) as port:
                port.write(b"GKKN")
                assert port.read(4) == b"HLLO"
        finally:
            run.kill()


@pytest.mark.interop
def test_libraries_and_flags_are_the_profiles_or_the_commands(tmp_path):
    need("host")
    library = tmp_path / "shelf" / "Depth"
    library.mkdir(parents=True)
    (library / "Depth.h").write_text("inline int depth() { return GIVEN; }\n")
    source = "#include <Depth.h>\nvoid setup() { Serial.begin(115200); Serial.print(depth()); }\nvoid loop() {}\n"
    sketch = str(write_sketch(tmp_path, source))
    given = ("--libraries", "../shelf", "--flags", "-DGIVEN=3")
    for arguments in (("check", sketch), ("build", sketch), ("run", sketch, "--seconds", "0.1")):
        assert seatrial("sketch", *arguments, cwd=tmp_path).returncode == 2
        done = seatrial("sketch", *arguments, *given, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    (tmp_path / "hil_profiles").mkdir()
    (tmp_path / "hil_profiles" / "mine.toml").write_text(
        'title = "mine"\n[links.mega]\nkind = "arduino"\nlibraries = "../shelf"\nflags = "-DGIVEN=3"\n'
    )
    done = seatrial("sketch", "build", sketch, "--profile", "mine:mega", cwd=tmp_path)
    assert done.returncode == 0, done.stderr


NEW = {
    "harness/firmware/my-helm_2/my-helm_2.ino",
    "harness/rigs/autopilots/my-helm_2.toml",
    "harness/trials/my-helm_2.toml",
    "hil_profiles/my-helm_2.toml",
}


@pytest.mark.slow
def test_new_writes_what_runs_at_once(tmp_path):
    need("host")
    done = seatrial("sketch", "new", "my-helm_2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    written = {p.relative_to(tmp_path).as_posix(): p for p in tmp_path.rglob("*") if p.is_file()}
    assert written.keys() == NEW
    assert all(f"\n  {path}\n" in done.stdout for path in written)
    assert not any("@" in path.read_text() for path in written.values())
    steps = [
        line.split("  ")[1] for line in done.stdout.splitlines() if line.startswith("  seatrial")
    ]
    run, _, check, terminals, describe = (step.removeprefix("seatrial ").split() for step in steps)
    short = ("--set", "stop=21 s", "--engine", "direct", "--out", "out")
    for command in ([*run, *short], check, [*terminals, "--seconds", "0.1"], describe):
        done = seatrial(*command, cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
    assert seatrial("profile", "check", "my-helm_2", cwd=tmp_path).returncode == 0
    again = seatrial("sketch", "new", "my-helm_2", cwd=tmp_path)
    assert again.returncode == 2
    assert "nothing is written, for there is already" in again.stderr


@pytest.mark.long
@pytest.mark.interop
def test_the_firmware_of_new_and_another_vehicle(tmp_path):
    need("simavr")
    assert seatrial("sketch", "new", "helm", cwd=tmp_path).returncode == 0
    for given in (["--set", "autopilot.mega.backend=simavr"], ["--vehicle", "otter"]):
        done = seatrial(
            "run", "helm", *given, "--set", "stop=21 s", "--out", given[-1], cwd=tmp_path
        )
        assert done.returncode == 0, done.stdout + done.stderr
