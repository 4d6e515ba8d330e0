"""Building: a sketch to a program that simulates its board, or to firmware."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from ...errors import InputError
from .dialect import narrowed
from .mcus import Mcu
from .resources import TEXTS, cached, contents, laid_out
from .sketch import HEADERS, SOURCES, Sketch, read_source
from .toolchain import need, version
from .unsupported import advice, unsupported

_CORE = ("machine", "uarts", "api", "avr_libc", "texts", "devices")
_BASE = ("-std=gnu++17", "-gdwarf-4", "-w", "-fpermissive", "-fno-pie", "-ffp-contract=off")
_SKETCH = (
    "-O1",
    "-fsingle-precision-constant",
    "-fsanitize-coverage=trace-pc",
)


def build_host(sketch: Sketch, mcu: Mcu) -> Path:
    """Return the program that runs ``sketch`` on a simulated board with ``mcu``.

    Raises InputError for what is unsupported and for what the compiler finds, with the
    sketch's files and lines.
    """
    need("host")
    if problems := unsupported(sketch):
        raise InputError(
            f"{sketch.name} cannot run in the back end 'host':\n" + "\n".join(problems)
        )
    whole = narrowed(sketch.merged())
    key = [mcu, version("g++"), TEXTS, whole, _BASE, _SKETCH, contents(sketch.files())]
    return cached(
        f"host-{sketch.name}", key, "", lambda file, scratch: _host(sketch, mcu, file, scratch)
    )


def _host(sketch: Sketch, mcu: Mcu, file: Path, scratch: Path) -> None:
    place = laid_out()
    common = ["g++", *_BASE, *mcu.defines, f"-I{place / 'core'}", f"-I{place / 'shared'}"]
    objects = [_core_object(name, mcu, common) for name in _CORE]
    sources, places = _narrowed_copy(sketch, scratch)
    includes = [f"-I{each}" for each in places] + ["-include", str(place / "core" / "sketch.h")]
    for number, source in enumerate(sources):
        compiled = scratch / f"{number}.o"
        run([*common, *_SKETCH, *includes, "-c", str(source), "-o", str(compiled)], sketch.name)
        objects.append(compiled)
    link = ["g++", "-no-pie", *map(str, objects), "-lpthread", "-o", str(file)]
    run(link, sketch.name)


def _core_object(name: str, mcu: Mcu, common: list[str]) -> Path:
    source = laid_out() / "core" / f"{name}.cpp"
    key = [mcu, version("g++"), TEXTS, _BASE]

    def make(file: Path, scratch: Path) -> None:
        run([*common, "-O2", "-c", str(source), "-o", str(file)], name)

    return cached(f"core-{name}", key, ".o", make)


def _narrowed_copy(sketch: Sketch, scratch: Path) -> tuple[list[Path], list[Path]]:
    """Write a sketch's files in the host's dialect; return what to compile, and folders of headers.

    Compilers still name the files that they are from.
    """
    main = scratch / f"{sketch.name}.ino.cpp"
    main.write_text(narrowed(sketch.merged()))
    sources, places = [main], []
    compiled = {*sketch.others, *sketch.library_sources()}
    for number, folder in enumerate((sketch.folder, *sketch.libraries)):
        places.append(scratch / f"include{number}")
        for file in sorted(folder.rglob("*")):
            if file.suffix not in (*SOURCES, *HEADERS):
                continue
            copy = places[-1] / file.relative_to(folder)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_text(f'#line 1 "{file}"\n{narrowed(read_source(file))}')
            if file in compiled:
                compiled.remove(file)  # a library in the sketch's folder is met twice
                sources.append(copy)
    return sources, places


def run(command: list[str], name: str) -> None:
    """Run a compiler. Raises InputError with its output, if it refuses."""
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, "LC_ALL": "C"}
    )
    if done.returncode:
        output = "\n".join(done.stderr.splitlines()[:30])
        output = "\n".join([output, *advice(output)])
        raise InputError(f"{name} does not compile:\n{output}")
