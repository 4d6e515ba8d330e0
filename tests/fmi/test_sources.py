"""Source FMUs in the layouts of tools, built when they are used, against their binaries."""

from __future__ import annotations

import re
import shutil
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest
from typer.testing import CliRunner

from seatrial.cli.fmu import fmu_app
from seatrial.errors import InputError, SeatrialError
from seatrial.fmi.compiler import HERE, library_here
from seatrial.fmi.components.source import find_source
from seatrial.fmi.files.options import INTERFACES, FmuOptions
from seatrial.fmi.instance import Instance
from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.fmi.loading.load import load_fmu, open_instance
from seatrial_kits.native.export import build_native_fmu as exported

from .models import build_model_fmu
from .native import SLAVES, build_native_fmu, started

TWO, THREE = ((SLAVES / f"fmi{version}.c").read_text("utf-8") for version in "23")


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv("SEATRIAL_CACHE", str(folder))
    return folder


def source_fmu(
    path: Path, sources: Mapping[str, str], listed: str = "", version: int = 2, build: str = ""
) -> Path:
    """Write an FMU of the slave of a version, without binaries."""
    described = (SLAVES / f"fmi{version}.xml").read_text("utf-8")
    files = "".join(f'<File name="{name}"/>' for name in listed.split())
    if files:
        inside = f"<SourceFiles>{files}</SourceFiles>"
        before, _, after = described.partition("/>")  # of the interface
        described = f"{before}>{inside}</CoSimulation>{after}"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", described)
        for name, text in sources.items():
            archive.writestr(f"sources/{name}", text)
        if build:
            archive.writestr(
                "sources/buildDescription.xml",
                f'<fmiBuildDescription fmiVersion="3.0">\n{build}\n</fmiBuildDescription>',
            )
    return path


def trajectory(instance: Instance, **values: float) -> list[list[object]]:
    """Return all outputs over 20 steps; the instance is gone then."""
    names = [v.name for v in instance.variables.values() if v.causality == "output"]
    try:
        started(instance, **values)
        rows = []
        for k in range(20):
            instance.step(k * 0.1, 0.1)
            rows.append(instance.reader(names)())
        instance.terminate()
    finally:
        instance.free()
    return rows


def same_as_binary(path: Path, version: int = 2) -> None:
    """Compare with the binary that the tests compile by a command of their own."""
    binary = build_native_fmu(f"fmi{version}", path.parent / "binary")
    values = {"k": 0.7, "u": 3.0} if version == 2 else {"k": 0.7}
    wanted = trajectory(open_instance(load_fmu(binary), "binary"), **values)
    assert wanted[0] != wanted[-1]
    assert trajectory(open_instance(load_fmu(path), "built"), **values) == wanted


def prefixed(source: str, identifier: str = "fmi2") -> str:
    """Return a file with macros that put the identifier before FMI's functions, as FMI has it."""
    functions = sorted(set(re.findall(r"\bfmi2[A-Z]\w+(?=\()", source)))
    assert len(functions) > 20
    return "".join(f"#define {one} {identifier}_{one}\n" for one in functions)


