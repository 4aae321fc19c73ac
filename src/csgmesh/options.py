"""Options: an unknown one is an error, never ignored; so is a value of the wrong type or range."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from decimal import Decimal
from numbers import Real
from typing import Any

import numpy as np

from csgmesh.errors import InputError


def near(value: str, known: Iterable[str]) -> str:
    """A sentence that suggests what was meant, or lists what there is.

    Examples
    --------
    >>> near("comprss", ["compress", "encoding"])
    "did you mean 'compress'?"
    >>> near("x", ["compress", "encoding"])
    "there are 'compress', 'encoding'"
    """
    names = list(known)
    # difflib takes time in proportion to the product of all lengths.
    close = [name for name in names if name.casefold() == value.casefold()]
    close = close or difflib.get_close_matches(value[:50], names[:1000], n=3, cutoff=0.5)
    if close:
        return f"did you mean {' or '.join(map(repr, close))}?"
    listed = ", ".join(map(repr, names[:20])) + (", …" if len(names) > 20 else "")
    return f"there are {listed}" if names else "there are none"


def check_options(given: Iterable[str], known: Iterable[str], where: str) -> None:
    """Refuse options that `where` does not know.

    Raises
    ------
    InputError
        Naming the option, with suggestions.

    Examples
    --------
    >>> check_options({"binary": True}, ["binary"], "an .msh file")
    """
    names = list(known)
    for option in given:
        if option not in names:
            raise InputError(f"{where} has no option {option!r}; {near(option, names)}")


def check_choice(option: str, value: object, choices: Iterable[object], where: str) -> None:
    """Refuse a value that is not one of `choices`.

    Examples
    --------
    >>> check_choice("encoding", "raw", ["raw", "base64"], "a .vtu file")
    """
    allowed = list(choices)
    if value not in allowed:
        listed = ", ".join(map(repr, allowed))
        raise InputError(f"{where}: {option} must be one of {listed}; got {value!r}")


def as_real(value: Any) -> float | None:
    """A real number of any type as a float, None for anything else.

    Fractions, decimals, numpy's scalars and arrays without axes are numbers; booleans and text are
    not. What is beyond all floats is infinite.

    Examples
    --------
    >>> from fractions import Fraction
    >>> as_real(Fraction(1, 4)), as_real(np.array(2)), as_real("2"), as_real(True)
    (0.25, 2.0, None, None)
    """
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real | Decimal):
        return None
    try:
        return float(value)
    except OverflowError:
        return float("inf") if value > 0 else float("-inf")  # type: ignore[operator]


def check_real(option: str, value: object, rule: str, holds: Callable[[float], bool]) -> float:
    """A number that meets a rule, as a float.

    Raises
    ------
    InputError
        With the rule and the value.

    Examples
    --------
    >>> check_real("min_angle", 30, "between 0 and 34 degrees", lambda angle: 0 <= angle <= 34)
    30.0
    """
    number = as_real(value)
    if number is None or not holds(number):
        raise InputError(f"{option} must be {rule}; got {value!r}")
    return number


def check_growth(option: str, value: object) -> float:
    """A positive finite number, such as the growth of sizes per unit of length.

    Examples
    --------
    >>> check_growth("gradation", 0.3)
    0.3
    """
    return check_real(option, value, "positive and finite", lambda x: 0 < x < np.inf)


def check_whole(option: str, value: object, least: int) -> int:
    """A whole number as an int; 1e6 is one.

    Examples
    --------
    >>> check_whole("max_points", 1e6, 3)
    1000000
    """
    rule = f"a whole number, at least {least}"
    return int(check_real(option, value, rule, lambda x: x.is_integer() and x >= least))


def check_flag(option: str, value: object) -> bool:
    """True or False.

    Examples
    --------
    >>> check_flag("improve", False)
    False
    """
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{option} must be True or False; got {value!r}")
    return bool(value)
