"""Building: a sketch to a program that simulates its board, or to firmware."""

from __future__ import annotations

import hashlib
import os
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import platformdirs

from ...errors import InputError
from . import core, shared
from .core import avr as core_avr
from .core import util as core_util
from .dialect import narrowed
from .mcus import Mcu
from .sketch import HEADERS, SOURCES, Sketch, read_source
from .toolchain import need, version
from .unsupported import unsupported

_FOLDERS = (core, core_avr, core_util, shared)  # imported, so that they travel in an FMU
HERE = Path(__file__).parent

_BASE = ("-std=gnu++17", "-g", "-w", "-fpermissive", "-fno-pie", "-ffp-contract=off")
_SKETCH = ("-O1", "-fsingle-precision-constant", "-fsanitize-coverage=trace-pc", "-funsigned-bitfields")


def cached(kind: str, key: Sequence[object], suffix: str, make: Callable[[Path, Path], None]) -> Path:
    """Return the file that ``make(file, scratch folder)`` makes, or has made, for this key."""
    digest = hashlib.sha256(repr([kind, *key]).encode()).hexdigest()[:24]
    named = os.environ.get("SEATRIAL_CACHE")
    base = Path(named) if named else Path(platformdirs.user_cache_dir("seatrial", appauthor=False))
    folder = base.resolve() / "sketches"
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{kind}-{digest}{suffix}"
    if not file.is_file():
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            made = Path(scratch) / file.name
            make(made, Path(scratch))
            made.replace(file)  # whole, or not at all: others may build the same
    return file


def contents(files: Sequence[Path]) -> list[tuple[str, str]]:
    """Return names and hashes of files, for a key."""
    names = [str(f.relative_to(HERE) if f.is_relative_to(HERE) else f) for f in files]
    return [(n, hashlib.sha256(f.read_bytes()).hexdigest()) for n, f in zip(names, files, strict=True)]


def own_files() -> list[Path]:
    """Return the C++ files of the simulated board."""
    return [Path(str(m.__file__)).parent / name for m in _FOLDERS for name in m.DATA_FILES]


def build_host(sketch: Sketch, mcu: Mcu) -> Path:
    """Return the program that runs ``sketch`` on a simulated board with ``mcu``.

    Raises InputError for what is unsupported and for what the compiler finds, with the
    sketch's files and lines.
    """
    need("host")
    if problems := unsupported(sketch):
        raise InputError(f"{sketch.name} cannot run in the back end 'host':\n" + "\n".join(problems))
    texts = [HERE / "dialect.py", HERE / "sketch.py", HERE / "build.py"]
    key = [mcu, version("g++"), contents([*own_files(), *texts, *sketch.files()])]
    return cached(f"host-{sketch.name}", key, "", lambda file, scratch: _host(sketch, mcu, file, scratch))


def _host(sketch: Sketch, mcu: Mcu, file: Path, scratch: Path) -> None:
    common = ["g++", *_BASE, *mcu.defines, f"-I{HERE / 'core'}", f"-I{HERE / 'shared'}"]
    objects = [_core_object(name, mcu, common) for name in ("machine", "api")]
    narrow = _narrowed_copy(sketch, scratch)
    includes = [f"-I{place}" for place in narrow.folders]
    for number, source in enumerate(narrow.sources):
        compiled = scratch / f"{number}.o"
        run([*common, *_SKETCH, *includes, "-c", str(source), "-o", str(compiled)], sketch.name)
        objects.append(compiled)
    link = ["g++", "-no-pie", *map(str, objects), "-lpthread", "-o", str(file)]
    run(link, sketch.name)


def _core_object(name: str, mcu: Mcu, common: list[str]) -> Path:
    source = HERE / "core" / f"{name}.cpp"
    key = [mcu, version("g++"), contents(own_files())]

    def make(file: Path, scratch: Path) -> None:
        run([*common, "-O2", "-c", str(source), "-o", str(file)], name)

    return cached(f"core-{name}", key, ".o", make)


class _narrowed_copy:
    """A sketch's files in the host's dialect; compilers still name the files they are from."""

    def __init__(self, sketch: Sketch, scratch: Path) -> None:
        main = scratch / f"{sketch.name}.ino.cpp"
        main.write_text(narrowed(sketch.merged()))
        self.sources, self.folders = [main], []
        for number, folder in enumerate((sketch.folder, *sketch.libraries)):
            place = scratch / f"include{number}"
            self.folders.append(place)
            for file in sorted(folder.rglob("*")):
                if file.suffix in (*SOURCES, *HEADERS):
                    copy = place / file.relative_to(folder)
                    copy.parent.mkdir(parents=True, exist_ok=True)
                    head = f'#line 1 "{file}"\n' if file.suffix in HEADERS else _opening(file)
                    copy.write_text(head + narrowed(read_source(file)))
        compiled = [(sketch.folder, f) for f in sketch.others]
        compiled += [(folder, f) for folder in sketch.libraries for f in sketch.library_sources() if f.is_relative_to(folder)]
        places = dict(zip((sketch.folder, *sketch.libraries), self.folders, strict=True))
        self.sources += [places[folder] / f.relative_to(folder) for folder, f in compiled]


def _opening(file: Path) -> str:
    return f'#line 1 "{file}"\n'


def run(command: list[str], name: str) -> None:
    """Run a compiler. Raises InputError with what it says, if it refuses."""
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, "LC_ALL": "C"}
    )
    if done.returncode:
        said = "\n".join(done.stderr.splitlines()[:30])
        raise InputError(f"{name} does not compile:\n{said}")
