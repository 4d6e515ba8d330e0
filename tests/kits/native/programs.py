"""Programs of Python by a grammar: the language that becomes C, and what lies just beyond it.

Each is the text of methods of a component, with attributes of its own (their names end in ``_NO_``,
the number of the program), so that many stand in one component.
"""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

HEADER = '''\
"""Written by a grammar."""

import bisect
import functools
import itertools
import math
import random
from typing import NamedTuple

from seatrial.model.component import Component, Input, Output

SCALE = 1.5
LIMITS = (0.25, 0.5, 1.0, 4.0)
WORDS = ("one", "two")
NOTED = []
COUNT = 0


class Pair(NamedTuple):
    left: float
    right: float = 2.0

    def swapped(self):
        return Pair(self.right, self.left)


def halved(x, by=2.0):
    return x / by


def clipped(x, low, high):
    if x < low:
        return low
    return high if x > high else x


def noted(x):
    NOTED.append(x)
    return float(len(NOTED))


def counted():
    global COUNT
    COUNT += 1
    return float(COUNT)


@functools.lru_cache
def remembered(x):
    return x + 0.5


def twice(function):
    @functools.wraps(function)
    def inner(x):
        return 2.0 * function(x)

    return inner


@twice
def decorated(x):
    return x + 1.0
'''

_CLASS = """

class {name}(Component):
    x = Input("1", "a number", start=0.4)
    z = Input("1", "another", start=-1.5)
    n = Input("1", "a whole number", type=int)
    flag = Input("1", "yes or no", type=bool)
    mode = Input("1", "a word", type=str, start="one", choices=("one", "two", "other"))
    y = Output("1", "what comes of it", axes={axes})

    shared = 0.25

    def start(self, t):
{starts}

    def step(self, t, h):
{steps}

    def outputs(self, t):
        self.y = {outputs}
"""


@dataclass
class Program:
    """The text of one program; ``{i}`` in it is its number in the component."""

    lines: list[str]
    methods: list[str] = field(default_factory=list)

    def __repr__(self) -> str:
        return "\n".join([*self.methods, *self.lines])


def component(name: str, programs: Sequence[Program]) -> str:
    """Return the text of a component with these programs."""
    starts, steps, methods = [], [], []
    for i, program in enumerate(programs):
        starts += [f"self.v{i} = 0.0", f"self.k{i} = 0", f"self.ok{i} = False"]
        starts += [f"self.row{i} = [1.0, 2.0, 3.0]", f"self.pair{i} = Pair(1.0)"]
        starts += [f"self.maybe{i} = None", f"self.wait{i} = []"]
        steps += [f"self.run{i}(t, h)"]
        body = "\n".join(f"        {line}" for line in program.lines) or "        pass"
        text = f"\n    def run_NO_(self, t, h):\n{body}\n" + "".join(program.methods)
        methods.append(text.replace("_NO_", str(i)))
    axes = tuple(f"a{i}" for i in range(len(programs)))
    outputs = "".join(f"float(self.v{i}), " for i in range(len(programs)))
    return _CLASS.format(
        name=name,
        axes=repr(axes),
        starts="\n".join(f"        {line}" for line in starts),
        steps="\n".join(f"        {line}" for line in steps),
        outputs=f"({outputs})",
    ) + "".join(methods)


# A capital letter stands for an expression of that kind, a small one for a plain one: floats F and
# f, whole numbers I and i, truth values B and b, lists L and l. $N is a new name.

