# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of results by named columns."""
from __future__ import annotations

import math
from inspect import cleandoc
from typing import TYPE_CHECKING

import numpy as np

from . import _arguments, _core
from ._core import Decomposition

if TYPE_CHECKING:
    import pandas


class Table(dict[str, np.ndarray]):
    """Columns by their names, all of one length: a dict of arrays. `units` and `descriptions` have the same keys."""

    def __init__(self, columns: list[tuple[str, str, str, np.ndarray]]) -> None:
        super().__init__((name, values) for name, _, _, values in columns)
        self.units: dict[str, str] = {name: unit for name, unit, _, _ in columns}
        self.descriptions: dict[str, str] = {name: description for name, _, description, _ in columns}

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(next(iter(self.values()))) if self else 0

    def to_pandas(self) -> "pandas.DataFrame":
        """The table as a DataFrame of pandas, which must be installed."""
        import pandas

        return pandas.DataFrame(dict(self))

    def __repr__(self) -> str:
        return f"<nscdd.Table of {self.rows} rows, columns {', '.join(self)}>"


@_arguments.takes(_core.spectral_options)
def sweep(parts: Decomposition, epsilon: _arguments.Values, eta: _arguments.Values | None = math.inf, *,
          relaxation: _arguments.Values = 1.0, gauss_seidel_sweeps: _arguments.Values | None = None,
          contacts: str = "all", scheme: str = "nscdd", progress: _arguments.Progress = None, threads: int = 0,
          **options: _arguments.Option) -> Table:
    """Spectral radii at every point of a sweep: a row for each combination of the values given, the last list running
    fastest. Values are numbers, or texts as `nscdd sweep` takes them: "1e-3:1e3:61", "0.1W,1W".

    relaxation           omega, or "optimal"
    gauss_seidel_sweeps  of an inexact Stage 1; None (or inf) is exact

    The other arguments are those of `contraction` and `spectral_radius`. `progress` counts rows. A row that did not
    converge has False in its column `converged`. Columns:
    """
    how = _core.TableOptions(dict(options), _arguments.progress(progress), threads)
    return Table(_core.sweep(parts, _arguments.spec(epsilon), _arguments.spec(eta), _arguments.spec(relaxation),
                             _arguments.spec(gauss_seidel_sweeps), contacts, scheme, how))


class CurveTable(Table):
    """The rows of curves, one curve after the other, each ascending."""

    def __init__(self, columns: list[tuple[str, str, str, np.ndarray]], status: list[str]) -> None:
        super().__init__(columns)
        #: Of each curve: "proved", "wide" (proved, in a band wider than the tolerance) or "not_converged" (not proved).
        self.status = status

    @property
    def proved(self) -> bool:
        """Whether the band of every curve is within the tolerance everywhere."""
        return all(one == "proved" for one in self.status)


@_arguments.takes(_core.spectral_options, without=["eigenvalues"])
def curve(parts: Decomposition, epsilon: _arguments.Values | tuple[float, float],
          eta: _arguments.Values | tuple[float, float] | None = math.inf, *, tolerance: float = 1e-3,
          relaxation: _arguments.Values = 1.0, contacts: str = "all", scheme: str = "nscdd",
          progress: _arguments.Progress = None, threads: int = 0, **options: _arguments.Option) -> CurveTable:
    """Curves of the spectral radius that are proved between their points, which are placed automatically.

    epsilon, eta   one of them is a range, (1e-3, 1e3) or a text "1e-3:1e3" or "0.1:10W"; there is a curve for every
                   value of the other and every relaxation
    tolerance      of `curve_high` - `curve_low` at a point, times max(1, `subdominant_radius`)

    Over log epsilon (or eta), straight lines from `curve_low` to `curve_low` and from `curve_high` to `curve_high` of
    neighbouring rows lie below and above the subdominant radius all along the curve. Both are nan for a curve with a
    point that did not converge. `progress` counts the points known to be needed so far. The other arguments are those
    of `sweep`. Columns:

    """
    how = _core.TableOptions(dict(options), _arguments.progress(progress), threads)
    return CurveTable(*_core.curve(parts, _arguments.interval(epsilon), _arguments.interval(eta), tolerance,
                                   _arguments.spec(relaxation), contacts, scheme, how))


@_arguments.takes(_core.spectral_options, without=["eigenvalues"])
def optimum(parts: Decomposition, epsilon: _arguments.Values = 0.0, *, contacts: str = "active", scheme: str = "nscdd",
            progress: _arguments.Progress = None, threads: int = 0, **options: _arguments.Option) -> Table:
    """The best flexibility eta of Stage 2, with and without relaxation: a row for each epsilon. `progress` counts rows.
    The columns `status` and `relaxed_status` say how a row was found. The scheme "schwarz" has columns of the best
    relaxation in their place. Columns:
    """
    how = _core.TableOptions(dict(options), _arguments.progress(progress), threads)
    return Table(_core.optimum(parts, _arguments.spec(epsilon), contacts, scheme, how))


if sweep.__doc__ and optimum.__doc__ and curve.__doc__:  # not with python3 -OO
    sweep.__doc__ = cleandoc(sweep.__doc__) + "\n\n" + _core.sweep_columns_text
    optimum.__doc__ = cleandoc(optimum.__doc__) + "\n\n" + _core.optimum_columns_text
    curve.__doc__ = cleandoc(curve.__doc__) + "\n\n" + _core.curve_columns_text
