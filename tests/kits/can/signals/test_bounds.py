"""DBC files with numbers beyond any bus: refused by line, in little time and memory."""

from __future__ import annotations

import json
import math
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial_kits.can.signals.bounds import LARGEST
from seatrial_kits.can.signals.database import database_of, find_signal, read_database

from .bench import signals

HEAD = 'VERSION ""\n\nBS_:\n\nBU_: A B\n\n'


def message(length: object = 8, *signals: str, number: object = 291, name: str = "M") -> str:
    return f"BO_ {number} {name}: {length} A\n" + "".join(f" SG_ {s}\n" for s in signals)


def signal(name: str = "S", place: str = "0|8@1+", rest: str = '(1,0) [0|0] "" B') -> str:
    return f"{name} : {place} {rest}"


def nested(depth: int, values: int) -> str:
    """Return a message whose multiplexers are in one another: values ** depth codecs."""
    marks = [f"S{i} {'M' if i == 0 else 'm0M' if i < depth else 'm0'}" for i in range(depth + 1)]
    text = message(64, *(signal(mark, f"{8 * i}|8@1+") for i, mark in enumerate(marks)))
    for i in range(depth):
        text += f"SG_MUL_VAL_ 291 S{i + 1} S{i} 0-{values - 1};\n"
    return text


INT = 'BA_DEF_ BO_ "X" INT 0 1;\nBA_DEF_DEF_ "X" 0;\n'
SENDERS = ",".join(f"N{i}" for i in range(60_000))
HOSTILE = {
    "length": (message(100_000, signal()), "line 7: the length of message M, in bytes, is 100000"),
    "start": (message(8, signal(place="2147483648|16@1+")), "line 8: the start bit of signal S"),
    "bits": (message(8, signal(place="0|2000000000@1+")), "line 8: the length of signal S, in bits"),
    "values": (
        message(8, signal("P M"), signal("S m0", "8|8@1+")) + "SG_MUL_VAL_ 291 S P 0-4000000000;\n",
        "line 10: signal S is there for 4000000001 values of P",
    ),
    "negative values": (
        message(8, signal("P M"), signal("S m0")) + "SG_MUL_VAL_ 291 S P -4000000000-1;\n",
        "line 10: signal S is there for",
    ),
    "nested": (nested(4, 100), "at most 20000000 are read"),
    "choices": (
        nested(3, 200) + "VAL_ 291 S2 " + " ".join(f'{i} "v"' for i in range(9000)) + ";\n",
        "at most 20000000 are read",
    ),
    "cycle": (
        message(8, signal("P M"), signal("Q m0M"), signal("R m0M"))
        + "SG_MUL_VAL_ 291 Q R 0-1;\nSG_MUL_VAL_ 291 R Q 0-1;\n",
        "message M: Q is a multiplexer of itself",
    ),
    "exponent": (INT + message(8, signal()) + 'BA_ "X" BO_ 291 1e99999999;\n', "1e99999999 is beyond"),
    "digits": (message("9" * 5000, signal()), "line 7: a number of 5000 characters"),
    "name": (message(8, signal("S" * 100_000)), "line 8: a name of 100000 characters"),
    "identifier": (message(8, signal(), number=2**40), "identifier is 1099511627776"),
    "senders": (message(8, signal()) + f"BO_TX_BU_ 291 : {SENDERS};\n", "more than 256 senders"),
    "many": (
        "".join(message(1785, signal(), number=i, name=f"M{i}") for i in range(2000)),
        "at most 20000000 are read",
    ),
    "large": (" " * LARGEST, "a DBC of more than 4194304 bytes"),
}  # fmt: skip


def test_numbers_beyond_any_bus_are_refused_within_seconds_and_a_gigabyte(tmp_path):
    """In a process of its own with limits: what is read without bounds takes minutes or 12 GB."""
    for name, (text, _) in HOSTILE.items():
        (tmp_path / f"{name}.dbc").write_text(HEAD + text, "utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "tests.kits.can.signals.test_bounds", str(tmp_path)],
        cwd=Path(__file__).parents[4],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-4000:]
    said = json.loads(done.stdout)
    for name, (_, expected) in HOSTILE.items():
        assert expected in said[name], name
        assert said[name].startswith(str(tmp_path / name)), name
        assert len(said[name]) < 2000, name