PLAIN = {
    "F": """self.x;self.z;self.v_NO_;t;h;SCALE;self.shared;0.0;-0.0;1.0;2.5;-3.0;1e9;self.row_NO_[1];
        self.pair_NO_.left;self.pair_NO_[1]""",
    "I": "self.n;self.k_NO_;0;1;3;-2;len(LIMITS)",
    "B": "self.flag;self.ok_NO_;True;False",
    "L": "self.row_NO_;LIMITS;[1.0, -2.0]",
}
WITHIN = {
    "F": """($F + $F);($F - $F);($F * $F);($F / $F);($F // $F);($F % $F);(-$F);abs($F);min($F, $F);
        max($F, $F);math.sin($F);math.cos($F);math.tanh($F);math.floor($F);math.ceil($F);
        math.trunc($F);math.fabs($F);math.sqrt($F);math.log($F);math.exp($F);math.acos($F);
        math.hypot($F, $F);math.atan2($F, $F);math.copysign($F, $F);math.fmod($F, $F);
        math.remainder($F, $F);math.pow($F, $F);($F ** 2);($F ** 0.5);($F ** -1);($F ** $f);
        ($F if $B else $F);float($I);($F * $I);($I / $I);sum($L);min($L);max($L);$L[0];$L[-1];
        $L[$i];sum(q * $f for q in $L);max($I, $F);min($F, $I);halved($F);halved($F, by=$f);
        clipped($F, $F, $f);Pair($F, $F).swapped().left;self.pair_NO_._replace(left=$F).left;
        divmod($F, $F)[0];divmod($F, $F)[1];math.dist(($F, $F), ($f, 0.5));($F or $F);($F and $F);
        self.help_NO_($F);getattr(self, 'v_NO_') + $F;{'one': $F, 'two': $F}['one'];
        {'one': $F}.get(self.mode, $F);round($F);math.log2($F);math.degrees($F);math.tan($F)""",
    "I": """($I + $I);($I - $I);($i * ($I % 97));($I // $I);($I % $I);(-$I);abs($I);min($I, $I);max($I, $I);
        int($F);round($F);len($L);bisect.bisect_left(LIMITS, $F);bisect.bisect_right(LIMITS, $F);
        ($I if $B else $I);($B + $I);divmod($I, $I)[0];sum(1 for q in $L);int($B)""",
    "B": """($F < $F);($F <= $F);($F > $F);($F == $F);($F != $F);($F < $F <= $f);
        ($F < self.help_NO_($F) < $f);($I < $I);($I == $I);($I < $F);(not $B);($B and $B);($B or $B);
        any(q > $F for q in $L);all(q > $F for q in $L);math.isfinite($F);(self.mode == 'two');
        (self.mode != 'one');(self.maybe_NO_ is None);bool($F);bool($i);bool($L);('x' in WORDS);
        (self.help_NO_($f) > $f and self.help_NO_($f) > $f)""",
    "L": """[$F, $f];($F, $f, 0.5);[q + $F for q in $L];[q * $F for q in $L if True];
        [p * q for p, q in zip($L, $L)];[q for i, q in enumerate($L)];list($L);tuple($L);
        list($L)[1:];list($L)[:2];list($L)[::-1];[*$L, $F];[$F] * 2;list(reversed($L));
        [p - q for p, q in itertools.pairwise($L)] + [$F];[q for r in ([$F], [2.0]) for q in r];
        list(q + 1.0 for q in $L);[self.help_NO_(q) for q in $L]""",
}
BEYOND = {
    "F": """round($F, 2);getattr(self, 'absent', $F);min($F, $F, key=abs);math.log($F, 2);
        random.random();noted($F);counted();remembered($F);decorated($F);(lambda q: q + $f)($F);
        ((w := $F) + w);float(len({q % 2.0 for q in $L}));next(q for q in $L);float(len(str($F)));
        sorted($L)[0];math.fsum($L);math.prod($L);functools.reduce(max, $L);sum($L, $F);
        float(len(self.name));self.mode.count('o') * 1.0;$L.index($F) * 1.0;min($L, default=$F);
        sum(map(abs, $L));max(filter(None, $L));self.maybe_NO_ + $F;float($F == self.maybe_NO_);
        (math.nan if $b else $F);math.inf * $F;complex($F).real;[[$F] * 2][0][1];(*$L, $F)[-1];
        (1.0 if self.name == 'x' else $F);[q * $F for q in $L if q > 0.0][0];float('1.5') + $F;
        (self.maybe_NO_ or $F);($F if self.maybe_NO_ is None else self.maybe_NO_)""",
    "I": """(($i % 9) << 3);(($i % 9) ** 3);(2 ** 70 + $i);($i | 4);(~$i);$i.bit_length();
        (9007199254740993 + $i);(3037000500 * 3037000500 * $i);(self.k_NO_ * 4611686018427387904);
        (9223372036854775807 // ($i - 1));sum([$i, $i])""",
    "B": """($B is True);(($f, 1.0) == ($f, 1.0));([$f] == ($f,));($f in $L);
        (self.pair_NO_ == ($f, 2.0));(($i, 2) < ($i, 3));($l is $l);isinstance($i, int);
        isinstance($f, int);isinstance($b, int);hasattr(self, 'absent');callable(self.start);
        ($i in range(3));(math.nan in [$f, math.nan]);(self.mode in WORDS);(self.mode < 'z');
        ($i == $f);(9007199254740993 + $i == 9007199254740992.0);({} == {});($l == $l);
        self.mode.startswith('o');(not self.maybe_NO_)""",
    "L": """[q * $F for q in $L if q > 0.0];[$i, $F];[$F, None];sorted($L);(self.wait_NO_);
        $l or $l;($l if $B else $l);[*{1.0: 2.0}];list(map(abs, $L));[(w := q) for q in $L]""",
}

