"""Projects of PlatformIO: board, flags and folders of an environment of platformio.ini."""

from __future__ import annotations

import configparser
import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from seatrial.errors import InputError, unknown

FILE = "platformio.ini"
BOARDS = {
    **dict.fromkeys(
        ("uno", "nanoatmega328", "nanoatmega328new", "pro16MHzatmega328", "ATmega328P",
         "diecimilaatmega328", "fio", "miniatmega328", "ethernet", "bluno"),
        "atmega328p",
    ),
    **dict.fromkeys(("megaatmega2560", "megaADK", "ATmega2560", "blueromega2560"), "atmega2560"),
    **dict.fromkeys(
        ("esp32dev", "esp32doit-devkit-v1", "esp32doit-espduino", "nodemcu-32s", "lolin32",
         "lolin_d32", "lolin_d32_pro", "wemos_d1_mini32", "az-delivery-devkit-v4", "esp-wrover-kit",
         "esp32cam", "featheresp32", "ttgo-t-beam", "ttgo-lora32-v1", "ttgo-lora32-v2",
         "ttgo-lora32-v21", "heltec_wifi_lora_32", "heltec_wifi_lora_32_V2", "m5stack-core-esp32",
         "m5stick-c", "pico32", "firebeetle32", "denky32", "upesy_wroom", "mhetesp32devkit"),
        "esp32",
    ),
    **dict.fromkeys(
        ("esp32-s3-devkitc-1", "esp32s3box", "lolin_s3", "adafruit_feather_esp32s3",
         "seeed_xiao_esp32s3", "heltec_wifi_lora_32_V3"),
        "esp32s3",
    ),
    **dict.fromkeys(
        ("esp32-c3-devkitm-1", "esp32-c3-devkitc-02", "lolin_c3_mini", "seeed_xiao_esp32c3"),
        "esp32c3",
    ),
}  # fmt: skip
"""Microcontrollers that this kit has, by PlatformIO's names of boards."""
_FAMILIES = {
    "espressif32": "ESP32",
    "espressif8266": "ESP8266",
    "teensy": "Teensy",
    "atmelsam": "SAMD",
    "ststm32": "STM32",
    "raspberrypi": "RP2040",
    "nordicnrf52": "nRF52",
}
DEFAULT_MCU = "atmega2560"
_REFERENCE = re.compile(r"\$\{([\w:.-]+)\.([\w-]+)\}")
_DEPTH = 20
_TAKEN = ("-D", "-U", "-f", "-std=", "-W")
_IGNORED = ("-O", "-g", "-l", "-L", "-Wl,", "-m", "-v", "-pipe")
_WITH_VALUE = ("-D", "-U", "-I", "-L", "-l")


@dataclass(frozen=True)
class Project:
    """An environment of a project: folders are absolute, and there or not."""

    folder: Path
    environment: str
    board: str
    mcu: str
    """A microcontroller of `mcus`; '' for a board that is another."""
    family: str
    sources: Path
    headers: tuple[Path, ...]
    """Folders of headers: ``include`` and those of ``-I``."""
    shelves: tuple[Path, ...]
    """Folders of libraries."""
    flags: tuple[str, ...]
    ignored: tuple[str, ...]
    """Flags that change nothing here: of optimisation and of the linker."""
    needs: tuple[str, ...]
    """Libraries that ``lib_deps`` names."""


def project_of(place: Path) -> Path | None:
    """Return the ``platformio.ini`` of a folder, or the file itself; None if there is none."""
    file = place if place.name == FILE else place / FILE
    return file.resolve() if file.is_file() else None


def read_project(file: Path, environment: str = "") -> Project:
    """Return an environment: the one named, the first of ``default_envs``, or the only one.

    Raises InputError for a file that cannot be read, an environment that is not there, several of
    which none is chosen, and flags that are not known.
    """
    values = _Values(file)
    name = values.chosen(environment)
    folder, section = file.parent, f"env:{name}"
    board = values.get(section, "board")
    if not board:
        raise InputError(f"{file}: [{section}] names no board")
    platform = values.get(section, "platform").split("@")[0].split("/")[-1]
    family = next((f for key, f in _FAMILIES.items() if platform.startswith(key)), platform)
    flags, includes, ignored = _flags(file, section, values.get(section, "build_flags"))
    dropped = set(shlex.split(values.get(section, "build_unflags")))
    shelves = [
        folder / (values.get("platformio", "lib_dir") or "lib"),
        folder / (values.get("platformio", "libdeps_dir") or ".pio/libdeps") / name,
        *(
            folder / Path(each).expanduser()
            for each in _listed(values.get(section, "lib_extra_dirs"))
        ),
    ]
    headers = [values.get("platformio", "include_dir") or "include", *includes]
    return Project(
        folder=folder,
        environment=name,
        board=board,
        mcu=BOARDS.get(board, ""),
        family=family,
        sources=folder / (values.get("platformio", "src_dir") or "src"),
        headers=tuple(f for each in headers if (f := (folder / each).resolve()).is_dir()),
        shelves=tuple(shelf.resolve() for shelf in shelves if shelf.is_dir()),
        flags=tuple(flag for flag in flags if flag not in dropped),
        ignored=tuple(ignored),
        needs=tuple(_listed(values.get(section, "lib_deps"))),
    )


