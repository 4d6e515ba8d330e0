"""Reading what a person wrote: which file is meant, and the message for a mistake in it."""

from __future__ import annotations

import hashlib
import tomllib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import BaseModel, Field

from seatrial.errors import InputError
from seatrial.shipped import provided_folders, shipped_folder
from seatrial.system.files import FileModel, available, find_file, read_toml, validated
from seatrial.system.flattening import load_rig
from seatrial.system.parameters import load_vehicle

RIG = 'title = "{}"\nstep = "20 ms"\n[components]\n'


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


# ---------------------------------------------------------------------- which file

KINDS = ["harness/rigs", "harness/trials", "harness/campaigns", "hil_profiles", "vehicles"]


@pytest.mark.parametrize("kind", KINDS)
def test_in_an_empty_folder_the_shipped_files_are_found(kind: str) -> None:
    files = [path for folder in provided_folders(kind) for path in folder.glob("*.toml")]
    on_disk = {path.stem: path for path in files}
    if kind == "vehicles":
        for folder in provided_folders("harness/vehicles"):
            on_disk |= {path.parent.name: path for path in folder.glob("*/vehicle.toml")}
    assert on_disk
    assert available(kind) == on_disk
    assert {name: find_file(kind, name) for name in on_disk} == on_disk


@pytest.mark.parametrize("kind", KINDS)
def test_a_users_file_wins_over_the_shipped_one_of_the_same_name(kind: str, write) -> None:
    shipped = sorted(available(kind))
    own = write(f"here/{kind}/{shipped[0]}.toml", "")
    other = write(f"here/{kind}/aaa.toml", "")
    write(f"here/{kind}/notes.txt", "")
    write(f"here/{kind}/deep/hidden.toml", "")
    assert find_file(kind, shipped[0]) == own
    assert find_file(kind, "aaa") == other
    found = available(kind)
    assert list(found) == sorted(["aaa", *shipped])
    assert found[shipped[0]] == own
    assert all(found[name].parent != own.parent for name in shipped[1:])
    own.unlink()
    top = "harness" if kind == "vehicles" else kind.partition("/")[0]
    assert find_file(kind, shipped[0]).is_relative_to(shipped_folder(top))


def test_the_users_content_is_what_is_read(write) -> None:
    before = load_rig("landing").file.title
    write("here/harness/rigs/landing.toml", RIG.format("my own"))
    assert before != "my own"
    assert load_rig("landing").file.title == "my own"


def test_a_path_is_relative_to_the_file_that_names_it_or_to_the_current_folder(write, here) -> None:
    mine = write("elsewhere/rigs/boat.toml", RIG.format("elsewhere"))
    write("here/boat.toml", RIG.format("here"))
    write("here/harness/rigs/boat.toml", RIG.format("by name"))
    trials = here.parent / "elsewhere" / "trials"
    assert find_file("harness/rigs", "../rigs/boat.toml", trials) == mine
    assert load_rig("../rigs/boat.toml", trials).file.title == "elsewhere"
    assert load_rig("boat.toml").file.title == "here"
    assert load_rig("boat").file.title == "by name"
    assert load_rig("boat", trials).file.title == "by name"
    assert load_rig(str(mine)).file.title == "elsewhere"
    assert load_rig(str(mine), trials).file.title == "elsewhere"


def test_a_path_never_falls_back_to_a_shipped_file(here: Path) -> None:
    with pytest.raises(InputError) as error:
        find_file("harness/rigs", "hydrone.toml")
    assert str(error.value) == f"there is no file {here / 'hydrone.toml'}"
    (here / "folder.toml").mkdir()
    with pytest.raises(InputError, match=r"there is no file .*folder\.toml"):
        find_file("harness/rigs", "folder.toml")


