"""simavr: firmware built from a sketch, and the program that emulates its board.

simavr is the system's and stays outside this process: it is under the GPL.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from seatrial.errors import InputError

from .build import include_folders, refuse, run, run_all, with_used_libraries
from .mcus import Mcu
from .resources import TEXTS, cached, contents, laid_out
from .sources.letter_case import with_other_cases
from .sources.libraries import ASSEMBLY, SOURCES
from .sources.sketch import Sketch
from .sources.unsupported import missing_headers
from .toolchain import arduino_core, need, version

_FLAGS = ("-Os", "-g", "-w", "-ffunction-sections", "-fdata-sections", "-DF_CPU=16000000L")
_PINS = ("pinMode", "digitalWrite", "digitalRead", "analogWrite")
"""Functions of the core that ``avr/pins.c`` stands before."""
_CXX = ("-std=gnu++11", "-fpermissive", "-fno-exceptions", "-fno-threadsafe-statics")


def build_emulator(mcu: Mcu) -> Path:
    """Return the program that emulates a board. Raises InputError if its tools are missing."""
    _need_avr(mcu)
    key = [version("g++"), TEXTS, contents([Path("/usr/include/simavr/sim_avr.h")])]

    def make(file: Path, scratch: Path) -> None:
        place = laid_out()
        includes = ["-I/usr/include/simavr", f"-I{place / 'shared'}"]
        source = str(place / "avr" / "emulated_board.c")
        run(["gcc", "-O2", *includes, source, "-lsimavr", "-lm", "-o", str(file)], "simavr's board")

    return cached("emulator", key, "", make)


def _need_avr(mcu: Mcu) -> None:
    """Raise InputError for a microcontroller that simavr has not, and for missing tools."""
    if mcu.family != "avr":
        raise InputError(
            f"the back end 'simavr' emulates AVR microcontrollers, not the {mcu.board}: "
            "the back end 'host' runs a sketch for it"
        )
    need("simavr")


def firmware_file(firmware: str) -> Path:
    """Return a user's own firmware. Raises InputError if it is none."""
    file = Path(firmware).expanduser()
    if file.suffix not in (".hex", ".elf"):
        raise InputError(f"firmware: {firmware!r} is neither a .hex nor a .elf file")
    if not file.is_file():
        raise InputError(f"firmware: there is no file {firmware}")
    return file.resolve()


def build_firmware(sketch: Sketch, mcu: Mcu) -> Path:
    """Return the ``.elf`` of a sketch, by avr-gcc with the Arduino core.

    Raises InputError for what the compiler finds, with the sketch's files and lines.
    """
    _need_avr(mcu)
    key = [mcu, version("avr-g++"), TEXTS, sketch.merged(), _FLAGS, sketch.flags]
    key.append(contents(sketch.files()))

    def make(file: Path, scratch: Path) -> None:
        bundled = _bundled_libraries()
        more = [*bundled, *(f / "utility" for f in bundled)]
        main = scratch / f"{sketch.name}.ino.cpp"
        includer = [f"-I{f}" for f in (*include_folders(sketch), *more)]
        cased = with_other_cases(sketch, [*_compiler(main, mcu, ()), *includer], scratch / "cases")
        command = [*_compiler(main, mcu, cased.flags), *includer]
        used = with_used_libraries(cased, command, main)
        refuse("simavr", sketch, missing_headers(used, command, main, "avr"), "avr")
        includes = [*include_folders(used), *more]
        pins = laid_out() / "avr" / "pins.c"
        theirs = [main, pins, *used.others, *used.library_sources()]
        objects = {scratch / f"{i}.o": f for i, f in enumerate(theirs)}
        run_all(
            [_compile(f, mcu, used.flags, includes, o) for o, f in objects.items()],
            sketch,
            mcu.family,
        )
        archives = [_bundled(mcu, sketch.flags), _core(mcu, sketch.flags)]
        link = ["avr-gcc", "-Os", "-Wl,--gc-sections", f"-mmcu={mcu.name}", "-o", str(file)]
        link += [f"-Wl,--wrap={name}" for name in _PINS]
        group = ["-Wl,--start-group", *map(str, archives), "-Wl,--end-group"]
        run([*link, *map(str, objects), *group, "-lm"], sketch.name)
        _check_memory(file, mcu, sketch.name)

    return cached(f"firmware-{sketch.name}", key, ".elf", make)


