"""Date and time of day of a trial: what every link that sends them says, read by others."""

import datetime
import json
import socket
from pathlib import Path

import dronecan
import pynmea2
import pytest
from dronecan.transport import Frame, Transfer, TransferManager
from nmea2000 import NMEA2000Decoder
from pymavlink import mavutil

from seatrial.errors import InputError
from seatrial.links.text import decode
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.can import operations
from seatrial_kits.can.messages import message

FEED = """
step = "50 ms"
[components]
feed = { fmu = "nmea0183", set = { links = "", sentences = "GPRMC 1" } }
"""
RIG = f"""{FEED}
can  = {{ fmu = "canbus", set = {{ nodes = "gnss" }} }}
gnss = {{ fmu = "nmea2000-node", set = {{ sends = "126992 129029" }} }}
bus  = {{ fmu = "canbus", set = {{ nodes = "fix" }} }}
fix  = {{ fmu = "dronecan-peripheral", set = {{ node_id = 42, gnss_period = "0.5 s" }} }}
boat = {{ fmu = "mavlink", set = {{ links = "udpout:127.0.0.1:PORT", date = "2011-11-11" }} }}
[connections]
"gnss.tx" = "can.tx.n1"
"can.rx.n1" = "gnss.rx"
"fix.tx" = "bus.tx.n1"
"bus.rx.n1" = "fix.rx"
"""
TRIAL = 'rig = "rig.toml"\nstart = "1 s"\nstop = "4 s"\n'
NEW_YEAR = "2027-12-31T23:59:58.500000Z"
"""A second and a half before midnight."""
STARTED = datetime.datetime.fromisoformat(NEW_YEAR).replace(tzinfo=None)


