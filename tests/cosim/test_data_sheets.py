"""Parts by name in a profile: what their data sheets say, and what is wrong with them."""

import math
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.shipped import available
from seatrial.system.profile.data_sheets import KIND, data_sheets_of
from seatrial.system.profile.profile import check_profile, load_profile

HEAD = (Path(__file__).parents[2] / "hil_profiles" / "otter.toml").read_text().split("[sensors.")[0]


def profile(folder: Path, sensors: str):
    (folder / "hil_profiles" / "parts").mkdir(parents=True, exist_ok=True)
    path = folder / "hil_profiles" / "boat.toml"
    path.write_text(HEAD + sensors)
    return path


@pytest.mark.parametrize("name", available(KIND))
def test_each_part_is_a_whole_sensor_with_a_source(name, tmp_path):
    path = profile(tmp_path, f'[sensors.own]\npart = "{name}"\n')
    checked = check_profile(path)
    assert checked.parameters("sensors.own")
    assert checked.source("sensors.own").count(":")
    assert checked.notes("sensors.own") == []


def test_own_keys_have_the_last_word(tmp_path):
    text = '[sensors.imu]\npart = "icm-42688-p"\nsource = "mine"\nattitude_time = "4 s"\n'
    read = load_profile(profile(tmp_path, text))
    values = read.parameters("sensors.imu")
    assert values["attitude_time"] == 4.0
    assert values["gyro_noise"] == pytest.approx(math.radians(0.0028))
    assert read.source("sensors.imu").endswith("; mine")


def test_a_part_of_ones_own_stands_beside_the_profile(tmp_path, monkeypatch):
    path = profile(tmp_path, '[sensors.compass]\npart = "mine"\n')
    own = tmp_path / "hil_profiles" / "parts" / "mine.toml"
    own.write_text('kind = "compass"\nsource = "me: 2 deg"\nheading_noise = "2 deg"\n')
    monkeypatch.chdir(tmp_path)
    assert load_profile(path).parameters("sensors.compass")["heading_noise"] == math.radians(2)
    assert list(data_sheets_of(path)) == [own]


@pytest.mark.parametrize(
    ("sensors", "message"),
    [
        ('[sensors.a]\npart = "neo-m8"', r"sensors\.a\.part: unknown part 'neo-m8'; did you mean"),
        ("[sensors.a]\npart = 3", r"sensors\.a\.part: the name of a data sheet is needed, found 3"),
        ('[sensors.a]\npart = "bar30"\nkind = "imu"', r"bar30\.toml is of the kind 'depth', not"),
        ('[sensors.a]\npart = "bar30"\ngyro = "1 m"', r"gyro"),
    ],
)
def test_what_does_not_fit_is_named(sensors, message, tmp_path):
    with pytest.raises(InputError, match=message):
        check_profile(profile(tmp_path, sensors + "\n"))


def test_a_data_sheet_names_no_other(tmp_path, monkeypatch):
    path = profile(tmp_path, '[sensors.a]\npart = "mine"\n')
    (path.parent / "parts" / "mine.toml").write_text('part = "bar30"\n')
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="a data sheet has a kind, and no part of its own"):
        load_profile(path)
