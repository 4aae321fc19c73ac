"""Expressions mean what they mean in Python, and never more."""

from __future__ import annotations

import math
import pickle
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from csgmesh.domainfile.expressions import CONSTANTS, FUNCTIONS, Expression
from csgmesh.domainfile.sizes import ExpressionSize, constant_or_size
from csgmesh.errors import ExpressionError, SizeError

NAMES = {"r": 0.5, "width": 3.0, "_n2": -2.0}

#: What a text means to Python, with numpy's functions so that results agree to the last bit.
SCOPE = {
    **{name: function for name, (function, _, _) in FUNCTIONS.items()},
    **{name: np.float64(value) for name, value in {**CONSTANTS, **NAMES}.items()},
    "number": np.float64,
    "__builtins__": {},
}

ATOMS = st.one_of(
    st.integers(0, 99).map("{}.0".format),
    st.floats(0, 1e6).map(repr),
    st.sampled_from(["pi", "e", *NAMES]),
)


def compound(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Texts with operators, signs, parentheses and calls around smaller ones."""
    operator = st.sampled_from([" + ", "-", " * ", "/", "//", " % ", "**"])
    unary = st.sampled_from([name for name, (_, least, _) in FUNCTIONS.items() if least == 1])
    binary = st.sampled_from(["hypot", "atan2", "min", "max"])
    return st.one_of(
        st.tuples(inner, operator, inner).map("".join),
        st.tuples(st.sampled_from(["-", "+", "- "]), inner).map("".join),
        inner.map("({})".format),
        st.tuples(unary, inner).map(lambda t: "{}({})".format(*t)),
        st.tuples(binary, inner, inner).map(lambda t: "{}({}, {})".format(*t)),
    )


@given(st.recursive(ATOMS, compound, max_leaves=12))
def test_results_are_those_of_python(text: str) -> None:
    wrapped = re.sub(r"(?<![\w.])\d+\.\d*(e[-+]?\d+)?", r"number(\g<0>)", text)
    with np.errstate(all="ignore"):
        wanted = float(eval(wrapped, dict(SCOPE)))
    try:
        found = Expression.parse(text).evaluate(NAMES)
    except ExpressionError as error:
        # Python would go on with infinities, and come back from some: 1/exp(1e4) is 0.
        assert any(word in str(error) for word in ("overflow", "division by", "no real number"))
    else:
        assert found == wanted


def test_functions_are_those_of_mathematics() -> None:
    for name, (_, least, _) in FUNCTIONS.items():
        reference = {"abs": abs, "min": min, "max": max}.get(name) or getattr(math, name)
        if name in ("min", "max"):
            least = 2
        arguments = (0.25, 0.75)[:least]
        text = f"{name}({', '.join(map(str, arguments))})"
        assert Expression.parse(text).evaluate({}) == pytest.approx(reference(*arguments))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("-2**2", -4), ("2**-1", 0.5), ("2**3**2", 512), ("7 % -3", -2), ("-7 // 2", -4),
        ("2 - -2", 4), ("1 - 2 - 3", -4), ("8 / 4 / 2", 1), (".5 + 1.", 1.5), ("1e-3*1E3", 1),
        ("$r", 0.5), ("$(2*$r + 1)", 2), ("$r/2", 0.25), ("min(3, 1, 2)", 1), ("max(2)", 2),
        ("cos(pi)", -1), ("log(e)", 1),
    ],
)  # fmt: skip
def test_precedence_and_spelling(text: str, value: float) -> None:
    assert Expression.parse(text).evaluate(NAMES) == pytest.approx(value)


@pytest.mark.parametrize(
    ("text", "offset", "fragment"),
    [
        ("", 0, "empty"), ("  ", 0, "empty"), ("1 +", 3, "not the end"), ("(1", 2, "expected ')'"),
        ("1 2", 2, "unexpected '2'"), ("1, 2", 1, "unexpected ','"), ("max(1,)", 6, "not ')'"),
        ("sin()", 0, "takes 1 arguments, not 0"), ("hypot(1)", 0, "takes 2 arguments, not 1"),
        ("sin", 0, "in parentheses"), ("sine(1)", 0, "did you mean 'sin'"),
        ("1 + rr", 4, "did you mean 'r'"), ("1/(r - r)", 1, "division by zero"),
        ("0**-1", 1, "division by zero"), ("1 % 0", 2, "division by zero"),
        ("sqrt(-1)", 0, "no real number for -1"), ("(-8)**(1/3)", 4, "no real number"),
        ("log(0)", 0, "no real number for 0"), ("exp(1e3)", 0, "overflow"),
        ("1e999", 0, "finite"), ("r.real", 1, "unexpected '.'"), ("r[0]", 1, "unexpected '['"),
        ("__import__('os')", 11, "unexpected \"'\""), ("r = 1", 2, "unexpected '='"),
        ("1 < 2", 2, "unexpected '<'"), ("lambda: 1", 6, "unexpected ':'"),
        ("1_000", 1, "unexpected '_000'"), ("0x10", 1, "unexpected 'x10'"),
        ("٣", 0, "unexpected"), ("2(3)", 1, "unexpected '('"),
    ],
)  # fmt: skip
def test_mistakes_have_a_place(text: str, offset: int, fragment: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        Expression.parse(text).evaluate(NAMES)
    assert fragment in str(caught.value)
    assert caught.value.offset == offset


@given(st.text(alphabet="0123456789.+-*/%(), $erxpi_'\"[]", max_size=40))
def test_any_text_gives_a_number_or_an_error(text: str) -> None:
    try:
        value = Expression.parse(text).evaluate(NAMES)
    except ExpressionError as error:
        assert 0 <= error.offset <= len(text)
    else:
        assert math.isfinite(value)


def test_a_size_in_coordinates() -> None:
    size = ExpressionSize(Expression.parse("0.1 + w*x"), 2, {"w": 0.5})
    points = np.array([[0.0, 0.0], [1.0, 9.0]])
    assert size(points).tolist() == [0.1, 0.6]
    assert size(np.zeros((0, 2))).shape == (0,)
    assert pickle.loads(pickle.dumps(size))(points).tolist() == [0.1, 0.6]


def test_a_size_that_is_not_positive_names_the_point() -> None:
    size = ExpressionSize(Expression.parse("1 - x"), 2)
    with pytest.raises(SizeError, match=r"is -2 at \(3, 4\)"):
        size(np.array([[0.0, 0.0], [3.0, 4.0]]))
    with pytest.raises(SizeError, match="division by zero"):
        ExpressionSize(Expression.parse("1 / x"), 2)(np.zeros((1, 2)))


def test_a_constant_size_is_a_number() -> None:
    assert constant_or_size(Expression.parse("r / 2"), 2, NAMES) == 0.25
    with pytest.raises(ExpressionError, match="as far as the domain has them"):
        constant_or_size(Expression.parse("x + z"), 2, {})