ASSIGNED = """
self.v_NO_ = $F
self.v_NO_ += $F
self.v_NO_ -= $F
self.v_NO_ *= $F
self.v_NO_ /= $F
self.v_NO_ %= $F
self.k_NO_ += $I
self.k_NO_ = $I
self.ok_NO_ = $B
self.row_NO_ = [self.x, self.z, 0.5]
self.row_NO_ = [q * 0.5 for q in self.row_NO_]
self.row_NO_ = [$F, *self.row_NO_[1:]]
self.pair_NO_ = Pair($F, $f)
self.maybe_NO_ = None
self.maybe_NO_ = $F
self.v_NO_, self.k_NO_ = $F, $I
setattr(self, 'v_NO_', $F)
a, *b = self.row_NO_;self.v_NO_ += a + sum(b)
(a, b), c = ($F, $F), $F;self.v_NO_ += a - b * c
self.wait_NO_.append(self.x);if len(self.wait_NO_) > 2:;    self.v_NO_ += self.wait_NO_.pop(0)
$N = [$F, $F];@[1] = $F;self.v_NO_ += sum(@)
$N = [$F];@.append($F);self.v_NO_ += sum(@)
$N = zip(self.row_NO_, LIMITS);self.v_NO_ += sum(a * b for a, b in @)
for a, b in zip(self.row_NO_, LIMITS):;    self.v_NO_ += a * b
for i in range(3):;    pass;self.v_NO_ += i
self.v_NO_ = self.v_NO_ if self.maybe_NO_ is None else self.maybe_NO_;self.maybe_NO_ = self.x
def $N(a):;    return a + h;self.v_NO_ += @($F)
"""
"""Statements, a line each; within one, semicolons stand between lines, @ is the new name."""

