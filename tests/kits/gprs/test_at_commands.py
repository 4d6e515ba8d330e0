"""AT commands: lines as drivers send them, by the syntax of V.250 and 27.007."""

import pytest

from seatrial_kits.gprs.at_commands import LONGEST, Command, Line, read_line


@pytest.mark.parametrize(
    ("line", "commands"),
    [
        ("AT", []),
        ("at", []),
        ("ATE0", [("E", "write", ("0",))]),
        ("ATE0V1&F", [("E", "write", ("0",)), ("V", "write", ("1",)), ("&F", "execute", ())]),
        (
            "AT&FZE0&W",
            [
                ("&F", "execute", ()),
                ("Z", "execute", ()),
                ("E", "write", ("0",)),
                ("&W", "execute", ()),
            ],
        ),
        ("AT+CREG?", [("+CREG", "read", ())]),
        ("AT+CREG=?", [("+CREG", "test", ())]),
        ("at+creg=1", [("+CREG", "write", ("1",))]),
        ("AT+CIFSR;E0", [("+CIFSR", "execute", ()), ("E", "write", ("0",))]),
        ("AT+CSQ;+CREG?", [("+CSQ", "execute", ()), ("+CREG", "read", ())]),
        ('AT+CSTT="a;b","",""', [("+CSTT", "write", ("a;b", "", ""))]),
        (
            'AT+CIPSTART=0,"TCP","1.2.3.4",80',
            [("+CIPSTART", "write", ("0", "TCP", "1.2.3.4", "80"))],
        ),
        ("AT+CFUN=1,1", [("+CFUN", "write", ("1", "1"))]),
        ('AT+CIPSTART="TCP', None),
        ("AT+", None),
        ("AT+CREG?x", None),
        ("HELLO", None),
    ],
)
def test_lines(line, commands):
    found = read_line(line)
    assert found == (None if commands is None else [Command(*each) for each in commands])


def test_a_line_ends_with_a_carriage_return_and_a_slash_says_it_again():
    line = Line({})
    whole = [found for byte in b"AT+CSX\bQ\r\nA/" if (found := line.take(byte)) is not None]
    assert whole == ["AT+CSQ", "AT+CSQ"]


def test_a_line_that_does_not_end_takes_no_more_memory():
    memory = {}
    line = Line(memory)
    for _ in range(10 * LONGEST):
        line.take(ord("A"))
    assert len(memory["line"]) == LONGEST + 1
