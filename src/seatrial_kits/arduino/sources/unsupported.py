"""Sketch features that the host back end cannot run, with file, line and what to do."""

from __future__ import annotations

import re
import shlex
import subprocess
from collections import Counter
from pathlib import Path

from ..resources import TEXTS
from .libraries import ASSEMBLY, included, read_source
from .limits import absent
from .sketch import Sketch
from .target_board import unconditional
from .tokens import tokens

_ELSE = "use the back end simavr, or"

_HARDWARE = ("avr/", "util/")
_REGISTERS = re.compile(
    r"(?:PORT|DDR|PIN)[A-L]\d?|TCCR\d[ABC]|TCNT\d[HL]?|OCR\d[ABC]?[HL]?|ICR\d[HL]?|TIMSK\d|TIFR\d"
    r"|ADMUX|ADCSR[AB]|ADC[HLW]?|DIDR\d|UCSR\d[ABC]|UBRR\d[HL]?|UDR\d|SP[CSD]R|TW[BSDAC]R|TWAMR"
    r"|EICR[AB]|EIMSK|EIFR|PCICR|PCMSK\d|PCIFR|MCUCR|SMCR|PRR\d?|WDTCSR|ACSR|GTCCR"
    r"|EECR|EEDR|EEAR[HL]?|SPH|SPL|_SFR_\w+|RAMEND"
)
_WORDS = {
    "ISR": "interrupt routines of the hardware are the emulator's: attachInterrupt has edges",
    "SIGNAL": "interrupt routines of the hardware are the emulator's: attachInterrupt has edges",
    "asm": "machine code of the AVR",
    "__asm__": "machine code of the AVR",
    "__heap_start": "the board's memory",
    "__brkval": "the board's memory",
}

_ABSENT = re.compile(r"fatal error: (\S+): No such file")
_UNDECLARED = re.compile(r"error: '(\w+)' was not declared")


def unsupported(sketch: Sketch) -> list[str]:
    """Return what is unsupported, a line each: ``FILE:LINE: WHAT: what to do``.

    A word that a file has again is counted. What lies between #if and #endif is left to the
    compiler: it may be for another board.
    """
    problems = []
    for file in [*sketch.tabs, *sketch.others, *sketch.library_sources()]:
        if file.suffix in ASSEMBLY:
            problems.append(f"{file}:1: {_WORDS['asm']}; use the back end simavr")
            continue
        source = unconditional(read_source(file))
        for header, line in included(source):
            places = (file.parent, sketch.folder, *sketch.libraries)
            own = any((place / header).is_file() for place in places)
            if header.startswith(_HARDWARE) and f"core/{header}" not in TEXTS and not own:
                problems.append(f"{file}:{line}: {_missing(header)}")
        words = [t for t in tokens(source) if t.kind == "word" and _unknown(t.text)]
        counts = Counter(token.text for token in words)
        first = {token.text: token for token in reversed(words)}
        for token in sorted(first.values(), key=lambda token: token.line):
            again = counts[token.text] - 1
            more = f" (and {again} more)" if again else ""
            problems.append(f"{file}:{token.line}: {_unknown(token.text)}{more}")
    return problems


def advice(output: str, family: str) -> list[str]:
    """Return what to do about a compiler's errors, a line each, as far as that is known."""
    found = [_missing(header, family) for header in _ABSENT.findall(output)]
    if family == "avr":
        found += [what for word in _UNDECLARED.findall(output) if (what := _unknown(word))]
    return list(dict.fromkeys(found))


def _unknown(word: str) -> str:
    """Return what to do about a word of the AVR's that the host does not know; '' for others."""
    if _REGISTERS.fullmatch(word):
        return (
            f"{word} is a register of the AVR: {_ELSE} the Arduino API (digitalWrite, "
            "analogWrite, attachInterrupt, ...)"
        )
    return f"{word}: {_WORDS[word]}; {_ELSE} leave it out" if word in _WORDS else ""


def missing_headers(sketch: Sketch, command: list[str], main: Path, family: str) -> list[str]:
    """Return the headers that are included and not there, a line each: ``FILE:LINE: WHAT``.

    ``command`` is the compiler with its options, and ``main`` the file of the joined tabs. The
    preprocessor evaluates the conditions around them, and names all at once.
    """
    absent: list[str] = []
    for source in [main, *sketch.others, *sketch.library_sources()]:
        if source.suffix in ASSEMBLY:
            continue
        done = subprocess.run(
            [*command, "-M", "-MG", str(source)], capture_output=True, text=True, check=False
        )
        headers = shlex.split(done.stdout.replace("\\\n", " ").partition(":")[2])
        absent += [each for each in headers if not Path(each).exists()]
    needs = sketch.project.needs if sketch.project else ()
    more = (
        [f"platformio.ini needs {', '.join(needs)}: 'pio pkg install' brings them"] if needs else []
    )
    return [
        f"{place}: {_missing(header, family)}"
        for header in dict.fromkeys(absent)
        for place in _includes(sketch, header)[:1]
    ] + (more if absent else [])


def _includes(sketch: Sketch, header: str) -> list[str]:
    """Return the places, FILE:LINE, where a header is included."""
    found = []
    for file in sketch.files():
        if file.suffix not in ASSEMBLY:
            lines = [line for name, line in included(read_source(file)) if name == header]
            found += [f"{file}:{line}" for line in lines]
    return found or [str(sketch.folder)]


def _missing(header: str, family: str = "avr") -> str:
    """Return what to do if there is no such header."""
    if what := absent(header, family):
        return f"<{header}>: the back end 'host' of this board has not {what}: leave it out"
    if header.startswith(_HARDWARE):
        return f"<{header}> is of the AVR's hardware: {_ELSE} the Arduino API"
    return (
        f"the library of <{header}> is not there: put its folder into 'libraries' in or beside "
        "the sketch's folder, or name the folder that it is in with the parameter 'libraries'"
    )
