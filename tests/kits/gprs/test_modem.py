"""The modem against SIMCom's AT command manual V1.07, and against times that can be computed."""

import pytest

from seatrial.links.text import Outbox
from seatrial_kits.gprs.component import GprsModem
from seatrial_kits.gprs.segments import HEADERS
from tests.devices.running import started

from .dialogue import Dialogue, lines


def connected(**settings):
    dialogue = Dialogue(base={"first": 0}, **settings)
    assert lines(dialogue.connect())[-1] == "CONNECT OK"
    return dialogue


def test_from_power_to_a_network():
    modem = Dialogue(boot_time=3.0, registration_time=8.0, attach_time=2.0)
    assert modem.until(b"+CPIN: READY", 10) == pytest.approx(3.0, abs=0.021)
    assert lines(modem.say("AT+CREG=1")) == ["AT+CREG=1\r", "OK"]
    assert lines(modem.say("ATE0")) == ["ATE0\r", "OK"]
    assert lines(modem.say("AT+CREG?")) == ["+CREG: 1,2", "OK"]
    assert lines(modem.say("AT+CGATT=1")) == ["ERROR"]
    modem.until(b"+CREG: 1", 10)
    assert modem.now == pytest.approx(11.0, abs=0.04)
    assert lines(modem.say("AT+CGATT?")) == ["+CGATT: 0", "OK"]
    modem.run(2.0)
    assert lines(modem.say("AT+CGATT?")) == ["+CGATT: 1", "OK"]
    assert lines(modem.say("AT+CSQ")) == ["+CSQ: 20,0", "OK"]


def test_errors_are_as_they_were_asked_for():
    modem = Dialogue()
    modem.run(4)
    modem.say("ATE0")
    assert lines(modem.say("AT+CIICR")) == ["ERROR"]
    modem.say("AT+CMEE=1")
    assert lines(modem.say("AT+CIICR")) == ["+CME ERROR: 3"]
    modem.say("AT+CMEE=2")
    assert lines(modem.say("AT+CIICR")) == ["+CME ERROR: operation not allowed"]
    assert lines(modem.say("AT+NOSUCH")) == ["ERROR"]
    assert lines(modem.say("AT+CREG=x")) == ["ERROR"]


def test_a_locked_card():
    modem = Dialogue(pin="1234")
    assert b"+CPIN: SIM PIN" in modem.run(4)
    modem.say("ATE0")
    modem.say("AT+CMEE=1")
    assert lines(modem.say("AT+CGATT?")) == ["+CME ERROR: 11"]
    assert lines(modem.say('AT+CPIN="0000"')) == ["+CME ERROR: 16"]
    modem.run(20)
    assert not modem.modem.get("registered")
    assert lines(modem.say('AT+CPIN="1234"')) == ["OK"]
    modem.until(b"Call Ready", 20)


def test_states_of_a_context_and_a_connection():
    modem = Dialogue(base={"first": 0})
    modem.until(b"Call Ready", 60)
    modem.run(3)
    modem.say("ATE0")
    states = []
    for line, seconds in (
        ("AT", 0.2),
        ('AT+CSTT="apn"', 0.2),
        ("AT+CIICR", 3),
        ("AT+CIFSR", 0.2),
        ('AT+CIPSTART="TCP","shore",5000', 3),
        ("AT+CIPCLOSE", 2),
        ("AT+CIPSHUT", 1),
    ):
        said = lines(modem.say(line, seconds))
        status = lines(modem.say("AT+CIPSTATUS"))
        assert status[0] == "OK"
        states.append((said[-1], status[1].removeprefix("STATE: ")))
    assert states == [
        ("OK", "IP INITIAL"),
        ("OK", "IP START"),
        ("OK", "IP GPRSACT"),
        ("10.64.12.7", "IP STATUS"),
        ("CONNECT OK", "CONNECT OK"),
        ("CLOSE OK", "TCP CLOSED"),
        ("SHUT OK", "IP INITIAL"),
    ]


def test_what_cannot_be_connected():
    modem = connected()
    assert lines(modem.say('AT+CIPSTART="TCP","shore",5000')) == ["ERROR", "ALREADY CONNECT"]
    modem.say("AT+CIPCLOSE")
    assert lines(modem.say('AT+CIPSTART="TCP","shore",81', 3)) == [
        "OK",
        "STATE: TCP CLOSED",
        "CONNECT FAIL",
    ]
    assert lines(modem.say("AT+CIPSEND=3")) == ["ERROR"]
    modem.say("AT+CIPSHUT")
    modem.say("AT+CGATT=0")
    assert lines(modem.say('AT+CIPSTART="TCP","shore",5000')) == [
        "OK",
        "STATE: IP INITIAL",
        "CONNECT FAIL",
    ]