ODD = """
$N = $l;@[0] = $F;self.v_NO_ += sum(@)
$N = self.row_NO_;self.row_NO_[0] = $F;self.v_NO_ += @[0]
$N = list($l);@[0] = $F;self.v_NO_ += @[0]
self.row_NO_[0] += $F
$N = [$F, $F];other = @;@[0] = $F;self.v_NO_ += other[0]
$N = [$F, $F];held = [@, @];@[0] = $F;self.v_NO_ += held[1][0]
$N = [$F, $F];self.row_NO_ = @;@[0] = $F;self.v_NO_ += self.row_NO_[0]
$N = [$F, $F];rest = @ if $B else [1.0];rest[0] = $F;self.v_NO_ += @[0]
$N = [[0.0, 1.0]];for row in @:;    row[0] = $F;self.v_NO_ += @[0][0]
$N = [$F];@ += [$F];self.v_NO_ += sum(@)
for q in self.row_NO_:;    self.row_NO_[1] = q;    self.v_NO_ += q
self.wait_NO_.append((t, self.x));for a, b in self.wait_NO_:;    self.v_NO_ += a + b
self.wait_NO_.append(t);for a in self.wait_NO_:;    self.wait_NO_.pop();    self.v_NO_ += a
self.wait_NO_.append(self.k_NO_);self.v_NO_ += self.wait_NO_[-1]
$N = {'a': $F};@['a'] = $F;self.v_NO_ += @['a']
$N = {'a': $F};other = @;@['a'] = 1.0;self.v_NO_ += other['a']
self.late_NO_ = $F
if $B:;    self.late_NO_ = $F;self.v_NO_ += self.late_NO_
if $B:;    $N = $F;self.v_NO_ += @
$N = 1;if $B:;    @ = 2.5;self.v_NO_ += -@ * 0 + @ // 1
$N = 0 if $B else -1.0;self.v_NO_ += math.atan2(-@, -1.0)
n = 3;while n > 0:;    n -= 1;else:;    self.v_NO_ += 1.0
for q in self.row_NO_:;    if q > $f:;        break;else:;    self.v_NO_ += 1.0
try:;    self.v_NO_ += $F;except ZeroDivisionError:;    self.v_NO_ = 0.0
with open('/dev/null'):;    self.v_NO_ += 1.0
assert $B
$N = [lambda: i for i in range(3)];self.v_NO_ += @[0]()
$N = (i * 1.0 for i in range(3));self.v_NO_ += sum(@) + sum(@)
$N = zip(self.row_NO_, LIMITS);self.v_NO_ += sum(a for a, b in @) + len(list(@))
$N = zip(self.row_NO_, LIMITS);for i in range(3):;    self.v_NO_ += len(list(@))
self.__own_NO_ = 1.0;self.v_NO_ += self.__own_NO_
import math as m;self.v_NO_ += m.pi
del self.maybe_NO_;self.maybe_NO_ = None
$N = {1, 2, 2};self.v_NO_ += len(@)
global COUNT;COUNT += 1;self.v_NO_ += COUNT
def $N(a, b=self.x):;    return a + b;self.x_NO_ = 1.0;self.v_NO_ += @(1.0)
def $N():;    nonlocal h;    h += 1.0;@();self.v_NO_ += h
$N = 1.0;def inner():;    return @;@ = 2.0;self.v_NO_ += inner()
$N = [1.0];def inner():;    @[0] = 5.0;    return 0.0;self.v_NO_ += inner() + @[0]
self.shared += 1.0;self.v_NO_ += self.shared
self.shared = $F;self.v_NO_ += self.shared
type(self).shared += 0.5;self.v_NO_ += self.shared
SCALE = 3.0;self.v_NO_ += SCALE
if self.flag:;    SCALE = 3.0;self.v_NO_ += SCALE
match self.row_NO_:;    case [a, *b]:;        self.v_NO_ += a
match self.pair_NO_:;    case Pair(left=a):;        self.v_NO_ += a
$N = [$F];match @:;    case other:;        other[0] = $F;        self.v_NO_ += @[0]
match self.flag:;    case True:;        self.v_NO_ += 1.0
self.v_NO_ += $N;@ = 1.0
self.values[0] = 3.0
self.k_NO_ = 0.5
self.ok_NO_ = $I
self.maybe_NO_ = $I
$N = [0.0];n = 0;while n < 3:;    @[0] = @[0] + 1.0;    n += 1;self.v_NO_ += @[0]
q = 5.0;self.v_NO_ += sum([q for q in self.row_NO_]) + q
for a, a in zip(self.row_NO_, LIMITS):;    self.v_NO_ += a
for i in range(self.n % 4):;    pass;self.v_NO_ += i
n = 0;while n < 3:;    n += 1;    self.v_NO_ += sum(self.row_NO_);    self.row_NO_ = [$f, 1.0, 0.0]
n = 0;while n < 2:;    if self.maybe_NO_ is None:;        self.maybe_NO_ = 1.0;    else:;        self.v_NO_ += self.maybe_NO_;        self.maybe_NO_ = None;    n += 1
self.v_NO_ += self.help_NO_($F) + self.v_NO_ + self.help_NO_($F)
self.v_NO_ += sum(self.help_NO_(q) for q in self.row_NO_)
self.v_NO_ += sum(a * b for a, b in zip((self.help_NO_(q) for q in $l), $l))
self.v_NO_ += halved(by=self.help_NO_(1.0), x=self.help_NO_(2.0))
self.v_NO_ += {self.help_NO_(1.0): 1.0}.get(2.0, 0.5)
n = 2;while n > -3:;    n -= 1;    $N = self.x / n;self.v_NO_ += n
"""

