"""Projects of PlatformIO, as they are."""

import pytest

from seatrial.errors import InputError
from seatrial_kits.arduino.component import Arduino
from seatrial_kits.arduino.sources.platformio import read_project
from tests.command import seatrial

from .bench import Bench, need

BACKENDS = ("host", "simavr")
INI = """
[platformio]
default_envs = mega
src_dir = firmware

[common]
rate = 115200
flags = -D RATE=${common.rate} -I shared

[env]
framework = arduino
build_flags = ${common.flags} -DGAIN=3 -Os -Wall

[env:mega]
platform = atmelavr
board = megaatmega2560
lib_extra_dirs = shelf

[env:uno]
extends = env:mega
board = uno
build_flags = ${env:mega.build_flags} -DUNO   ; more

[env:esp]
platform = espressif32 @ 6.5.0
board = esp32-p4
lib_deps =
  knolleary/PubSubClient @ ^2.8
  bblanchon/ArduinoJson
"""
MAIN = """
#include <Arduino.h>
#include "config.h"
#include "deep/twice.h"
#include <Helm.h>
#include <Trim.h>
void setup() { Serial.begin(RATE); Serial.print(helm(GAIN)); Serial.print(' '); Serial.print(twice(TRIM + ONE)); Serial.print(' ');
#ifdef UNO
  Serial.print("uno");
#else
  Serial.print("mega");
#endif
}
void loop() {}
"""


@pytest.fixture
def project(tmp_path):
    """A project with folders of all kinds."""
    place = tmp_path / "boat"
    for name, text in {
        "platformio.ini": INI,
        "firmware/main.cpp": MAIN,
        "firmware/deep/twice.cpp": '#include "twice.h"\nint twice(int x) { return 2 * x; }\n',
        "firmware/deep/twice.h": "int twice(int x);\n",
        "include/config.h": "#define ONE 1\n",
        "lib/Helm/src/Helm.h": "int helm(int g);\n",
        "lib/Helm/src/Helm.cpp": '#include "Helm.h"\nint helm(int g) { return 10 * g; }\n',
        "shelf/Trim/Trim.h": '#include "trim_value.h"\n',
        "shared/trim_value.h": "#define TRIM 4\n",
    }.items():
        file = place / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, "utf-8")
    return place


@pytest.mark.interop
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("environment", "board"), [("", b"mega"), ("uno", b"uno")])
def test_a_project_runs_as_it_is(project, backend, environment, board):
    with Bench(project, backend, environment=environment) as bench:
        assert bench.run(0.1) == b"30 10 " + board


def test_values_come_from_what_is_extended_and_referred_to(project):
    read = read_project(project / "platformio.ini", "uno")
    assert (read.board, read.mcu, read.environment) == ("uno", "atmega328p", "uno")
    assert read.flags == ("-DRATE=115200", "-DGAIN=3", "-Wall", "-DUNO")
    assert read.ignored == ("-Os",)
    assert [each.name for each in read.headers] == ["include", "shared"]
    assert [each.name for each in read.shelves] == ["lib", "shelf"]
    assert read_project(project / "platformio.ini").environment == "mega"
    assert read_project(project / "platformio.ini", "esp").needs == (
        "knolleary/PubSubClient @ ^2.8",
        "bblanchon/ArduinoJson",
    )


@pytest.mark.interop
def test_check_names_environment_board_and_flags(project):
    need("host")
    done = seatrial("sketch", "check", str(project), "--environment", "uno", cwd=project)
    assert done.returncode == 0, done.stderr
    assert "on the Uno (atmega328p)" in done.stdout
    assert "environment uno, board uno" in done.stdout
    assert "flag that changes nothing here: -Os" in done.stdout


def test_a_board_that_is_not_there_is_named(project):
    done = seatrial("sketch", "check", str(project), "--environment", "esp", cwd=project)
    assert done.returncode == 2
    assert "the board of [env:esp] is esp32-p4 (ESP32): uno, " in done.stderr


@pytest.mark.parametrize(
    ("text", "environment", "expected"),
    [
        (INI, "mgea", r"environment 'mgea'.*mega"),
        (INI.replace("default_envs = mega", ""), "", r"which of the environments mega, uno, esp\?"),
        (INI.replace("default_envs = mega", "default_envs = boat"), "", r"default_envs: .*'boat'"),
        (INI.replace("-Os", "--magic"), "", r"build_flags: '--magic' is not known here"),
        (INI.replace("-Os", "'"), "", r"build_flags: No closing quotation"),
        (INI.replace("rate = 115200", "rate = ${common.flags}"), "", r"circle of references"),
        (INI.replace("board = megaatmega2560", ""), "", r"\[env:mega\] names no board"),
        ("[env\n", "", r"platformio\.ini: cannot be read"),
        ("", "", r"has no environment \[env:NAME\]"),
    ],
)
def test_mistakes_are_named(project, text, environment, expected):
    (project / "platformio.ini").write_text(text, "utf-8")
    with pytest.raises(InputError, match=expected):
        read_project(project / "platformio.ini", environment)


def test_another_microcontroller_than_the_projects_is_refused(project):
    with pytest.raises(InputError, match="megaatmega2560, of atmega2560, and mcu is atmega328p"):
        Bench(project, mcu="atmega328p")


@pytest.mark.parametrize(("key", "value"), [("network", "127.0.0.2"), ("flash_after", "kept")])
def test_what_an_esp32_alone_has_is_refused_of_another_board(key, value):
    board = Arduino("it")
    board.set(key, value)
    with pytest.raises(
        InputError, match=rf"^it: {key}: '{value}' is for an ESP32 .* the Mega in host$"
    ):
        board.initialise()