SPLIT = TWO.replace("x[Y] = x[GAIN] * x[U];", "x[Y] = error(x[GAIN], x[U]);").replace(
    "#include <math.h>", '#include <math.h>\n#include "product.h"'
)
"""A part in a file of its own, called as a function of the C library is."""
PRODUCT = "double error(double a, double b);\n"
PART = '#include "product.h"\ndouble error(double a, double b) { return a * b; }\n'
CPP = (
    'extern "C" {\n#include "product.h"\n}\n#include <vector>\n'
    "double error(double a, double b) { std::vector<double> v{a, b}; return v[0] * v[1]; }\n"
)
PREFIX_UNLESS = f'#ifndef NO_FUNCTION_PREFIX\n{prefixed(TWO)}#endif\n#include "fmi2.c"\n'
LAYOUTS: dict[str, tuple[dict[str, str], str]] = {
    "one file": ({"fmi2.c": TWO}, "fmi2.c"),
    "nothing listed": ({"fmi2.c": TWO, "notes.txt": "?"}, ""),
    "nothing listed but all.c": (
        {"all.c": '#include "product.c"\n#include "fmi2.c"', "product.c": PART, "fmi2.c": SPLIT,
         "product.h": "#pragma once\n" + PRODUCT}, "",
    ),
    "prefix": ({"main.c": prefixed(TWO) + '#include "fmi2.c"', "fmi2.c": TWO}, "main.c"),
    "defines.def": (
        {"main.c": PREFIX_UNLESS + '#if HALF != 2\n#error "HALF"\n#endif\n', "fmi2.c": TWO,
         "defines.def": "NO_FUNCTION_PREFIX\r\n\r\n-DHALF=2\r\n"}, "main.c",
    ),
    "folders": (
        {"fmi2.c": SPLIT, "parts/product.c": PART, "inc/h/product.h": PRODUCT,
         "includes.txt": "inc/h\n"}, "fmi2.c parts/product.c",
    ),
    "backslashes, a header listed": (
        {"fmi2.c": SPLIT, "parts/product.c": PART, "product.h": PRODUCT},
        "sources\\fmi2.c product.h parts\\product.c",
    ),
    "C++ beside C": (
        {"fmi2.c": SPLIT, "product.cpp": CPP, "product.h": PRODUCT}, "product.cpp fmi2.c",
    ),
}  # fmt: skip


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts_of_fmi2(layout: str, tmp_path: Path) -> None:
    same_as_binary(source_fmu(tmp_path / "x.fmu", *LAYOUTS[layout]))


SETS = """<BuildConfiguration modelIdentifier="other"><SourceFileSet><SourceFile name="no.c"/>
</SourceFileSet></BuildConfiguration>
<BuildConfiguration modelIdentifier="fmi3" platform="pdp11-unix"><SourceFileSet>
<SourceFile name="no.c"/></SourceFileSet></BuildConfiguration>
<BuildConfiguration modelIdentifier="fmi3">
  <SourceFileSet language="C99" compilerOptions="-Wall -O1 '-DTEXT=&quot;a b&quot;'">
    <SourceFile name="slave.c"/>
    <PreprocessorDefinition name="NAME" value="fmi3.c"/>
    <PreprocessorDefinition name="EMPTY" value=""/>
    <PreprocessorDefinition name="UNWANTED" optional="true"/>
    <IncludeDirectory name="folder/inc"/>
  </SourceFileSet>
  <SourceFileSet language="C++11" compiler="MSVC" compilerOptions="/EHsc">
    <SourceFile name="other.cxx"/>
  </SourceFileSet>
  <Library name="m" external="true"/>
</BuildConfiguration>"""
SLAVE3 = """#define TEXT_OF(x) #x
#define TEXT_(x) TEXT_OF(x)
#ifdef UNWANTED
#error "it is optional"
#endif
const char *text = TEXT, *empty = "" EMPTY;
double half(void);
#include TEXT_(NAME)
"""


def test_a_build_description_of_fmi3(tmp_path: Path) -> None:
    files = {
        "slave.c": SLAVE3,
        "folder/inc/fmi3.c": THREE,
        "other.cxx": 'extern "C" double half() { auto x = 0.5; return x; }',
    }
    same_as_binary(source_fmu(tmp_path / "x.fmu", files, version=3, build=SETS), 3)