@pytest.mark.parametrize(
    "text",
    [
        message(64, *(signal(f"S{i}", f"{i}|1@1+") for i in range(512))),
        message(1785, signal(place="0|1600@1+"), number=2147483648 + 0x18FEEC00),  # VIN, as J1939
        message(8, signal("P M"), *(signal(f"S{i} m{i}", "8|16@1+") for i in range(256))),
        nested(2, 16),
        message(0, signal(place="700|64@1-"), number=3221225472, name="VECTOR__INDEPENDENT_SIG_MSG"),
    ],
    ids=["fd", "transport", "multiplexed", "nested", "independent"],
)  # fmt: skip
def test_what_real_buses_have_is_read(text):
    database_of((HEAD + text).encode(), "bus.dbc")


def test_what_is_not_used_may_be_wrong(tmp_path):
    """Signals of other messages that overlap; limits beyond the bits, as generators write them."""
    text = HEAD + message(
        3, signal("Rpm", "0|8@1-", '(1,0) [0|65535] "" B'), number=528, name="Status"
    )
    text += message(1, signal("A"), signal("B", "4|8@1+"), number=529, name="Unused")  # fmt: skip
    file = tmp_path / "own.dbc"
    file.write_text(text, "utf-8")
    node = signals(file, sends="Status.Rpm", cycle_time=0.1)
    mapped = node._sends[0]
    assert (mapped.low, mapped.high) == (0.0, 127.0)
    with pytest.raises(InputError, match=r"own\.dbc: message Unused: .* does not fit"):
        find_signal(file, read_database(file), "Unused.A")


def test_values_at_the_ends_of_the_widest_signals_are_sent(tmp_path):
    """Doubles round 2^64 - 1 up to what 64 bits do not hold."""
    file = tmp_path / "wide.dbc"
    file.write_text(
        HEAD
        + message(8, signal("U", "0|64@1+"), number=1, name="U")
        + message(8, signal("F", "0|64@1-"), number=2, name="F")
        + "SIG_VALTYPE_ 2 F : 2;\n",
        "utf-8",
    )
    node = signals(file, sends="U.U; F.F", cycle_time=0.01)
    node.set("send", [1e300, 1e300, *[0.0] * 14])
    node.advance(0.0, 0.01)
    assert node.get("limited") == 1
    assert node.get("frames_sent") == 2


def _read_all(folder: Path) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (2**30, 2**30))
    resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
    said = {}
    for path in sorted(folder.glob("*.dbc")):
        try:
            read_database(path)
            said[path.stem] = ""
        except InputError as error:
            said[path.stem] = str(error)
    print(json.dumps(said))


if __name__ == "__main__":
    _read_all(Path(sys.argv[1]))


USED = message(2, signal("Level", "0|8@1+", '(1,0) [0|100] "%" B'), number=7, name="Used")
ODD_LINES = {
    "overlap": message(1, signal("A"), signal("B", "4|8@1+"), number=8, name="Unused"),
    "syntax in a signal": message(1, '64_BIT : 0|8@1+ (1,0) [0|1] "" B', number=8, name="Un"),
    "syntax in a message": "BO_ 8 2017_5: 8 B\n SG_ A : 0|8@1+ (1,0) [0|1] \"\" B\n",
    "identifier": message(8, signal(), number=0x10630000, name="Unused"),
    "two of one identifier": message(1, signal(), number=8, name="A")
    + message(1, signal(), number=8, name="B"),
    "the identifier of the used one": message(1, signal(), number=7, name="B"),
    "two of one name": message(1, signal(), number=8, name="A") * 2,
    "values of nothing": 'VAL_ 8 Gone 0 "off" 1 "on" ;\nVAL_ 7 Gone 0 "off" ;\n',
    "comments of nothing": 'CM_ 145 "of a message";\nCM_ SG_ 304 "no signal";\n',
    "keywords in a comment": 'CM_ BO_ 8 "first\nBO_ 9 Not: 8 B\n SG_ There : 0|8@1+";\n',
    "attribute of nothing": 'BA_ "Unheard" BO_ 8 5;\nBA_ "GenSigStartValue" SG_ 7 Gone 3;\n',
    "no statement": "\nthis is no DBC at all\n",
    "two in a line": 'BO_TX_BU_ 8 : A,B; BO_ 10 Third: 1 B\n SG_ C : 0|8@1+ (1,0) [0|0] "" B\n',
}  # fmt: skip


