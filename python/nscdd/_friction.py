# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact problems with friction."""
from __future__ import annotations

from typing import Any, Callable, Optional

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike

from . import _core
from ._core import FrictionSolution

#: What is shown the solution at every check; where it returns False, the solver stops.
Observer = Optional[Callable[[FrictionSolution], object]]


def _columns(matrix: Any) -> scipy.sparse.csc_matrix:
    """Compressed columns with ascending rows, without a copy where the matrix has them already."""
    columns = scipy.sparse.csc_matrix(matrix, dtype=float)
    if not columns.has_canonical_format:
        columns = columns.copy()  # summing up must not change the caller's matrix
        columns.sum_duplicates()
    return columns


def _each(mu: ArrayLike, contacts: int) -> np.ndarray:
    given = np.asarray(mu, dtype=float)
    return np.full(contacts, float(given)) if given.ndim == 0 else given


def _solved(problem: _core.LocalFrictionProblem, solver: str, tolerance: float, guess: ArrayLike | None,
            callback: Observer, threads: int, order: str, more: dict[str, object]) -> FrictionSolution:
    start = None if guess is None else np.asarray(guess, dtype=float)
    return _core.solve(problem, solver, tolerance, order, more, start, callback, threads)


def solve(W: Any, q: ArrayLike, mu: ArrayLike, *, solver: str = "auto", tolerance: float = 1e-8,
          guess: ArrayLike | None = None, callback: Observer = None, threads: int = 0, order: str = "natural",
          maximum_sweeps: int = 100_000, maximum_factorisations: int = 1000, relaxation: float = 1.0, seed: int = 1,
          check_every: int = 10) -> FrictionSolution:
    """Solves a plane contact problem with friction: impulses r and velocities u = W r + q such that every contact obeys
    Signorini's and Coulomb's laws. Rows 2c and 2c + 1 are the normal and the tangential component of contact c.

    W      symmetric, 1/kg, an array or any matrix of scipy.sparse, stored in full
    q      relative velocities without contact impulses, m/s
    mu     coefficient of friction, one for all contacts or one for each
    solver "auto", "continuation", "newton", "nlgs", "admm" or "apgd"; the other arguments are those of `nscdd solve`
    guess  impulses to start from

    How it ended, `status` of the result says. Raises Error for sizes that do not fit together, numbers that are not
    finite, W that is not symmetric, and a contact whose block of W is not positive definite.
    """
    matrix = _columns(W)
    problem = _core.local_problem(matrix, np.asarray(q, dtype=float), _each(mu, matrix.shape[0] // 2))
    return _solved(problem, solver, tolerance, guess, callback, threads, order, dict(
        maximum_sweeps=maximum_sweeps, maximum_factorisations=maximum_factorisations, relaxation=relaxation, seed=seed,
        check_every=check_every))


def reduce_and_solve(M: Any, H: Any, f: ArrayLike, w: ArrayLike, mu: ArrayLike, *, solver: str = "auto",
                     tolerance: float = 1e-8, guess: ArrayLike | None = None, callback: Observer = None,
                     threads: int = 0, order: str = "natural", maximum_sweeps: int = 100_000,
                     maximum_factorisations: int = 1000, relaxation: float = 1.0, seed: int = 1,
                     check_every: int = 10) -> FrictionSolution:
    """The same with the velocities v of the bodies as unknowns: M v = H r + f, u = H^T v + w. They are eliminated, W =
    H^T M^-1 H and q = H^T M^-1 f + w. Solvers that factorise are faster where they know M and H. Also raises Error for
    an M that is not positive definite."""
    columns = _columns(H)
    problem = _core.reduced_problem(_columns(M), columns, np.asarray(f, dtype=float), np.asarray(w, dtype=float),
                                    _each(mu, columns.shape[1] // 2))
    return _solved(problem, solver, tolerance, guess, callback, threads, order, dict(
        maximum_sweeps=maximum_sweeps, maximum_factorisations=maximum_factorisations, relaxation=relaxation, seed=seed,
        check_every=check_every))