@pytest.mark.parametrize(
    ("kind", "name", "message"),
    [
        ("harness/rigs", "landnig", r"unknown rig 'landnig'; did you mean 'landing'"),
        ("harness/trials", "hydrone-landin", r"unknown trial .* did you mean 'hydrone-landing'"),
        ("harness/campaigns", "hydrone-pad", r"unknown campaign .* did you mean 'hydrone-pads'"),
        ("vehicles", "hydron", r"unknown vehicle 'hydron'; did you mean 'hydrone'"),
        ("harness/rigs", "mine", r"unknown rig 'mine'; did you mean 'miner'"),
        ("harness/rigs", "zzz", r"\(known: .*landing, .*miner"),
        ("harness/rigs", "", r"unknown rig ''"),
        ("harness/rigs", "zzz", r"or give a path ending in \.toml$"),
        ("harness/rigs", "ardupilot/mine", r"; 'seatrial new ardupilot mine --like KIND'"),
    ],
)
def test_unknown_names_have_near_misses_among_both_folders(kind, name, message, write) -> None:
    write("here/harness/rigs/miner.toml", "")
    with pytest.raises(InputError, match=message):
        find_file(kind, name)


# ---------------------------------------------------------------------- reading


def test_what_was_read_is_said_with_its_hash(write) -> None:
    text = 'title = "Tórshavn"\n'
    path = write("here/boat.toml", text)
    content, source = read_toml(path)
    assert content == {"title": "Tórshavn"}
    assert (source.name, source.path) == ("boat", path)
    assert source.sha256 == hashlib.sha256(text.encode()).hexdigest()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b'a = 1\nb = "open\nc = 2\n', r"not TOML: .*\(at line 2, column \d+\)"),
        (b"a = 1\n\n\nb 2\n", r"not TOML: .*\(at line 4, column 3\)"),
        (b"a = 1\na = 2\n", r"not TOML: Cannot overwrite a value \(at line 2, column"),
        (b"[t]\n[t]\n", r"not TOML: .*line 2"),
        (b"a = [1, 2\n", r"not TOML: .*(line \d|end of document)"),
        (b"a = " + b"9" * 5000, r"not TOML: "),
        (b'title = "T\xf3rshavn"\n', r"not UTF-8 text at byte 10$"),
        (b"\xff\xfea\x00=\x001\x00", r"not UTF-8 text at byte 0$"),
        (b"a = '\x00'", r"not TOML: .*line 1"),
    ],
)
def test_what_cannot_be_read_names_file_and_place(here: Path, text: bytes, message: str) -> None:
    path = here / "boat.toml"
    path.write_bytes(text)
    with pytest.raises(InputError, match=message) as error:
        read_toml(path)
    assert str(error.value).startswith(f"{path}: ")
    with pytest.raises(InputError, match=message):
        load_rig("boat.toml")


