"""DBC files with numbers beyond any bus: refused by line, in little time and memory."""

from __future__ import annotations

import json
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