@pytest.mark.parametrize("step", [0.005, 0.02])
def test_sent_after_latency_and_throughput(step):
    latency, up, down, answer, size = 0.5, 8000.0, 16000.0, 0.02, 500
    modem = Dialogue(
        step,
        {"first": 0},
        latency=latency,
        uplink_rate=up,
        downlink_rate=down,
        response_time=answer,
    )
    modem.connect()
    assert modem.say(f"AT+CIPSEND={size}") == b"\r\n> "
    modem.send(b"x" * size, step)
    taken = step + modem.until(b"SEND OK", 10)
    expected = 2 * latency + 8 * (size + HEADERS) / up + 8 * (4 + HEADERS) / down + answer
    assert (
        expected <= taken + 1e-9 < expected + 5 * step
    )  # two components, each a step late, both ways
    assert modem.modem.get("bytes_up") == size


def test_a_line_feed_after_a_command_is_no_data():
    modem = connected()
    assert modem.send(b"AT+CIPSEND=3\r\n") == b"\r\n> "
    assert lines(modem.send(b"a\r\n", 3)) == ["SEND OK"]
    assert (modem.modem.get("bytes_up"), modem.base.get("bad")) == (3, 1)


def test_data_until_control_z_and_taken_back_by_escape():
    modem = connected()
    assert modem.say("AT+CIPSEND") == b"\r\n> "
    assert lines(modem.send(b"never\x1b")) == ["OK"]
    modem.say("AT+CIPSEND")
    assert lines(modem.send(b"$PGLT,0,0,0,10,-20,900,150*00\r\n\x1a", 3)) == ["SEND OK"]
    assert (modem.base.get("reports"), modem.base.get("bad")) == (0, 1)  # its checksum is wrong


@pytest.mark.parametrize(
    ("option", "said"),
    [("AT+CIPHEAD=0", b"$PGLM"), ("AT+CIPHEAD=1", b"\r\n+IPD,29:$PGLM")],
)
def test_received_data(option, said):
    modem = Dialogue(base={"waypoint_1": [10, 20, 0], "sides": "port", "radius": 4.0})
    modem.run(4)
    modem.say(option)
    assert said in modem.connect()


def test_as_a_library_drives_it():
    """The order of commands of TinyGSM's driver of SIM800 and SIM900, and what it waits for."""
    modem = Dialogue(base={"waypoint_1": [10, 20, 0], "sides": "port", "radius": 4.0})
    modem.run(4)
    for line, seconds, last in (
        ("AT", 0.2, "OK"),
        ("AT&FZ", 0.2, "OK"),
        ("ATE0", 0.2, "OK"),
        ("AT+CPIN?", 0.2, "OK"),
        ("AT+CREG?", 20, "Call Ready"),
        ("AT+CIPSHUT", 1, "SHUT OK"),
        ("AT+CGATT=0", 1, "OK"),
        ('AT+SAPBR=3,1,"Contype","GPRS"', 0.2, "OK"),
        ('AT+SAPBR=3,1,"APN","apn"', 0.2, "OK"),
        ('AT+CGDCONT=1,"IP","apn"', 0.2, "OK"),
        ("AT+CGACT=1,1", 0.2, "OK"),
        ("AT+SAPBR=1,1", 0.2, "OK"),
        ("AT+SAPBR=2,1", 0.2, "OK"),
        ("AT+CGATT=1", 3, "OK"),
        ("AT+CIPMUX=1", 0.2, "OK"),
        ("AT+CIPQSEND=1", 0.2, "OK"),
        ("AT+CIPRXGET=1", 0.2, "OK"),
        ('AT+CSTT="apn","",""', 0.2, "OK"),
        ("AT+CIICR", 3, "OK"),
        ("AT+CIFSR;E0", 0.2, "OK"),
        ('AT+CDNSCFG="8.8.8.8","8.8.4.4"', 0.2, "OK"),
    ):
        assert lines(modem.say(line, seconds))[-1] == last, line
    said = lines(modem.say('AT+CIPSTART=0,"TCP","shore",5000', 3))
    assert said == ["OK", "0, CONNECT OK", "+CIPRXGET: 1,0"]
    assert lines(modem.say("AT+CIPSTATUS=0")) == [
        '+CIPSTATUS: 0,0,"TCP","shore","5000","CONNECTED"',
        "OK",
    ]
    assert lines(modem.say("AT+CIPRXGET=4,0")) == ["+CIPRXGET: 4,0,29", "OK"]
    assert lines(modem.say("AT+CIPRXGET=2,0,5")) == ["+CIPRXGET: 2,0,5,24", "$PGLM", "OK"]
    assert lines(modem.say("AT+CIPRXGET=3,0,2")) == ["+CIPRXGET: 3,0,2,22", "2C31", "OK"]
    assert modem.say("AT+CIPSEND=0,5") == b"\r\n> "
    assert lines(modem.send(b"hello")) == ["DATA ACCEPT:0,5"]
    assert lines(modem.say("AT+CIPCLOSE=0")) == ["0, CLOSE OK"]
    assert lines(modem.say("AT+CIPSTATUS=0")) == [
        '+CIPSTATUS: 0,0,"TCP","shore","5000","CLOSED"',
        "OK",
    ]