def project_mcu(project: Project, given: str) -> str:
    """Return the microcontroller of a project's board.

    Raises InputError for a board that is not there, and if another one was ``given``.
    """
    where = f"{project.folder / FILE}: the board of [env:{project.environment}] is {project.board}"
    if not project.mcu:
        family = f" ({project.family})" if project.family else ""
        raise InputError(f"{where}{family}: {', '.join(BOARDS)} are there")
    if given not in (DEFAULT_MCU, project.mcu):
        raise InputError(f"{where}, of {project.mcu}, and mcu is {given}: leave mcu out")
    return project.mcu


class _Values:
    """Values of the file, with what environments extend and refer to."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self._parser = configparser.ConfigParser(
            interpolation=None, strict=False, inline_comment_prefixes=(" ;", "\t;")
        )
        try:
            self._parser.read_string(file.read_text(encoding="utf-8-sig"), source=str(file))
        except (OSError, UnicodeDecodeError, configparser.Error) as error:
            raise InputError(f"{file}: cannot be read: {error}") from None

    def chosen(self, wanted: str) -> str:
        there = [each[4:] for each in self._parser.sections() if each.startswith("env:")]
        if wanted:
            if wanted not in there:
                raise InputError(f"{self.file}: {unknown('environment', wanted, there)}")
            return wanted
        default = _listed(self.get("platformio", "default_envs"))
        if default and default[0] not in there:
            raise InputError(
                f"{self.file}: default_envs: {unknown('environment', default[0], there)}"
            )
        if not default and len(there) != 1:
            raise InputError(
                f"{self.file}: which of the environments {', '.join(there)}? Name one with "
                "'environment'" if there else f"{self.file} has no environment [env:NAME]"
            )  # fmt: skip
        return default[0] if default else there[0]

    def get(self, section: str, key: str, depth: int = 0) -> str:
        """Return a value, '' if there is none."""
        if depth > _DEPTH:
            raise InputError(f"{self.file}: [{section}] {key}: a circle of references")
        text = self._own(section, key, depth)
        return _REFERENCE.sub(
            lambda match: self.get(
                section if match[1] == "this" else match[1], match[2], depth + 1
            ),
            text,
        ).strip()

    def _own(self, section: str, key: str, depth: int) -> str:
        if not self._parser.has_section(section):
            return ""
        if self._parser.has_option(section, key):
            return self._parser.get(section, key) or ""
        for other in _listed(self._parser.get(section, "extends", fallback="")):
            if found := self.get(other, key, depth + 1):
                return found
        return self.get("env", key, depth + 1) if section.startswith("env:") else ""


def _listed(text: str) -> list[str]:
    return [each.strip() for each in re.split(r"[\n,]", text) if each.strip()]


def _flags(file: Path, section: str, text: str) -> tuple[list[str], list[str], list[str]]:
    """Return flags of the compiler, folders of headers, and flags that change nothing here."""
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise InputError(f"{file}: [{section}] build_flags: {error}") from None
    flags: list[str] = []
    includes: list[str] = []
    ignored: list[str] = []
    while words:
        word = words.pop(0)
        if word in _WITH_VALUE and words:
            word += words.pop(0)
        if word.startswith("-I"):
            includes.append(word[2:])
        elif word.startswith(_IGNORED):
            ignored.append(word)
        elif word.startswith(_TAKEN):
            flags.append(word)
        else:
            known = ", ".join([*_TAKEN, "-I", *_IGNORED])
            raise InputError(
                f"{file}: [{section}] build_flags: {word!r} is not known here: {known} are"
            )
    return flags, includes, ignored