@pytest.fixture
def rig():
    """Give the text of a rig with all links; a socket is there for what MAVLink sends."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        yield RIG.replace("PORT", str(listener.getsockname()[1]))


def ran(write, folder: Path, trial: str, rig: str = FEED, engine: str = "direct") -> Path:
    write("rig.toml", rig)
    result = run_trial(load_trial(str(write("trial.toml", trial))), folder, engine=engine)
    assert result.status == "complete"
    return result.folder


def nmea0183_times(folder: Path) -> list[datetime.datetime]:
    texts = dict.fromkeys(load_run(folder).signals["feed.tx"])
    chunks = [data for text in texts for _, data in decode(text)[1]]
    return [pynmea2.parse(each.decode().strip()).datetime.replace(tzinfo=None) for each in chunks]


def after(*passed: float) -> list[datetime.datetime]:
    return [STARTED + datetime.timedelta(seconds=each) for each in passed]


def frames(folder: Path, port: str):
    """All frames that a node sent."""
    for text in dict.fromkeys(load_run(folder).signals[port]):
        for _, data in decode(text)[1]:
            for operation in operations.decode(data):
                if isinstance(operation, operations.Transmit):
                    yield operation.frame


def nmea2000_times(folder: Path, pgn: int) -> list[datetime.datetime]:
    decoder, found = NMEA2000Decoder(), []
    for frame in frames(folder, "gnss.tx"):
        whole = decoder.decode(message(frame, 1.0))
        if whole is not None and pgn == whole.PGN:
            fields = {each.id: each.raw_value for each in whole.fields}
            since = datetime.timedelta(days=fields["date"], seconds=fields["time"])
            found.append(datetime.datetime(1970, 1, 1) + since)
    return found


def dronecan_times(folder: Path) -> list[datetime.datetime]:
    manager, found = TransferManager(), []
    for frame in frames(folder, "fix.tx"):
        whole = manager.receive_frame(Frame(frame.identifier, frame.data, 0.0, 0.0))
        if not whole:
            continue
        transfer = Transfer()
        transfer.from_frames(whole)
        if (
            dronecan.get_dronecan_data_type(transfer.payload).full_name
            == "uavcan.equipment.gnss.Fix2"
        ):
            unix_us = transfer.payload.gnss_timestamp.usec
            found.append(datetime.datetime(1970, 1, 1) + datetime.timedelta(microseconds=unix_us))
    return found


def mavlink_times(folder: Path) -> list[datetime.datetime]:
    reader, found = mavutil.mavlink_connection(str(folder / "boat.tlog"), dialect="all"), []
    while (beat := reader.recv_match(type="HEARTBEAT")) is not None:
        found.append(datetime.datetime.fromtimestamp(beat._timestamp, datetime.UTC))
    reader.close()
    return [each.replace(tzinfo=None) for each in found]


@pytest.mark.slow
def test_every_link_sends_the_trials_date_and_time(write, tmp_path, rig):
    """The start of the run is that instant, also where simulated time begins at 1 s."""
    text = f'utc = "{NEW_YEAR}"\n{TRIAL}'
    folder = ran(write, tmp_path / "run", text, rig)
    assert nmea0183_times(folder) == after(0, 1, 2)
    # The node claims its address for a quarter of a second; its intervals begin with the run.
    assert nmea2000_times(folder, 126992) == after(1, 2)
    assert nmea2000_times(folder, 129029) == after(1, 2)
    assert dronecan_times(folder)[:3] == after(0, 0.5, 1)
    assert mavlink_times(folder)[:3] == after(0, 1, 2)
    assert json.loads((folder / "manifest.json").read_text())["utc"] == NEW_YEAR
    fmus = load_run(ran(write, tmp_path / "fmus", text, rig, "fmu")).signals
    for port in ("feed.tx", "gnss.tx", "fix.tx"):
        assert list(fmus[port]) == list(load_run(folder).signals[port]), port


@pytest.mark.slow
def test_without_it_links_have_their_own_dates(write, tmp_path, rig):
    own = '[set]\n"fix.date" = "2024-02-29"\n'
    folder = ran(write, tmp_path / "run", TRIAL + own, rig)
    assert nmea0183_times(folder)[0] == datetime.datetime(2020, 1, 1)
    assert nmea2000_times(folder, 126992)[0] == datetime.datetime(2026, 1, 1, 0, 0, 1)
    assert dronecan_times(folder)[0] == datetime.datetime(2024, 2, 29)
    assert mavlink_times(folder)[0] == datetime.datetime(2011, 11, 11)
    assert "utc" not in json.loads((folder / "manifest.json").read_text())


@pytest.mark.parametrize("written", ["2027-12-31T20:59:58.5-03:00", '"2027-12-31T23:59:58.5Z"'])
def test_one_instant_can_be_written_in_several_ways(write, tmp_path, written):
    folder = ran(write, tmp_path / "run", f"utc = {written}\n{TRIAL}")
    assert nmea0183_times(folder)[0] == STARTED


def test_set_of_one_link_goes_before_it(write, tmp_path):
    own = '[set]\n"feed.date" = "2024-02-29"\n'
    folder = ran(write, tmp_path / "run", f'utc = "{NEW_YEAR}"\n{TRIAL}{own}')
    assert nmea0183_times(folder)[0] == datetime.datetime(2024, 2, 29)


def test_now_is_the_clock_and_the_manifest_repeats_it(write, tmp_path):
    before = datetime.datetime.now(datetime.UTC)
    real_time = "[real_time]\nfactor = 100\n"
    folder = ran(write, tmp_path / "now", f'utc = "now"\n{TRIAL}{real_time}')
    started = json.loads((folder / "manifest.json").read_text())["utc"]
    assert before <= datetime.datetime.fromisoformat(started) <= datetime.datetime.now(datetime.UTC)
    again = ran(write, tmp_path / "again", f'utc = "{started}"\n{TRIAL}')
    assert nmea0183_times(again) == nmea0183_times(folder)


@pytest.mark.parametrize(
    ("rig", "written", "said"),
    [
        (FEED, '"now"', "utc: 'now' is for runs in real time only"),
        (FEED, '"2026-06-01T12:00:00"', "utc.*offset from UTC such as 2026-06-01T12:00:00Z"),
        (FEED, "2026-06-01", "utc.*offset from UTC"),
        (FEED, "12", "utc.*offset from UTC"),
        (
            'step = "1 s"\n[components]\nair = { fmu = "wind" }\n',
            f'"{NEW_YEAR}"',
            "utc: no component of the rig has date and time",
        ),
    ],
)
def test_what_is_refused(write, tmp_path, rig, written, said):
    write("rig.toml", rig)
    path = write("trial.toml", f"utc = {written}\n{TRIAL}")
    with pytest.raises(InputError, match=said):
        run_trial(load_trial(str(path)), tmp_path / "run", engine="direct")
    assert not (tmp_path / "run").exists()