HELPERS = (
    "return 2.0 * x",
    "self.v_NO_ += x\n        return self.v_NO_",
    "if x > 0.5:\n            return x\n        return -self.k_NO_ * 1.0",
    "self.row_NO_ = [x, *self.row_NO_[1:]]\n        return sum(self.row_NO_)",
    "for q in self.row_NO_:\n            if q > x:\n                return q\n        return x",
    "self.pair_NO_ = Pair(x)\n        return self.pair_NO_.right",
    "self.maybe_NO_ = x if x > 0.0 else None\n        return x",
)
_KINDS = {"v": "F", "k": "I", "o": "B", "r": "L"}
_GAP = re.compile(r"\$([FfIiBbLlN])")


class Writer:
    """Writes a program from random numbers."""

    def __init__(self, draw: random.Random) -> None:
        self.draw = draw
        self.names: dict[str, list[str]] = {kind: [] for kind in PLAIN}
        self.count = 0

    def one_in(self, n: int) -> bool:
        return self.draw.randrange(n) == 0

    def fresh(self) -> str:
        self.count += 1
        return f"w{self.count}"

    def expression(self, kind: str, depth: int) -> str:
        """Return an expression of a kind."""
        own = self.names[kind]
        if own and self.one_in(4):
            return self.draw.choice(own)
        if depth == 0 or self.one_in(3):
            return self.draw.choice(_split(PLAIN[kind]))
        some = BEYOND if self.one_in(80) else WITHIN
        return self.filled(self.draw.choice(_split(some[kind])), depth - 1)

    def filled(self, text: str, depth: int) -> str:
        """Return a text with something in its gaps."""
        name = ""

        def fill(gap: re.Match[str]) -> str:
            nonlocal name
            if gap[1] == "N":
                name = self.fresh()
                return name
            return self.expression(gap[1].upper(), depth if gap[1].isupper() else 0)

        return _GAP.sub(fill, text).replace("@", name)

    def block(self, depth: int) -> list[str]:
        """Return indented statements; names that they set are not known outside."""
        saved = {kind: list(names) for kind, names in self.names.items()}
        lines = [each for _ in range(self.draw.randint(1, 3)) for each in self.statement(depth)]
        self.names = saved
        return [f"    {line}" for line in lines]

    def statement(self, depth: int) -> list[str]:
        """Return the lines of a statement, or of some that belong together."""
        if depth and self.one_in(2):
            return self.draw.choice(self.compound())(depth - 1)
        if self.one_in(3):
            return self.named()
        some = ODD if self.one_in(12) else ASSIGNED
        return self.filled(self.draw.choice(some.strip().split("\n")), 2).split(";")

    def named(self) -> list[str]:
        """Return an assignment to a name, new or known."""
        kind = self.draw.choice("FFIBL")
        value, known = self.expression(kind, 2), self.names[kind]
        if known and self.one_in(2):
            name = self.draw.choice(known)
        else:
            name = self.fresh()
            known.append(name)
        return [f"{name} = {value}"]

    def compound(self) -> list[Callable[[int], list[str]]]:
        return [self._if, self._if, self._for, self._while, self._match, self._leave]

    def _if(self, depth: int) -> list[str]:
        lines = [f"if {self.expression('B', 2)}:", *self.block(depth)]
        if self.one_in(3):
            lines += [f"elif {self.expression('B', 1)}:", *self.block(depth)]
        return [*lines, "else:", *self.block(depth)] if self.one_in(2) else lines

    def _for(self, depth: int) -> list[str]:
        name, kind = self.fresh(), self.draw.choice("IIF")
        whole = ("range(3)", "range(20)", "range(self.n % 5)", "range(4, 0, -1)")
        lists = (self.expression("L", 1), "LIMITS", "reversed(self.row_NO_)")
        over = self.draw.choice(whole if kind == "I" else lists)
        self.names[kind].append(name)
        body = self.block(depth)
        self.names[kind].remove(name)
        if self.one_in(3):
            leave = self.draw.choice(("break", "continue"))
            body += [f"    if {self.expression('B', 1)}:", f"        {leave}"]
            body += ["    self.v_NO_ += 1.0"]
        return [f"for {name} in {over}:", *body]

    def _while(self, depth: int) -> list[str]:
        name, test = self.fresh(), self.draw.choice(("3", "5", "self.n"))
        more = f" and {self.expression('B', 1)}" if self.one_in(3) else ""
        return [
            f"{name} = 0",
            f"while {name} < {test}{more}:",
            f"    {name} += 1",
            *self.block(depth),
        ]

    def _match(self, depth: int) -> list[str]:
        subject, *cases = self.draw.choice(
            (
                ("self.mode", "'one'", "'two' | 'other'", "_"),
                ("self.n % 3", "0", "1", "_"),
                ("self.maybe_NO_", "None", "found if $B", "_"),
            )
        )
        lines = [f"match {subject}:"]
        for case in cases:
            body = [f"    {line}" for line in self.block(depth)]
            lines += [f"    case {self.filled(case, 1)}:", *body]
        return lines

    def _leave(self, depth: int) -> list[str]:
        test = self.expression("B", 1)
        if self.one_in(3):
            return [f"if {test} and self.k_NO_ > 40:", "    raise ValueError('too far')"]
        return [f"if {test}:", *self.block(depth), "    return"]


