"""Archives that want to do harm, or are damaged: refused, and nothing is left behind."""

from __future__ import annotations

import contextlib
import os
import stat
import struct
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.fmi.files import archive
from seatrial.fmi.files.archive import content_hash, unpacked
from seatrial.fmi.loading.load import load_fmu


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of its own; afterwards nothing but whole folders may be in it."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("SEATRIAL_CACHE", str(folder))
    yield folder
    assert not list(folder.rglob("unpacking-*"))
    assert {p.name for p in tmp_path.iterdir()} <= {"cache", "x.fmu"}


def zipped(path: Path, *members: tuple[str | zipfile.ZipInfo, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in members:
            file.writestr(name, data)
    return path


def refused(path: Path, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        unpacked(path, "FMU")
    assert str(path) in str(caught.value)
    assert not list((path.parent / "cache" / "unpacked").iterdir())


def test_what_is_in_it_is_unpacked_once(cache: Path, tmp_path: Path) -> None:
    members = {"a.txt": b"text", "é/ü": b"\0\xff", "folder/": b"", "folder/deep/er": b""}
    path = zipped(tmp_path / "x.fmu", *members.items())
    folder = unpacked(path, "FMU")
    found = {p.relative_to(folder).as_posix(): p for p in folder.rglob("*")}
    assert found.keys() == {"a.txt", "é", "é/ü", "folder", "folder/deep", "folder/deep/er"}
    assert all(
        found[name].read_bytes() == data for name, data in members.items() if name[-1] != "/"
    )
    (folder / "a.txt").touch()
    before = (folder / "a.txt").stat().st_mtime_ns
    assert unpacked(path, "FMU") == folder
    assert (folder / "a.txt").stat().st_mtime_ns == before


OUTSIDE = (
    "../evil",
    "../../evil",
    "a/../../evil",
    "a/../../../../b/../evil",
    "../a/../evil",
    "/etc/evil",
    "//host/evil",
    "C:evil",
    "c:/evil",
    "./C:evil",
    "a/../C:evil",
    "..\\evil",
    "a\\..\\..\\evil",
    "..",
)


@pytest.mark.parametrize("name", OUTSIDE)
def test_members_that_lead_outside(name: str, cache: Path, tmp_path: Path) -> None:
    refused(zipped(tmp_path / "x.fmu", ("fine", b""), (name, b"x")), "outside its folder")


def test_backslashes_of_tools_on_windows_are_folders(cache: Path, tmp_path: Path) -> None:
    members = [("binaries\\win64\\", b""), ("binaries\\win64\\x.dll", b"MZ"), ("a/b", b"1")]
    folder = unpacked(zipped(tmp_path / "x.fmu", *members), "FMU")
    assert (folder / "binaries/win64/x.dll").read_bytes() == b"MZ"
    assert (folder / "a/b").read_bytes() == b"1"


ODD = (
    ("./", b""),
    ("/", b""),
    ("", b""),
    (".", b""),
    ("./a", b"1"),
    (".\\b", b"2"),
    ("c//d", b"3"),
    ("c/", b""),
    ("c/./", b""),
    ("e/.", b""),
    ("f/../g", b"4"),
    ("h/./../c/./i", b"5"),
    ("c/../", b""),
)
"""Members that tools write, or could, and that harm nobody."""


def test_odd_members_are_where_they_say(cache: Path, tmp_path: Path) -> None:
    members = [(zipfile.ZipInfo(name), data) for name, data in ODD]
    for (name, _), (info, _data) in zip(ODD, members, strict=True):
        info.filename = info.orig_filename = name
    folder = unpacked(zipped(tmp_path / "x.fmu", *members), "FMU")
    found = {p.relative_to(folder).as_posix() for p in folder.rglob("*")}
    assert found == {"a", "b", "c", "c/d", "c/i", "e", "g"}
    assert [(folder / n).read_bytes() for n in ("a", "b", "c/d", "g", "c/i")] == [
        b"1", b"2", b"3", b"4", b"5"
    ]  # fmt: skip
    assert unpacked(tmp_path / "x.fmu", "FMU") == folder
    (folder / "c/i").write_bytes(b"cut")
    assert (unpacked(tmp_path / "x.fmu", "FMU") / "c/i").read_bytes() == b"5"


def test_folders_by_their_attributes(cache: Path, tmp_path: Path) -> None:
    unix, dos = zipfile.ZipInfo("unix"), zipfile.ZipInfo("dos")
    unix.external_attr, dos.external_attr = (stat.S_IFDIR | 0o755) << 16, 0x10
    folder = unpacked(
        zipped(tmp_path / "x.fmu", (unix, b""), (dos, b""), ("unix/a", b"1"), ("dos/b", b"2")),
        "FMU",
    )
    assert (folder / "unix/a").is_file()
    assert (folder / "dos/b").is_file()


@pytest.mark.parametrize(
    ("first", "second"), [("a", "./a"), ("b//c", "b/c"), ("d\\e", "d/./e"), ("f", "g/../f")]
)
def test_two_members_that_become_the_same_file(
    first: str, second: str, cache: Path, tmp_path: Path
) -> None:
    refused(zipped(tmp_path / "x.fmu", (first, b"1"), (second, b"2")), "two members are called")


def test_an_fmu_whose_folders_have_entries_is_loaded(cache: Path, tmp_path: Path) -> None:
    """As `zip -r x.fmu .` and CMake's tar write it: libcosim's build adds ``./``."""
    path = tmp_path / "x.fmu"
    described = (Path(__file__).parent / "slaves/fmi2.xml").read_bytes()
    zipped(path, ("./", b""), ("./modelDescription.xml", described), ("./binaries/", b""))
    assert load_fmu(path).version == 2


def test_members_that_are_no_plain_files(cache: Path, tmp_path: Path) -> None:
    link = zipfile.ZipInfo("link")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    refused(zipped(tmp_path / "x.fmu", (link, b"/etc/passwd")), "'link' is a symbolic link")
    link.external_attr = (stat.S_IFIFO | 0o600) << 16
    refused(zipped(tmp_path / "x.fmu", (link, b"")), "'link' is no plain file")


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize(
    ("names", "message"),
    [
        (("a", "a"), "two members are called 'a'"),
        (("a/b", "a/./b"), "two members are called"),
        (("a", "a/b"), "'a' is a file and a folder"),
        (("n" * 256,), "is no name of a file"),
        (("é" * 128,), "is no name of a file"),
        (("a/" * 600 + "a",), "is no name of a file"),
        ((".",), "is no name of a file"),
        (("a/",), "is no name of a file"),
    ],
)
def test_names_that_no_folder_can_hold(
    names: tuple[str, ...], message: str, cache: Path, tmp_path: Path
) -> None:
    members = [(name, str(number).encode()) for number, name in enumerate(names)]
    refused(zipped(tmp_path / "x.fmu", *members), message)


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_what_is_there_twice_and_alike_is_there_once(cache: Path, tmp_path: Path) -> None:
    members = [("extra/", b""), ("extra/a", b"1"), ("extra/", b""), ("extra/a", b"1")]
    folder = unpacked(zipped(tmp_path / "x.fmu", *members), "FMU")
    assert (folder / "extra/a").read_bytes() == b"1"


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_a_folder_and_an_empty_file_of_one_name(cache: Path, tmp_path: Path) -> None:
    refused(zipped(tmp_path / "x.fmu", ("a/", b""), ("a", b"")), "two members are called 'a'")


def test_a_name_with_a_nul_is_refused(cache: Path, tmp_path: Path) -> None:
    path = zipped(tmp_path / "x.fmu", ("good_name", b""))
    path.write_bytes(path.read_bytes().replace(b"good_name", b"good\0name"))
    refused(path, "is no name of a file")


def patched(path: Path, signature: bytes, offset: int, layout: str, value: int) -> Path:
    """Change a number in every zip record of a kind."""
    data = bytearray(path.read_bytes())
    place = data.find(signature)
    while place >= 0:
        struct.pack_into(layout, data, place + offset, value)
        place = data.find(signature, place + 4)
    path.write_bytes(bytes(data))
    return path


LOCAL, CENTRAL = b"PK\3\4", b"PK\1\2"


def test_encrypted_members(cache: Path, tmp_path: Path) -> None:
    path = patched(zipped(tmp_path / "x.fmu", ("secret", b"x")), CENTRAL, 8, "<H", 1)
    refused(path, "'secret' is encrypted")


def test_other_compressions(cache: Path, tmp_path: Path) -> None:
    info = zipfile.ZipInfo("a")
    info.compress_type = zipfile.ZIP_BZIP2
    refused(zipped(tmp_path / "x.fmu", (info, b"x")), "compressed by method 12")


def test_a_bomb_that_says_so(cache: Path, tmp_path: Path, monkeypatch) -> None:
    path = zipped(tmp_path / "x.fmu", *((f"{i}", bytes(2**20)) for i in range(8)))
    assert path.stat().st_size < 10_000
    monkeypatch.setattr(archive, "LARGEST_MEMBER", 2**20 - 1)
    refused(path, f"'0' has {2**20} bytes unpacked, more than {2**20 - 1}")
    monkeypatch.setattr(archive, "LARGEST_MEMBER", 2**20)
    monkeypatch.setattr(archive, "LARGEST_ARCHIVE", 8 * 2**20 - 1)
    refused(path, f"bytes would be {8 * 2**20} unpacked, more than {8 * 2**20 - 1}")
    monkeypatch.setattr(archive, "LARGEST_ARCHIVE", 8 * 2**20)
    assert len(list(unpacked(path, "FMU").iterdir())) == 8
    monkeypatch.setattr(archive, "MOST_MEMBERS", 7)
    with pytest.raises(InputError, match="8 files and folders, more than 7"):
        unpacked(path, "FMU")


def test_how_much_an_archive_may_grow(cache: Path, tmp_path: Path, monkeypatch) -> None:
    path = zipped(tmp_path / "x.fmu", ("zeros", bytes(8 * 2**20)))
    own = path.stat().st_size
    monkeypatch.setattr(archive, "ALWAYS_ALLOWED", 2**20)
    refused(path, f"its {own} bytes would be {8 * 2**20} unpacked, more than {2**20}")
    monkeypatch.setattr(archive, "ALWAYS_ALLOWED", 8 * 2**20)
    assert unpacked(path, "FMU").is_dir()
    stored = tmp_path / "x.fmu"
    with zipfile.ZipFile(stored, "w") as file:  # an honest one: large, and as large in the file
        file.writestr("data", bytes(2**20))
    monkeypatch.setattr(archive, "ALWAYS_ALLOWED", 1000)
    assert (unpacked(stored, "FMU") / "data").stat().st_size == 2**20


@pytest.mark.slow
def test_the_bounds_as_they_are(cache: Path, tmp_path: Path) -> None:
    """300 MB of zeros in 300 kB, and one folder more than allowed in names alone."""
    path = tmp_path / "x.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file, file.open("zeros", "w") as out:
        for _ in range(300):
            out.write(bytes(10**6))
    refused(path, f"would be 300000000 unpacked, more than {256 * 2**20}")
    names = [f"{i}/" + "/".join("abcdefghi") + "/x" for i in range(2000)]
    refused(zipped(path, *((name, b"") for name in names)), "22001 files and folders")
    refused(zipped(path, ("/".join("a" * 65), b"")), "is no name of a file")


def test_names_that_would_write_into_a_terminal(cache: Path, tmp_path: Path) -> None:
    refused(zipped(tmp_path / "x.fmu", ("a\x1b[31m", b"")), r"'a\\x1b\[31m' is no name of a file")


@pytest.mark.parametrize("damage", ["cut", "changed", "longer", "missing", "a folder's file"])
def test_an_unpacked_file_that_was_damaged_is_repaired(
    damage: str, cache: Path, tmp_path: Path
) -> None:
    content = {"bin/x.so": bytes(range(256)) * 99, "bin/y.so": b"y" * 99, "empty/": b""}
    path = zipped(tmp_path / "x.fmu", *content.items())
    folder = unpacked(path, "FMU")
    library, other = folder / "bin/x.so", folder / "bin/y.so"
    other_before = other.stat().st_ino
    with library.open("r+b") as in_use:  # a process that has it loaded keeps what it has
        if damage == "cut":
            in_use.truncate(99)
        elif damage == "changed":
            in_use.write(b"!")
        elif damage == "longer":
            in_use.seek(0, 2)
            in_use.write(b"!")
        elif damage == "missing":
            library.unlink()
        else:
            (folder / "empty").rmdir()
        in_use.flush()
        inode = os.fstat(in_use.fileno()).st_ino
        assert unpacked(path, "FMU") == folder
        assert (library.stat().st_ino == inode) == (damage == "a folder's file")
    assert library.read_bytes() == content["bin/x.so"]
    assert (folder / "empty").is_dir()
    assert other.stat().st_ino == other_before


def test_a_bomb_that_lies_writes_no_more_than_it_says(
    cache: Path, tmp_path: Path, monkeypatch
) -> None:
    """64 MB that declare 1000 bytes: the checksum of what was said is wrong."""
    path = zipped(tmp_path / "x.fmu", ("bomb", bytes(64 * 2**20)))
    patched(patched(path, CENTRAL, 24, "<I", 1000), LOCAL, 22, "<I", 1000)
    written: list[int] = []
    copy = archive.shutil.copyfileobj

    def counted(source, target, length: int) -> None:
        try:
            copy(source, target, length)
        finally:
            written.append(target.tell())

    monkeypatch.setattr(archive.shutil, "copyfileobj", counted)
    refused(path, "not an FMU: Bad CRC-32")
    assert written
    assert max(written) <= 1000


WHOLE = [("modelDescription.xml", b"<a/>" * 50), ("binaries/linux64/x.so", bytes(range(256)))]


@pytest.mark.slow
def test_truncated_at_any_byte(cache: Path, tmp_path: Path) -> None:
    path = zipped(tmp_path / "x.fmu", *WHOLE)
    whole = path.read_bytes()
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        refused(path, "not an FMU")


@pytest.mark.interop
@settings(max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(place=st.integers(0, 499), value=st.integers(0, 255))
def test_a_damaged_byte_is_refused_or_harmless(
    place: int, value: int, cache: Path, tmp_path: Path
) -> None:
    path = zipped(tmp_path / "x.fmu", *WHOLE)
    whole = bytearray(path.read_bytes())
    assert len(whole) >= 500
    whole[place] = value
    path.write_bytes(bytes(whole))
    with contextlib.suppress(InputError):  # no other exception
        assert unpacked(path, "FMU") == cache / "unpacked" / content_hash(path)[:24]
    assert {p.name for p in tmp_path.iterdir()} <= {"cache", "x.fmu"}


def test_files_that_are_not_there(cache: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.fmu: No such file"):
        unpacked(tmp_path / "gone.fmu", "FMU")
    (tmp_path / "x.fmu").mkdir()
    with pytest.raises(InputError, match=r"x\.fmu: Is a directory"):
        unpacked(tmp_path / "x.fmu", "FMU")
