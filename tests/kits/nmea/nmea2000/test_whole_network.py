"""A recording with every PGN that is read, played into a rig: the rig has what was sent."""

import csv

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

from .whole_network import LOG, MESSAGES, ROUNDS, SECOND_GNSS

RIG = """
step = "10 ms"
[components]
recorded = {{ fmu = "can-player", set = {{ file = "{log}" }} }}
boat = {{ fmu = "nmea2000-node" }}
can = {{ fmu = "canbus", set = {{ nodes = "recorded boat" }} }}
[connections]
"can.n1" = "recorded.bus"
"can.n2" = "boat.bus"
"""
TRIAL = """
rig = "rig.toml"
stop = "5.2 s"
"""
DELIVERED = 0.03
"""Time, s, after which a frame of the recording is on the outputs: three steps of the rig."""
ANGLES = 1e-4
"""Resolution of angles, rad; that of the other fields of the recording is finer than 1e-3."""


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    """Rows of the record, from the first message on, by 10 ms."""
    folder = tmp_path_factory.mktemp("network")
    (folder / "rig.toml").write_text(RIG.format(log=LOG))
    (folder / "trial.toml").write_text(TRIAL)
    result = run_trial(load_trial(str(folder / "trial.toml")), folder / "run", engine="direct")
    assert result.status == "complete", result.error
    with (result.folder / "signals.csv").open() as file:
        return list(csv.DictReader(file))


BEGUN = MESSAGES[0][0]


@pytest.mark.parametrize("number", range(len(MESSAGES)))
def test_each_message_is_on_the_outputs_of_the_rig(rows, number):
    time, sent = MESSAGES[number]
    row = rows[round((time - BEGUN + DELIVERED) * 100)]
    for port, wanted in sent.brings.items():
        found = row[f"boat.bus_{port}"]
        if isinstance(wanted, str):
            assert wanted in found.split("; "), port
        else:
            assert float(found) == pytest.approx(wanted, rel=2e-6, abs=0.51 * ANGLES), port
            valid = row.get(f"boat.bus_{port}_valid", "1")
            assert int(valid), port


def test_shares_of_messages_and_the_others_are_counted(rows):
    last = rows[-1]
    counts = dict(each.split() for each in last["boat.bus_messages"].split("; "))
    for pgn in {sent.pgn for _, sent in MESSAGES}:
        sent = [each for _, each in MESSAGES if each.pgn == pgn]
        if any(each.brings for each in sent):
            unused = sum(each.source == SECOND_GNSS for each in sent)
            unused += sum(each.fields.get("source") == "Engine Room Temperature" for each in sent)
            assert counts[str(pgn)] == f"{len(sent) - unused}/{len(sent)}"
    assert last["boat.bus_others"] == f"126720 {ROUNDS}; 127508 {ROUNDS}"
