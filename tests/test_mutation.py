"""Operators of the mutation check: the changes that each makes of a few lines, and what is left out."""

import ast

import pytest

from benchmarks.mutation.operators import mutants

LEFT_OUT = '''
"""Text, 2.0."""
TABLE = {"a": (1.0, 2.0)}

class Part:
    size = Parameter(2.0, "m", "size, at most 3.0", min=-1.0)

def f(x: A[0]) -> B[0]:
    raise InputError(f"{2.0 * x}")
'''


def changed(lines):
    """Return what a function of these lines becomes, by operator."""
    source = "def f(x, y, n):\n" + "".join(f"    {line}\n" for line in lines)
    found = {}
    for mutant in mutants(source.encode(), "f.py"):
        text = mutant.applied(source.encode()).decode()
        ast.parse(text)
        found.setdefault(mutant.operator, set()).add(text.splitlines()[mutant.line - 1].strip())
    return found


@pytest.mark.parametrize(
    ("line", "operator", "expected"),
    [
        ("a = x + y", "operator", {"a = x - y"}),
        ("a = (x) * (y)", "operator", {"a = (x) / (y)"}),
        ("a += y", "operator", {"a -= y"}),
        ("a = x - y", "sign", {"a = -x - y"}),
        ("a = -x", "sign", {"a = x"}),
        ("a = 2 * x**2.0", "factor", {f"a = {c} * x**2.0" for c in ("2.2", "1.8")} | {f"a = 2 * x**{c}" for c in ("2.2", "1.8")}),
        ("a = x < y", "operator", {"a = x > y"}),
        ("a = x[0], x[2]", "index", {"a = x[1], x[2]", "a = x[0], x[1]"}),
        ("a = x.y", "axis", {"a = y.y", "a = x.x"}),
        ("a = math.sin(n)", "function", {"a = math.cos(n)"}),
        ("a = np.abs(n)", "abs", {"a = (n)"}),
        ("a = not n", "not", {"a = n"}),
        ("return n, x", "returned", {"return -(n), x", "return n, -(x)"}),
    ],
)  # fmt: skip
def test_each_operator_changes_one_thing(line, operator, expected):
    assert changed([line])[operator] == expected


def test_data_texts_and_error_paths_are_left_out():
    assert list(mutants(LEFT_OUT.encode(), "part.py")) == []