@pytest.mark.parametrize(
    ("version", "interface"),
    [(v, i) for i in INTERFACES for v in (1, 2, 3) if (v, i) != (3, "co-simulation")],
)
def test_every_version_and_interface(version: int, interface, tmp_path: Path) -> None:
    """FMI 1.0 lists no files: ``all.c`` includes them."""
    binary, path = build_model_fmu(version, tmp_path, interface), tmp_path / "x.fmu"
    with zipfile.ZipFile(binary) as old, zipfile.ZipFile(path, "w") as new:
        new.writestr("modelDescription.xml", old.read("modelDescription.xml"))
        new.writestr("sources/all.c", f'#define FMI {version}\n#include "model.c"')
        new.writestr("sources/model.c", (SLAVES / "model.c").read_text("utf-8"))
    one, other = (load_fmu(one, FmuOptions(interface)) for one in (binary, path))
    assert trajectory(open_instance(other, "a")) == trajectory(open_instance(one, "a"))


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_our_own_native_fmus_are_built_of_their_sources(version: int, tmp_path: Path) -> None:
    path = tmp_path / "own.fmu"
    source = find_source("thruster-allocation", Path.cwd())
    exported(source, path, (HERE,), None, library_here, version)
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(tmp_path / "x.fmu", "w") as new:
        for member in old.namelist():
            if not member.startswith("binaries/"):
                new.writestr(member, old.read(member))
    binary, built = load_fmu(path), load_fmu(tmp_path / "x.fmu")
    assert trajectory(open_instance(built, "a")) == trajectory(open_instance(binary, "a"))


def test_a_built_library_is_kept_and_the_fmu_is_as_it_was(cache: Path, tmp_path: Path) -> None:
    path = source_fmu(tmp_path / "x.fmu", {"fmi2.c": TWO})
    fmu = load_fmu(path)
    before = sorted(fmu.folder.rglob("*"))
    open_instance(fmu, "a").free()
    (library,) = (cache / "built").rglob("*.so")
    stamp = library.stat().st_mtime_ns
    open_instance(fmu, "b").free()
    assert library.stat().st_mtime_ns == stamp
    assert sorted(fmu.folder.rglob("*")) == before
    assert [one.name for one in (cache / "built").iterdir()] == [library.parents[2].name]
    assert {one.name for one in tmp_path.iterdir()} == {"cache", "x.fmu"}