def _split(texts: str) -> list[str]:
    return [text.strip() for text in texts.replace("\n", " ").split(";") if text.strip()]


def written(seed: int) -> Program:
    """Return the program of a seed."""
    writer = Writer(random.Random(seed))
    lines = [each for _ in range(writer.draw.randint(1, 5)) for each in writer.statement(2)]
    helper = writer.draw.choice(HELPERS)
    return Program(lines, [f"\n    def help_NO_(self, x):\n        {helper}\n"])


# ------------------------------------------------------------------ shrinking


def shorter(program: Program) -> Iterator[Program]:
    """Yield programs without a half of their statements, without a quarter, and so on."""
    body = ast.parse("\n".join(program.lines)).body
    size = len(body) // 2
    while size:
        for at in range(0, len(body), size):
            rest = ast.Module([*body[:at], *body[at + size :]], [])
            yield Program(ast.unparse(rest).split("\n"), program.methods)
        size //= 2


def smaller(program: Program) -> Iterator[Program]:
    """Yield programs with one statement less, or with one expression in the place of its parent."""
    text = "\n".join(program.lines)
    for place in range(sum(1 for _ in ast.walk(ast.parse(text)))):
        for act in (_without, _lifted):
            tree = ast.parse(text)
            if act(tree, place):
                yield Program(ast.unparse(tree).split("\n"), program.methods)


def _without(tree: ast.AST, place: int) -> bool:
    """Take a statement out, or put what is inside it in its place."""
    node = list(ast.walk(tree))[place]
    for parent in ast.walk(tree):
        for name, body in ast.iter_fields(parent):
            if isinstance(body, list) and node in body and isinstance(node, ast.stmt):
                at = body.index(node)
                body[at : at + 1] = getattr(node, "body", [])
                if not body and name == "body":
                    body.append(ast.Pass())
                return True
    return False


def _lifted(tree: ast.AST, place: int) -> bool:
    """Put the first operand of an expression in its place."""
    node = list(ast.walk(tree))[place]
    inner = next((c for c in ast.iter_child_nodes(node) if isinstance(c, ast.expr)), None)
    if not isinstance(node, ast.expr) or inner is None:
        return False
    for parent in ast.walk(tree):
        for name, value in ast.iter_fields(parent):
            if value is node:
                setattr(parent, name, inner)
                return True
    return False