def _check_memory(elf: Path, mcu: Mcu, name: str) -> None:
    """Raise InputError if the variables of a firmware do not fit: the linker does not say."""
    done = subprocess.run(["avr-size", "-A", str(elf)], capture_output=True, text=True, check=True)
    sizes = dict(re.findall(r"^\.(data|bss|noinit)\s+(\d+)", done.stdout, re.MULTILINE))
    if (used := sum(map(int, sizes.values()))) >= mcu.ram:
        raise InputError(
            f"{name} does not fit: its variables take {used} bytes, and the {mcu.board} has "
            f"{mcu.ram} for them and the stack"
        )


def _bundled_libraries() -> list[Path]:
    """Return the folders of the libraries that a sketch needs not bring: the core's, and Servo."""
    shelf = arduino_core() / "libraries"
    names = ("Wire", "SPI", "EEPROM", "SoftwareSerial")
    return [*(shelf / name / "src" for name in names), laid_out() / "avr"]


def _bundled(mcu: Mcu, flags: tuple[str, ...]) -> Path:
    """Return the bundled libraries as an archive: what a sketch does not use is not linked.

    So their interrupt routines are only there with the rest of them: a sketch may have its own.
    """
    folders = _bundled_libraries()
    core = [f for each in folders[:-1] for f in sorted(each.rglob("*")) if f.suffix in SOURCES]
    files = [*core, folders[-1] / "Servo.cpp"]
    return _archive("bundled", files, [*folders, *(f / "utility" for f in folders)], mcu, flags)


def _core(mcu: Mcu, flags: tuple[str, ...]) -> Path:
    """Return the Arduino core as an archive."""
    folder = arduino_core() / "cores" / "arduino"
    files = [f for f in sorted(folder.iterdir()) if f.suffix in (*SOURCES, *ASSEMBLY)]
    return _archive("core", files, [], mcu, flags)


def _archive(
    name: str, files: list[Path], includes: list[Path], mcu: Mcu, flags: tuple[str, ...]
) -> Path:
    def make(file: Path, scratch: Path) -> None:
        objects = [_object(f, mcu, flags, includes, scratch, i) for i, f in enumerate(files)]
        run(["avr-ar", "rcs", str(file), *map(str, objects)], f"the Arduino {name}")

    key = [mcu, version("avr-g++"), contents(files), _FLAGS, _CXX, flags]
    return cached(f"{name}-avr", key, ".a", make)


def _object(
    file: Path, mcu: Mcu, flags: tuple[str, ...], includes: list[Path], scratch: Path, number: int
) -> Path:
    """Return the object file of one source; its folder is searched for headers first."""
    compiled = scratch / f"{number}.o"
    run(_compile(file, mcu, flags, includes, compiled), file.name)
    return compiled


def _compile(
    file: Path, mcu: Mcu, flags: tuple[str, ...], includes: list[Path], result: Path
) -> list[str]:
    """Return the command that compiles one source."""
    places = [f"-I{place}" for place in includes]
    return [*_compiler(file, mcu, flags), *places, "-c", str(file), "-o", str(result)]


def _compiler(file: Path, mcu: Mcu, flags: tuple[str, ...]) -> list[str]:
    """Return the compiler for a source with its options."""
    core = arduino_core()
    places = (core / "cores" / "arduino", core / "variants" / mcu.variant)
    defines = [d for d in mcu.defines if not d.startswith("-D__")]
    command = ["avr-gcc"] if file.suffix in (".c", *ASSEMBLY) else ["avr-g++", *_CXX]
    # Debian's core lacks a constant that avr-gcc 5 does not define in C++.
    command += [f"-mmcu={mcu.name}", *_FLAGS, "-DDECIMAL_DIG=__DECIMAL_DIG__", *defines, *flags]
    command += ["-x", "assembler-with-cpp"] if file.suffix in ASSEMBLY else []
    return [*command, *(f"-I{p}" for p in places)]
