# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts arguments of Python to the texts of the command line, so that one parser reads both."""
from __future__ import annotations

import functools
import inspect
import operator
import os
import sys
import textwrap
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Callable, TypeVar, Union, cast

import numpy as np
from numpy.typing import ArrayLike

from ._core import Error

#: One flexibility or several: numbers in 1/kg, or a text such as "0.1W" or "1e-3:1e3:61", as on the command line.
Values = Union[float, str, Iterable[float]]
#: (3, 2) for a grid of 3 x 2 cells, in space (3, 2, 2), a text such as "3x2" or "metis:4", or an array or list with the
#: number of a subdomain for each contact.
Subdomains = Union[str, tuple[int, int], tuple[int, int, int], ArrayLike]
#: True for a bar on standard error, or a function of (units done, units in all), called at most 20 times per second.
Progress = Union[bool, Callable[[int, int], object], None]
#: Velocities (vx, vy), in space (vx, vy, vz), by the number of a grain, m/s; numbers count from 0, and -1 is the last.
Prescribed = Mapping[int, Sequence[float]]
#: An option that the compiled module describes, see `takes`.
Option = Union[str, float, bool]
Function = TypeVar("Function", bound=Callable[..., Any])


def takes(described: list[tuple[str, Any, str]], without: Sequence[str] = ()) -> Callable[[Function], Function]:
    """A decorator that replaces **options of a function by keyword arguments (name, default, description). Signature
    and type hints name them, other keywords are refused, and the docstring lists them at "OPTIONS"."""
    options = [one for one in described if one[0] not in without]
    lines = "\n".join(textwrap.fill(text, 110, initial_indent=f"{name:<11}  ", subsequent_indent=" " * 13)
                      for name, _, text in options)

    def changed(function: Function) -> Function:
        own = [one for one in inspect.signature(function).parameters.values() if one.kind != one.VAR_KEYWORD]
        own += [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=value, annotation=type(value).__name__)
                for name, value, _ in options]
        signature = inspect.signature(function).replace(parameters=own)

        @functools.wraps(function)
        def called(*arguments: Any, **keywords: Any) -> Any:
            signature.bind(*arguments, **keywords)  # raises TypeError for what is not known
            return function(*arguments, **keywords)

        setattr(called, "__signature__", signature)
        called.__annotations__ = {one.name: one.annotation for one in own} | {"return": signature.return_annotation}
        if called.__doc__:  # not with python3 -OO
            called.__doc__ = inspect.cleandoc(called.__doc__).replace("OPTIONS", lines)
        return cast(Function, called)

    return changed


def masked(values: object) -> bool:
    """Whether parts of an array are masked. Masked entries are not numbers."""
    return bool(np.ma.is_masked(values))  # type: ignore[no-untyped-call]


def spec(values: Values | None) -> str:
    """Values as a SPEC of the command line, with numbers that read back exactly; None is infinity."""
    if values is None:
        return "inf"
    if isinstance(values, str):
        return values
    if masked(values):
        raise Error(f"values: expected numbers, met an array of which parts are masked: {values!r}")
    if isinstance(values, Iterable) and np.shape(values) != ():  # type: ignore[arg-type]
        return ",".join(spec(value) for value in values)
    if isinstance(values, Iterator):
        return spec(list(values))
    return number(values)


def interval(values: Values | tuple[float, float] | None) -> str:
    """As `spec`, but a tuple of two numbers is a range FROM:TO."""
    if isinstance(values, tuple) and len(values) == 2:
        return f"{number(values[0])}:{number(values[1])}"
    return spec(values)


def number(value: object) -> str:
    return repr(float(value))  # type: ignore[arg-type]


def text(value: object) -> str:
    """The value of a parameter of a case as --set takes it."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return number(value)
    if isinstance(value, str):
        return value
    return ",".join(text(part) for part in value)  # type: ignore[attr-defined]


def settings(parameters: Mapping[str, object]) -> list[tuple[str, str]]:
    return [(key, text(value)) for key, value in parameters.items()]


def subdomains(given: Subdomains) -> str | np.ndarray:
    if isinstance(given, str):
        return given
    if isinstance(given, tuple) and len(given) in (2, 3):
        return "x".join(str(cells) for cells in given)
    numbers = np.asarray(given)
    if numbers.ndim == 0 or numbers.dtype.kind not in "iu" or masked(given):
        raise TypeError("subdomains: expected (columns, rows) or (columns, rows, layers), a text such as 'metis:4', or "
                        f"an array of integers, met {given!r}")
    return numbers.astype(np.int64)


def prescribed(given: Prescribed | None) -> list[tuple[int, tuple[float, ...]]]:
    """Velocities by grains. Raises TypeError for a key that is no grain number, or a value that is not two or three
    numbers."""
    found = []
    for grain, velocity in (given or {}).items():
        if len(velocity) not in (2, 3):
            raise TypeError(f"prescribed: expected two components of the velocity of grain {grain}, or three in space, "
                            f"met {velocity!r}")
        found.append((operator.index(grain), tuple(float(component) for component in velocity)))
    return found


def path(name: str | os.PathLike[str]) -> str:
    found = os.fspath(name)
    if "\0" in found:
        raise Error(f"{found!r}: expected the name of a file, met one with a zero in it")
    return found


class Bar:
    """A bar on standard error, in a terminal or below the cell of a notebook."""

    def __init__(self) -> None:
        self.started = time.monotonic()

    def __call__(self, done: int, total: int) -> None:
        share = done / total if total > 0 else 1.0
        filled = int(30 * share)
        passed = time.monotonic() - self.started
        sys.stderr.write(f"\r[{'#' * filled}{'.' * (30 - filled)}] {done} of {total}, {passed:.0f} s")
        if done >= total:
            sys.stderr.write("\n")
        sys.stderr.flush()


def progress(wanted: Progress) -> Callable[[int, int], object] | None:
    if wanted is None or wanted is False:
        return None
    return Bar() if wanted is True else wanted