@pytest.mark.parametrize("odd", ODD_LINES)
@pytest.mark.parametrize("before", [False, True])
def test_messages_that_are_not_asked_for_do_not_matter(tmp_path, odd, before):
    file = tmp_path / "bus.dbc"
    both = (ODD_LINES[odd], USED) if before else (USED, ODD_LINES[odd])
    file.write_text(HEAD + "".join(both), "utf-8")
    node = signals(file, sends="Used.Level", cycle_time=0.1)
    assert (node._sends[0].low, node._sends[0].high) == (0.0, 100.0)
    assert node.get("notes") == ""


def test_a_fault_in_a_message_that_is_asked_for_is_an_error_with_its_line(tmp_path):
    file = tmp_path / "bus.dbc"
    file.write_text(HEAD + USED + ODD_LINES["syntax in a signal"], "utf-8")
    line = file.read_text().splitlines().index(' SG_ 64_BIT : 0|8@1+ (1,0) [0|1] "" B') + 1
    with pytest.raises(InputError, match=rf"bus\.dbc: .*line {line}, column"):
        signals(file, sends="Un.64_BIT", cycle_time=0.1)
    with pytest.raises(InputError, match=r"unknown message 'Usd'; did you mean 'Used'"):
        signals(file, sends="Usd.Level")


def test_identifiers_beyond_eleven_bits_are_extended_with_and_without_their_mark(tmp_path):
    file = tmp_path / "own.dbc"
    attributes = 'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\n'
    attributes += 'BA_DEF_DEF_ "GenMsgCycleTime" 0;\nBA_ "GenMsgCycleTime" BO_ 313393063 20;\n'
    value = signal("V", "0|32@1-", '(1,0) [0|0] "" B')
    text = HEAD + message(4, value, number=0x12ADFFA7, name="A") + attributes
    file.write_text(text + "SIG_VALTYPE_ 313393063 V : 1;\n", "utf-8")
    node = signals(file, sends="A.V")
    found = node._sends[0].message
    assert (found.frame_id, found.is_extended_frame, found.cycle_time) == (0x12ADFFA7, True, 20)
    assert node._sends[0].signal.is_float


def test_units_in_words_and_limits_beyond_the_bits_are_notes(tmp_path):
    file = tmp_path / "own.dbc"
    rpm = signal("Rpm", "0|8@1-", '(1,0) [0|65535] "" B')
    state = signal("State", "8|8@1+", '(1,0) [0|255] "state" B')
    far = signal("Far", "16|8@1+", '(1,0) [7000|9000] "" B')
    file.write_text(HEAD + message(3, rpm, state, far, number=528, name="Status"), "utf-8")
    node = signals(file, sends="Status.Rpm; Status.State; Status.Far", cycle_time=0.1)
    assert [(m.low, m.high) for m in node._sends] == [(0.0, 127.0), (0.0, 255.0), (0.0, 255.0)]
    notes = node.get("notes").split("; ")
    assert len(notes) == 3
    assert "Status.Rpm has limits 0 to 65535" in notes[0]
    assert "'state' is not a unit" in notes[1]
    with pytest.raises(InputError, match="'state' is not a unit"):
        signals(file, sends="Status.State 0 1 m")


@pytest.mark.parametrize(
    ("written", "factor", "offset"),
    [("RPM", math.tau / 60.0, 0.0), ("Nm", 1.0, 0.0), ("kph", 1 / 3.6, 0.0), ("Degrees C", 1.0, 273.15),
     ("Volts", 1.0, 0.0), ("Bar", 1e5, 0.0), ("C", 1.0, 273.15), ("Percent", 0.01, 0.0)],
)  # fmt: skip
def test_units_are_read_as_people_write_them(tmp_path, written, factor, offset):
    file = tmp_path / "own.dbc"
    text = signal("Value", "0|8@1+", f'(1,0) [0|255] "{written}" B')
    file.write_text(HEAD + message(1, text, number=1, name="A"), "utf-8")
    node = signals(file, receives="A.Value")
    found = node._receives[0]
    assert found.factor == pytest.approx(factor)
    assert found.offset == pytest.approx(offset)
    assert node.get("notes") == ""
