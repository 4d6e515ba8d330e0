"""Source FMUs compiled into the user's cache, by the hash of archive, build and compiler.

The code of a source FMU is trusted as its binary would be: it runs as its user, or, as the FMU
itself, in a sandbox. Nothing is written outside the cache, and none of the FMU's files changes.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import fmpy

from ...errors import InputError
from ...files.whole_file import unused
from ..cache import cache_folder, write_named
from ..interfaces.loaded import LoadedFmu
from ..on_demand import compilers_of
from .sandbox import build_sandbox
from .sources import Build, read_build

_HEADERS = Path(fmpy.__file__).parent / "c-code"
"""FMI's own, for sources that do not bring them."""
_FLAGS = ("-O2", "-fPIC", "-ffp-contract=off", "-fno-sanitize=undefined")
_LINKED = {
    "linux": ("-shared", "-Wl,-Bsymbolic", "-Wl,-z,defs"),  # its names are its own, and all there
    "darwin": ("-dynamiclib",),
}
_MOST_LINES = 4
_LONGEST_S = 600.0
"""For one file: code made by tools may have megabytes in one function."""


@dataclass(frozen=True)
class Compiler:
    """A command that compiles and links a language, and what its result depends on."""

    command: tuple[str, ...]
    version: str


def with_library(fmu: LoadedFmu, *, sandboxed: bool = False) -> LoadedFmu:
    """Return the FMU with a library built of its sources, if it has none for this machine.

    ``sandboxed`` compiles in a sandbox, which sees no files but the FMU's and the system's.

    Raises InputError for sources that cannot be built, with the first errors of the compiler, and
    if there is no compiler.
    """
    build = build_needed(fmu)
    if build is None:
        return fmu
    compiler = compiler_of(build)
    what = (fmu.sha256, build, compiler, sandboxed, _FLAGS, fmpy.__version__)
    key = hashlib.sha256(repr(what).encode()).hexdigest()[:16]
    made = replace(fmu, built=cache_folder("built") / key)
    if not made.binary.is_file():
        content = _built(fmu, build, compiler, sandboxed=sandboxed)
        made.binary.parent.mkdir(parents=True, exist_ok=True)
        write_named(made.binary, content)
    return made


def build_needed(fmu: LoadedFmu) -> Build | None:
    """Return how an FMU is built that has sources, and no library for this machine.

    Raises InputError as `read_build`.
    """
    if fmu.built is not None or fmu.binary.is_file():
        return None
    return read_build(fmu)


def compiler_of(build: Build) -> Compiler:
    """Return the first compiler of the language that there is. Raises InputError."""
    found = compilers_of(build.language)
    if not found:
        raise InputError(
            f"FMUs in {build.language.upper()} need a compiler to build: "
            "pip install 'seatrial[native]'"
        )
    return Compiler(tuple(found[0]), _version(tuple(found[0])))


@cache
def _version(command: tuple[str, ...]) -> str:
    said = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    return said.stdout.partition("\n")[0]


def _built(fmu: LoadedFmu, build: Build, compiler: Compiler, *, sandboxed: bool) -> bytes:
    """Return the library, made in a folder of the cache that goes again."""
    work = unused(cache_folder("built"), "building")
    work.mkdir()
    try:
        run = _Run(fmu, work, compiler, sandboxed=sandboxed)
        objects = [
            run.compiled(name, one.language, one.options)
            for one in build.sets
            for name in one.files
        ]
        library = work / fmu.binary.name
        how = _LINKED.get(sys.platform, ("-shared",))
        run("its link", *how, *objects, "-o", str(library), *build.libraries)
        return library.read_bytes()
    finally:
        shutil.rmtree(work, ignore_errors=True)


class _Run:
    """A compiler's command for the sources of one FMU, its files in a folder of its own."""

    def __init__(self, fmu: LoadedFmu, work: Path, compiler: Compiler, *, sandboxed: bool) -> None:
        self._fmu, self._work, self._compiler = fmu, work, compiler
        self._sources = fmu.folder / "sources"
        self._count = 0
        zig = work if sandboxed else cache_folder("zig")
        own = {
            "TMPDIR": str(work),
            "LC_ALL": "C",
            "ZIG_GLOBAL_CACHE_DIR": str(zig),
            "ZIG_LOCAL_CACHE_DIR": str(work),
        }
        self._environment = {**os.environ, **own}
        self._sandbox: Sequence[str] = ()
        if sandboxed:
            self._sandbox = build_sandbox(fmu, work, self._sources)
            self._environment = {"PATH": os.environ.get("PATH", os.defpath), **own}

    def compiled(self, name: str, language: str, options: Sequence[str]) -> str:
        """Compile a file; return its object file."""
        self._count += 1
        target = str(self._work / f"{self._count}.o")
        headers = ("-I.", "-idirafter", str(_HEADERS))
        said = [one for one in options if not one.startswith("-l")]
        source = ("-x", language, f"./{name}")
        self(f"sources/{name}", *_FLAGS, *said, "-w", *headers, "-c", *source, "-o", target)
        return target

    def __call__(self, what: str, *arguments: str) -> None:
        """Raise InputError with the compiler's first errors if it finds any."""
        command = [*self._sandbox, *self._compiler.command, *arguments]
        try:
            done = subprocess.run(
                command,
                cwd=self._sources,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=_LONGEST_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise self._refused(what, f"it took more than {_LONGEST_S:.0f} s") from None
        if done.returncode:
            raise self._refused(what, _first(done.stderr) or f"status {done.returncode}")

    def _refused(self, what: str, why: str) -> InputError:
        return InputError(
            f"{self._fmu.path}: cannot be built of its sources by {self._compiler.version}: "
            f"{what}: {why.replace(str(self._work), '')}"
        )


def _first(said: str) -> str:
    """Return the first lines of a compiler's messages that say what is wrong."""
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    errors = [one for one in lines if "error" in one or "undefined" in one]
    return "\n".join((errors or lines)[:_MOST_LINES])[:2000]