REFUSED = {
    "a header that is not there": (
        {"fmi2.c": '#include "gone.h"\n' + TWO}, "", r"sources/fmi2\.c: .*gone\.h: No such file"
    ),
    "an error in C": ({"fmi2.c": TWO + "\nint x = ;"}, "", r"fmi2\.c:\d+:\d+: error: expected"),
    "a file that is not there": ({"fmi2.c": TWO}, "a.c", r"line 3: no file sources/a\.c"),
    "a file elsewhere": ({"fmi2.c": TWO}, "../../a.c", r"'\.\./\.\./a\.c' is outside the FMU"),
    "another language": ({"fmi2.f90": "end"}, "fmi2.f90", r"'fmi2\.f90' is in no language"),
    "a symbol": (
        {"fmi2.c": SPLIT.replace("error(", "nowhere("), "product.h": "double nowhere(double, double);"},
        "fmi2.c", r"its link: .*undefined reference to `nowhere'",
    ),
    "a definition": ({"fmi2.c": TWO, "defines.def": "\nA-B"}, "", r"defines\.def:2: 'A-B' is no"),
    "a folder elsewhere": (
        {"fmi2.c": TWO, "includes.txt": "/usr/include"}, "", r"includes\.txt:1: '/usr/include' is outs"
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_built_says_why(what: str, cache: Path, tmp_path: Path) -> None:
    sources, listed, message = REFUSED[what]
    fmu = load_fmu(source_fmu(tmp_path / "x.fmu", sources, listed))
    with pytest.raises(InputError, match=message) as caught:
        open_instance(fmu, "a")
    assert str(fmu.path) in str(caught.value)
    assert str(cache) not in str(caught.value)
    assert not list(cache.glob("built/*"))


@pytest.mark.parametrize(
    ("attributes", "inside", "message"),
    [
        ('language="Fortran77"', "", r"SourceFileSet \(line 3\): language 'Fortran77' is not"),
        ('compilerOptions="-fplugin=a.so"', "", "option '-fplugin=a.so' is not taken"),
        ('compilerOptions="-o /tmp/x"', "", "option '-o' is not taken"),
        ('compilerOptions="-Wl,-rpath,/tmp"', "", "option '-Wl,-rpath,/tmp' is not taken"),
        ('compilerOptions="@options"', "", "option '@options' is not taken"),
        ('compilerOptions="-O2 \'"', "", "No closing quotation"),
        ("", '<PreprocessorDefinition name="A B"/>', r"\(line 3\): 'A B' is no name"),
        ("", '<IncludeDirectory name="/usr"/>', "'/usr' is outside the FMU"),
    ],
)
def test_build_descriptions_that_are_refused(
    attributes: str, inside: str, message: str, tmp_path: Path
) -> None:
    build = f"""<BuildConfiguration modelIdentifier="fmi3">
<SourceFileSet {attributes}><SourceFile name="fmi3.c"/>{inside}</SourceFileSet>
</BuildConfiguration>"""
    path = source_fmu(tmp_path / "x.fmu", {"fmi3.c": THREE}, version=3, build=build)
    with pytest.raises(InputError, match=message):
        open_instance(load_fmu(path), "a")


def test_a_static_library_of_the_fmu_that_is_not_there(tmp_path: Path) -> None:
    build = """<BuildConfiguration modelIdentifier="fmi3"><SourceFileSet>
<SourceFile name="fmi3.c"/></SourceFileSet><Library name="solver"/></BuildConfiguration>"""
    path = source_fmu(tmp_path / "x.fmu", {"fmi3.c": THREE}, version=3, build=build)
    with pytest.raises(InputError, match=r"no static library 'solver' in binaries/"):
        open_instance(load_fmu(path), "a")


@pytest.mark.slow
def test_isolated_it_is_the_same(tmp_path: Path) -> None:
    path = source_fmu(tmp_path / "x.fmu", {"fmi2.c": TWO})
    fmu = load_fmu(path)
    isolated = trajectory(IsolatedInstance(fmu, "a", 60.0), k=0.7)
    assert isolated == trajectory(open_instance(fmu, "b"), k=0.7)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("bwrap") is None, reason="there is no bubblewrap")
def test_sandboxed_a_build_sees_no_files_of_the_user(tmp_path: Path) -> None:
    own = tmp_path / "secret.h"
    own.write_text("#define SECRET 1\n")
    fmu = load_fmu(source_fmu(tmp_path / "x.fmu", {"fmi2.c": TWO}))
    found = trajectory(IsolatedInstance(fmu, "a", 60.0, sandboxed=True), k=0.7)
    assert found == trajectory(open_instance(fmu, "b"), k=0.7)
    curious = source_fmu(tmp_path / "y.fmu", {"fmi2.c": f'#include "{own}"\n' + TWO})
    open_instance(load_fmu(curious), "a").free()  # as its user it may
    with pytest.raises(SeatrialError, match=r"secret\.h: No such file"):
        IsolatedInstance(load_fmu(curious), "a", 60.0, sandboxed=True)


def test_describe_and_check_say_that_it_will_be_built(tmp_path: Path) -> None:
    def said(command: str, path: Path) -> str:
        return CliRunner().invoke(fmu_app, [command, str(path)]).output

    path = source_fmu(tmp_path / "x.fmu", {"fmi2.c": TWO})
    will = "it will be built of its sources by"
    assert f"binaries for no platform; {will}" in said("describe", path)
    assert will in said("check", path)
    assert will not in said("describe", build_native_fmu("fmi2", tmp_path))
    wrong = source_fmu(tmp_path / "y.fmu", {"fmi2.c": TWO}, "gone.c")
    assert "its sources cannot be built here" in said("describe", wrong)
