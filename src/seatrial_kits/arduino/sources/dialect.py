"""A sketch's source with an AVR board's widths of numbers, for a computer's compiler."""

from __future__ import annotations

import re

from .tokens import Token, tokens

_BINARY = re.compile(r"B[01]{1,8}")
_SUFFIX = re.compile(r"(?P<number>(?:0[xX][0-9a-fA-F']+|0[bB][01']+|[0-9']+))(?P<suffix>[uUlL]+)")
_NAMES = {
    **{f"{u}INT_{end}": f"{u}SHRT_{end}" for u in ("", "U") for end in ("MAX", "MIN")},
    **{f"{u}LONG_{end}": f"{u}INT_{end}" for u in ("", "U") for end in ("MAX", "MIN")},
    **{f"DBL_{what}": f"FLT_{what}" for what in ("MAX", "MIN", "EPSILON", "DIG", "MANT_DIG")},
    **{f"PRI{each}32": f'"l{each}"' for each in "diuoxX"},
}
"""Types, limits and formats by what they are here."""
_TYPES = {"int", "long", "short", "unsigned", "signed", "char", "double"}
_QUALIFIERS = {"const", "volatile"}


def narrowed(source: str) -> str:
    """Return C++ in which int has 16 bits and long 32; lines stay as they are.

    int becomes short, long int, long long stays; suffixes of numbers, B1010, limits and formats
    likewise. That double is float is for ``core/sketch.h``: macros may put its name into others.
    """
    found = list(tokens(source))
    out = [_single(token) for token in found]
    at = 0
    while at < len(found):
        if found[at].text not in _TYPES:
            at += 1
            continue
        run = _run(found, at)
        if len(run) == 1 and found[at].text == "int" and _marks_postfix(found, at):
            at += 1
            continue
        out[run[0]] = _narrow([found[i].text for i in run])
        out[run[0] + 1 : run[-1] + 1] = [""] * (run[-1] - run[0])
        at = run[-1] + 1
    return "".join(out)


def _run(found: list[Token], at: int) -> list[int]:
    """Return the places of the words of one type that begins at ``at``."""
    run = [at]
    while True:
        following = at + 1
        while following < len(found) and found[following].kind == "space":
            following += 1
        if following >= len(found) or found[following].text not in _TYPES | _QUALIFIERS:
            return run
        if "\n" in "".join(t.text for t in found[at + 1 : following]):
            return run  # a directive ends with its line
        run.append(following)
        at = following


def _marks_postfix(found: list[Token], at: int) -> bool:
    """Return whether an int is the parameter that makes an operator ++ or -- a postfix one."""
    before = [t.text for t in found[max(0, at - 40) : at] if t.kind != "space"]
    if before[-1:] not in (["("], [","]) or "operator" not in before:
        return False
    since = before[len(before) - before[::-1].index("operator") :]
    return since[:3] in (["+", "+", "("], ["-", "-", "("]) and ")" not in since


def _narrow(words: list[str]) -> str:
    """Return a type of the board as one of the computer: ``const unsigned`` ... ``int``."""
    kept = [word for word in words if word in _QUALIFIERS]
    longs = words.count("long")
    if "double" in words:  # long double, too: an AVR does not have it
        return " ".join([*kept, "double"])
    kept += [word for word in ("unsigned", "signed") if word in words]
    if "char" in words:
        return " ".join([*kept, "char"])
    return " ".join([*kept, "long long" if longs > 1 else "int" if longs else "short"])


def _single(token: Token) -> str:
    if token.kind == "word":
        if _BINARY.fullmatch(token.text):
            return f"0b{token.text[1:]}"
        return _NAMES.get(token.text, token.text)
    if token.kind == "number" and (match := _SUFFIX.fullmatch(token.text)):
        suffix = match["suffix"].lower()
        long = "" if suffix.count("l") < 2 else "ll"
        return match["number"] + ("u" if "u" in suffix else "") + long
    return token.text
