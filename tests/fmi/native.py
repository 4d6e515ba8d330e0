"""Slaves in C, compiled into FMUs with FMPy's headers; and FMUs that differ from them a little."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

import fmpy

from seatrial.fmi.files.terminals import PLACE
from seatrial.fmi.instance import Instance

SLAVES = Path(__file__).parent / "slaves"


def build_native_fmu(name: str, folder: Path) -> Path:
    """Compile ``slaves/NAME.c`` into ``folder/NAME.fmu``, described by ``slaves/NAME.xml``.

    Its terminals are those of ``slaves/NAME.terminals.xml``, if that is there.
    """
    folder.mkdir(parents=True, exist_ok=True)
    library, path = folder / f"{name}.so", folder / f"{name}.fmu"
    compiled(SLAVES / f"{name}.c", library)
    description = (SLAVES / f"{name}.xml").read_bytes()
    platform = fmpy.platform_tuple if b'fmiVersion="3.0"' in description else fmpy.platform
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(library, f"binaries/{platform}/{name}.so")
        terminals = SLAVES / f"{name}.terminals.xml"
        if terminals.is_file():
            archive.write(terminals, PLACE)
    return path


def forgetful(path: Path, to: Path) -> Path:
    """Copy the FMI 2.0 slave to ``to``, with a library that says it saves its state but does not."""
    source = (SLAVES / "fmi2.c").read_text("utf-8")
    for lost in ("    memcpy(*s, c, sizeof(Slave));\n", "    memcpy(c, s, sizeof(Slave));\n",
                 '    if (fabs(t - s->time) > 1e-9) return say(s, fmi2Error, "steps do not follow each other");\n'):  # fmt: skip
        assert lost in source, lost
        source = source.replace(lost, "")
    changed_source = to.with_suffix(".c")
    changed_source.write_text(source, "utf-8")
    return _with_library(path, compiled(changed_source, to.with_suffix(".so")), to)


def lacking(path: Path, to: Path, *functions: str) -> Path:
    """Copy the FMI 2.0 slave to ``to``, with a library that lacks some functions."""
    renamed = [f"-D{name}=other_{name}" for name in functions]
    library = compiled(SLAVES / "fmi2.c", to.with_suffix(".so"), *renamed)
    return _with_library(path, library, to)


def variant(path: Path, to: Path, *defined: str) -> Path:
    """Copy a slave to ``to``, with a library for which names are defined."""
    library = compiled(
        SLAVES / f"{path.stem}.c", to.with_suffix(".so"), *(f"-D{one}" for one in defined)
    )
    return _with_library(path, library, to)


def dying(path: Path, to: Path, where: str) -> Path:
    """Copy the FMI 3.0 slave to ``to``, with a library that dies AT_THE_END or IN_THE_RELEASE."""
    library = compiled(SLAVES / "fmi3.c", to.with_suffix(".so"), f"-DDIES_{where}")
    return _with_library(path, library, to)


def without_events(path: Path, to: Path) -> Path:
    """Copy the FMI 3.0 slave to ``to``, with a library that refuses the event mode it promises."""
    library = compiled(SLAVES / "fmi3.c", to.with_suffix(".so"), "-DREFUSES_EVENTS")
    return _with_library(path, library, to)


def sharing(path: Path, to: Path, flag: str, source: str, *flags: str) -> Path:
    """Copy a slave's FMU to ``to``, whose instances in one process are one, and that says so.

    ``flag`` is an attribute of its model description, beside which it is said.
    """
    shared = ("-include", str(SLAVES / "sharing.h"), *flags)
    library = compiled(SLAVES / source, to.with_suffix(".so"), *shared)
    only = f'{flag} canBeInstantiatedOnlyOncePerProcess="true"'
    with_library = _with_library(path, library, to.with_name(f"one-{to.name}"))
    return changed(with_library, to, (flag, only))


def _with_library(path: Path, library: Path, to: Path) -> Path:
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(to, "w") as new:
        for member in old.infolist():
            is_library = member.filename.endswith(".so")
            new.writestr(member, library.read_bytes() if is_library else old.read(member))
    return to


def compiled(source: Path, library: Path, *flags: str) -> Path:
    """Compile a C file with FMI's headers; return the library."""
    headers = Path(fmpy.__file__).parent / "c-code"
    subprocess.run(
        [
            "cc",
            "-shared",
            "-fPIC",
            "-O1",
            "-w",
            *flags,
            f"-I{headers}",
            source,
            "-o",
            library,
            "-lm",
        ],
        check=True,
    )
    return library


def changed(
    path: Path, to: Path, *changes: tuple[str, str], member: str = "modelDescription.xml"
) -> Path:
    """Copy an FMU to ``to`` with texts in its model description, or another file, replaced."""
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(to, "w") as new:
        for each in old.infolist():
            data = old.read(each)
            if each.filename == member:
                for before, after in changes:
                    assert before.encode() in data, before
                    data = data.replace(before.encode(), after.encode())
            new.writestr(each, data)
    return to


def described_fmu(path: Path, text: str | bytes) -> Path:
    """Write an FMU that has nothing but a model description."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", text)
    return path


def started(instance: Instance, **values: object) -> Instance:
    """Initialise an instance with start values, and begin."""
    instance.set_start(values)  # type: ignore[arg-type]
    instance.initialise(0.0, 10.0)
    instance.begin()
    return instance


def read(instance: Instance, *names: str) -> list[object]:
    """Return the values of some variables."""
    return instance.reader(names)()