def test_a_short_loss_of_the_network_delays():
    modem = connected(registration_time=2.0)
    modem.say("AT+CREG=1")
    modem.say("AT+CIPSEND=3")
    modem.modem.set("signal_quality", 0.0)
    assert b"+CREG: 2" in modem.send(b"abc", 0.1)
    assert modem.run(20) == b""
    assert lines(modem.say("AT+CSQ")) == []  # it waits for the acknowledgement
    modem.modem.set("signal_quality", 20.0)
    said = lines(modem.run(5))
    assert said == ["+CREG: 1", "SEND OK", "+CSQ: 20,0", "OK"]
    assert modem.base.get("bad") == 0
    assert modem.modem.get("bytes_up") == 3


def test_a_long_loss_of_the_network_ends_the_context():
    modem = connected(drop_time=60.0, send_timeout=45.0)
    modem.say("AT+CIPSEND=3")
    modem.modem.set("signal_quality", 0.0)
    modem.send(b"abc", 0.02)
    assert modem.until(b"SEND FAIL\r\n\r\nCLOSED", 60) == pytest.approx(45.0, abs=0.1)
    assert modem.until(b"+PDP: DEACT", 60) == pytest.approx(15.0, abs=0.1)
    assert lines(modem.say("AT+CIICR")) == ["ERROR"]
    modem.modem.set("signal_quality", 20.0)
    modem.run(12)
    assert lines(modem.say("AT+CIPSHUT")) == ["SHUT OK"]
    assert lines(modem.say('AT+CIPSTART="TCP","shore",5000', 5))[-1] == "CONNECT OK"
    assert modem.base.get("connections") == 2


def test_closed_by_the_base_station():
    modem = Dialogue(base={"first": 0, "silence": 10.0})
    modem.connect()
    assert modem.until(b"\r\nCLOSED\r\n", 20) < 12.0
    assert lines(modem.say("AT+CIPSTATUS"))[-1] == "STATE: TCP CLOSED"


def test_without_a_supply_it_is_off_and_forgets():
    modem = connected()
    modem.modem.set("supply", 3.0)
    assert modem.run(1) == b""
    assert (modem.modem.get("state"), modem.modem.get("current")) == ("OFF", 0.0)
    modem.modem.set("supply", 7.4)
    assert b"RDY" in modem.run(4)
    assert lines(modem.say("AT+CIPSTATUS"))[-1] == "STATE: IP INITIAL"


def test_what_it_draws_is_what_its_radio_does():
    modem = connected(uplink_rate=1000.0, idle_current=0.02, sending_current=0.3)
    modem.run(5)
    assert modem.modem.get("current") == 0.02
    modem.say("AT+CIPSEND=85")
    modem.send(b"x" * 85, 0.02)
    drawn = 0.0
    for _ in range(250):
        modem.run(0.02)
        drawn += (modem.modem.get("current") - 0.02) * 0.02
    assert drawn == pytest.approx((0.3 - 0.02) * 8 * (85 + HEADERS) / 1000.0, abs=0.28 * 0.06)


@pytest.mark.parametrize("mark", ["\x00", "\xff"])
def test_what_is_no_command_is_not_answered(mark):
    modem = Dialogue()
    modem.run(4)
    modem.say("ATE0")
    assert modem.send((mark * 100 + "\r").encode("latin-1")) == b""
    assert lines(modem.say("AT")) == ["OK"]


def test_saved_in_the_middle_of_a_dialogue():
    one, other = connected(), connected()
    for dialogue in (one, other):
        dialogue.say("AT+CIPSEND=10")
    for each in ("modem", "base"):
        state = getattr(one, each).get_state()
        for _ in range(2):
            getattr(one, each).set_state(state)
    assert one.send(b"0123456789", 4) == other.send(b"0123456789", 4)


def test_bad_segments_are_refused_or_dropped():
    modem, box = started(GprsModem), Outbox({})
    box.put(0, b"?")
    modem.set("downlink", box.flush())
    for k in range(2000):
        modem.advance(k * 0.02, 0.02)
    assert modem.get("bytes_down") == 0