def test_the_mark_that_some_editors_of_windows_put_is_no_mistake(here: Path) -> None:
    path = here / "boat.toml"
    path.write_bytes(b'\xef\xbb\xbftitle = "boat"\r\nstep = "1 s"\r\n[components]\r\n')
    assert load_rig("boat.toml").file.title == "boat"
    assert read_toml(path)[1].sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_file_that_is_not_there_or_no_file(here: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.toml: No such file"):
        read_toml(here / "gone.toml")
    with pytest.raises(InputError, match="directory"):
        read_toml(here)


@settings(
    max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None
)
@given(st.one_of(st.binary(max_size=40), st.text("[]=\"'.ab1\n #{},", max_size=30).map(str.encode)))
def test_any_bytes_are_what_tomllib_reads_or_refused(here: Path, data: bytes) -> None:
    path = here / "any.toml"
    path.write_bytes(data)
    try:
        expected = tomllib.loads(data.decode())
    except ValueError:
        if not data.startswith(b"\xef\xbb\xbf"):
            with pytest.raises(InputError, match=r"any\.toml: not "):
                read_toml(path)
    else:
        # repr, because a nan is not equal to itself
        assert repr(read_toml(path)[0]) == repr(expected)


# ---------------------------------------------------------------------- validating


class Leaf(BaseModel):
    model_config = FileModel.model_config  # no subclass: those are the project's own files

    value: float
    kind: str = "plain"


class Tree(BaseModel):
    model_config = FileModel.model_config

    name: str
    count: int = 0
    flag: bool = False
    leaves: dict[str, Leaf] = Field(default_factory=dict)
    row: list[Leaf] = Field(default_factory=list)
    renamed: str = Field("", alias="re-named")


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        ("", ["name: this key is missing"]),
        ("name = 3", ["name: Input should be a valid string, found 3"]),
        ('name = "a"\nnmae = 1', ["nmae: unknown key 'nmae'; did you mean 'name'?"]),
        ('name = "a"\nre-name = "b"', ["re-name: unknown key 're-name'; did you mean 're-named'"]),
        ('name = "a"\ncount = 1.0', ["count: Input should be a valid integer, found 1.0"]),
        ('name = "a"\ncount = "1"', ["count: Input should be a valid integer, found '1'"]),
        ('name = "a"\nflag = 1', ["flag: Input should be a valid boolean, found 1"]),
        ('name = "a"\n[leaves.oak]\nvalu = 1.0', ["leaves.oak.value: this key is missing", "leaves.oak.valu: unknown key 'valu'; did you mean 'value'? (known: kind, value)"]),
        ('name = "a"\n[leaves."a.b"]\nvalue = "x"', ['leaves."a.b".value: Input should be a valid number, found \'x\'']),
        ('name = "a"\nleaves = 3', ["leaves: Input should be a valid dictionary, found 3"]),
        ('name = "a"\n[[row]]\nvalue = 1\n[[row]]\nvalue = 2\nkid = "x"', ["row.1.kid: unknown key 'kid'; did you mean 'kind'? (known: kind, value)"]),
        ("count = true\nx = 1", ["name: this key is missing", "count: Input should be a valid integer, found True", "x: unknown key 'x'; (known: count, flag, leaves, name, re-named, row)"]),
    ],
)  # fmt: skip
def test_every_mistake_names_its_key(text: str, messages: list[str], here: Path) -> None:
    path = here / "tree.toml"
    with pytest.raises(InputError) as error:
        validated(Tree, tomllib.loads(text), path)
    lines = str(error.value).splitlines()
    assert len(lines) == len(messages)
    for line, message in zip(lines, messages, strict=True):
        assert line.startswith(f"{path}: {message}")


def test_what_fits_is_taken_as_it_is(here: Path) -> None:
    text = 'name = "a"\nre-named = "b"\n[leaves.oak]\nvalue = 1'
    tree = validated(Tree, tomllib.loads(text), here / "tree.toml")
    assert (tree.name, tree.renamed, tree.leaves["oak"].value, tree.flag) == ("a", "b", 1.0, False)


def test_mistakes_in_a_rig_name_its_file(write) -> None:
    path = write("here/harness/rigs/mine.toml", 'step = "1 s"\n[components.a]\nfmuu = "x"\n')
    with pytest.raises(InputError) as error:
        load_rig("mine")
    assert str(error.value).splitlines() == [
        f"{path}: components.a.fmuu: unknown key 'fmuu'; did you mean 'fmu'? (known: choices, "
        "fmu, home, interface, isolated, locals, parameters, profile, rig, set, step, sum, timeout, "
        "tolerance, variant)",
    ]


def test_a_vehicle_may_be_the_users_own(write) -> None:
    write("here/vehicles/hydrone.toml", 'title = "mine"\nsource = "me"\n')
    assert load_vehicle("hydrone").file.title == "mine"


def test_a_connection_of_no_known_form_is_one_line(write) -> None:
    head = 'step = "1 s"\n[components.a]\nfmu = "x"\n[connections]\n'
    path = write("here/harness/rigs/mine.toml", head + '"a.y" = 3\n"a.z" = { factor = 2.0 }\n')
    with pytest.raises(InputError) as error:
        load_rig("mine")
    lines = str(error.value).splitlines()
    assert [line.partition(": ")[2].partition(":")[0] for line in lines] == [
        'connections."a.y"', 'connections."a.z"', 'connections."a.z".to',
    ]  # fmt: skip
    assert lines[0].startswith(f"{path}: ")
    assert lines[0].endswith(", found 3")
