"""Folders of sketches as clones have them: names of folders, several sketches, cases of headers."""

import pytest

from seatrial.errors import InputError
from seatrial_kits.arduino.build import with_used_libraries
from seatrial_kits.arduino.sources.letter_case import with_other_cases
from seatrial_kits.arduino.sources.sketch import find_sketch

SKETCH = "void setup() {}\nvoid loop() {}\n"


def folder_of(place, **files):
    """Return a folder with these files."""
    place.mkdir()
    for name, text in files.items():
        (place / name.replace("_dot_", ".")).write_text(text)
    return place


def test_a_clone_has_its_repositorys_name(tmp_path):
    place = folder_of(
        tmp_path / "boat-main",
        pilot_dot_ino=SKETCH,
        compass_dot_ino="// void setup() {}\nint heading() { return 0; }\n",
    )
    assert [tab.name for tab in find_sketch(place).tabs] == ["pilot.ino", "compass.ino"]


def test_of_several_sketches_in_a_folder_one_is_named(tmp_path):
    place = folder_of(tmp_path / "code", receiver_dot_ino=SKETCH, sender_dot_ino=SKETCH)
    found = find_sketch(place / "receiver.ino")
    assert [tab.name for tab in found.tabs] == ["receiver.ino"]
    with pytest.raises(InputError, match="no sketch there"):
        find_sketch(place)


def test_a_header_is_found_in_another_case(tmp_path):
    source = (
        '#include "Boat.h"\n#include <Math.h>\n#include <Absent.h>\n#include "same.h"\n' + SKETCH
    )
    place = folder_of(tmp_path / "one", one_dot_ino=source, boat_dot_h="", same_dot_h="")
    cases = tmp_path / "cases"
    found = with_other_cases(find_sketch(place), ["g++", f"-I{place}"], cases)
    assert {f.name: f.read_text() for f in cases.iterdir()} == {
        "Boat.h": "#include <boat.h>\n",
        "Math.h": "#include <math.h>\n",
    }
    assert found.flags == (f"-I{cases}",)


def test_without_other_cases_nothing_changes(tmp_path):
    place = folder_of(tmp_path / "one", one_dot_ino='#include "boat.h"\n' + SKETCH, boat_dot_h="")
    sketch = find_sketch(place)
    assert with_other_cases(sketch, ["g++", f"-I{place}"], tmp_path / "cases") is sketch


def test_a_library_may_be_a_link_to_its_folder(tmp_path):
    folder_of(tmp_path / "clone", compass_dot_h="int heading();", compass_dot_cpp="")
    shelf = tmp_path / "shelf"
    shelf.mkdir()
    (shelf / "compass").symlink_to(tmp_path / "clone")
    place = folder_of(tmp_path / "one", one_dot_ino="#include <compass.h>\n" + SKETCH)
    sketch = find_sketch(place, str(shelf))
    used = with_used_libraries(sketch, ["g++", f"-I{shelf / 'compass'}"], tmp_path / "whole.cpp")
    assert [library.name for library in used.libraries] == ["compass"]
