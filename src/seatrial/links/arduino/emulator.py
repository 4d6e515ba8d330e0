"""simavr: firmware built from a sketch, and the program that emulates its board.

simavr is the system's and stays outside this process: it is under the GPL.
"""

from __future__ import annotations

from pathlib import Path

from ...errors import InputError
from .build import run
from .mcus import Mcu
from .resources import TEXTS, cached, contents, laid_out
from .sketch import SOURCES, Sketch, find_sketch, included, read_source
from .toolchain import arduino_core, need, version

_FLAGS = ("-Os", "-g", "-w", "-ffunction-sections", "-fdata-sections", "-DF_CPU=16000000L")
_CXX = ("-std=gnu++11", "-fpermissive", "-fno-exceptions", "-fno-threadsafe-statics")


def build_emulator(mcu: Mcu) -> Path:
    """Return the program that emulates a board. Raises InputError if its tools are missing."""
    need("simavr")
    key = [version("g++"), TEXTS, contents([Path("/usr/include/simavr/sim_avr.h")])]

    def make(file: Path, scratch: Path) -> None:
        place = laid_out()
        includes = ["-I/usr/include/simavr", f"-I{place / 'shared'}"]
        source = str(place / "avr" / "emulated_board.c")
        run(["gcc", "-O2", *includes, source, "-lsimavr", "-lm", "-o", str(file)], "simavr's board")

    return cached("emulator", key, "", make)


def firmware_file(sketch: str, firmware: str, mcu: Mcu) -> Path:
    """Return the firmware to run: a user's own, or a sketch's, built. Raises InputError."""
    if not firmware:
        return build_firmware(find_sketch(sketch), mcu)
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
    need("simavr")
    key = [mcu, version("avr-g++"), TEXTS, sketch.merged(), _FLAGS, contents(sketch.files())]
    servo = laid_out() / "avr"

    def make(file: Path, scratch: Path) -> None:
        main = scratch / f"{sketch.name}.ino.cpp"
        main.write_text(sketch.merged())
        libraries = _bundled_libraries(sketch)
        sources = [main, *sketch.others, *sketch.library_sources(), servo / "Servo.cpp"]
        for library in libraries:
            sources += [f for f in sorted(library.rglob("*")) if f.suffix in SOURCES]
        includes = [sketch.folder, *sketch.libraries, servo, *libraries]
        includes += [library / "utility" for library in libraries]
        objects = [_object(f, mcu, includes, scratch, i) for i, f in enumerate(sources)]
        link = ["avr-gcc", "-Os", "-Wl,--gc-sections", f"-mmcu={mcu.name}", "-o", str(file)]
        run([*link, *map(str, objects), str(_core(mcu)), "-lm"], sketch.name)

    return cached(f"firmware-{sketch.name}", key, ".elf", make)


def _bundled_libraries(sketch: Sketch) -> list[Path]:
    names = ["Wire", "SPI", "EEPROM"]
    # It claims the pins' interrupts, which a sketch may have routines of its own for.
    headers = {header for file in sketch.files() for header, _ in included(read_source(file))}
    if "SoftwareSerial.h" in headers:
        names.append("SoftwareSerial")
    shelf = arduino_core() / "libraries"
    return [shelf / name / "src" for name in names if (shelf / name).is_dir()]


def _compiler(file: Path, mcu: Mcu, includes: list[Path]) -> list[str]:
    core = arduino_core()
    places = [core / "cores" / "arduino", core / "variants" / mcu.variant, *includes]
    defines = [d for d in mcu.defines if not d.startswith("-D__")]
    compiler = ["avr-gcc"] if file.suffix in (".c", ".S") else ["avr-g++", *_CXX]
    # Debian's core lacks a constant that avr-gcc 5 does not define in C++.
    more = ["-DDECIMAL_DIG=__DECIMAL_DIG__"]
    return [*compiler, f"-mmcu={mcu.name}", *_FLAGS, *more, *defines, *(f"-I{p}" for p in places)]


def _object(file: Path, mcu: Mcu, includes: list[Path], scratch: Path, number: int) -> Path:
    compiled = scratch / f"{number}.o"
    assembler = ["-x", "assembler-with-cpp"] if file.suffix == ".S" else []
    command = [*_compiler(file, mcu, includes), *assembler, "-c", str(file), "-o", str(compiled)]
    run(command, file.name)
    return compiled


def _core(mcu: Mcu) -> Path:
    """Return the Arduino core as a library."""
    folder = arduino_core() / "cores" / "arduino"
    files = [f for f in sorted(folder.iterdir()) if f.suffix in (*SOURCES, ".S")]

    def make(file: Path, scratch: Path) -> None:
        objects = [_object(f, mcu, [], scratch, i) for i, f in enumerate(files)]
        run(["avr-ar", "rcs", str(file), *map(str, objects)], "the Arduino core")

    return cached("core-avr", [mcu, version("avr-g++"), contents(files), _FLAGS, _CXX], ".a", make)
