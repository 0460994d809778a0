# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact problems with friction."""
from __future__ import annotations

import os
from typing import Any, Callable, Optional

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike

from . import _arguments, _core
from ._core import FrictionSolution, Verdict

#: A function that receives the solution at every check; if it returns False, the solver stops.
Observer = Optional[Callable[[FrictionSolution], object]]


def _columns(matrix: Any, name: str) -> scipy.sparse.csc_matrix:
    """Compressed columns with ascending rows, without a copy where the matrix has them already."""
    given = matrix if scipy.sparse.issparse(matrix) else np.asarray(matrix)
    if given.ndim != 2 or given.dtype.kind not in "biuf" or _arguments.masked(matrix):
        raise _core.Error(f"{name}: expected a matrix of real numbers, met {given.dtype} of shape {given.shape}"
                          f"{', parts of it masked' * _arguments.masked(matrix)}")
    columns = scipy.sparse.csc_matrix(given, dtype=float)
    if not columns.has_canonical_format:
        columns = columns.copy()  # summing up must not change the caller's matrix
        columns.sum_duplicates()
    return columns


def _each(mu: ArrayLike, contacts: int) -> ArrayLike:
    return np.full(contacts, mu) if np.ndim(mu) == 0 else mu


class ContactProblem:
    """A contact problem with friction, in the plane or in space: impulses r and velocities u = W r + q such that every
    contact obeys Signorini's and Coulomb's laws. `ContactProblem(W, q, mu)` has the unknowns of the contacts only.
    `ContactProblem.of_bodies(M, H, f, w, mu)` also has the velocities v of the bodies: M v = H r + f, u = H^T v + w.

    A contact has a row for its normal component, then one for its tangential component, or two in space. A problem is
    in space if W (or H) has three columns for each coefficient of `mu`. Returned arrays are read-only.

    W, M   symmetric, 1/kg or kg, an array or any matrix of scipy.sparse, stored in full
    q, w   relative velocities without contact impulses, or of moving supports, m/s
    f      impulses of the loads and the momentum before
    mu     coefficient of friction, one for each contact, or one number for all of a plane problem

    Raises Error for sizes that do not fit together, numbers that are not finite, W or M that is not symmetric, and a
    contact whose block of W is not positive definite.
    """

    def __init__(self, W: Any, q: ArrayLike, mu: ArrayLike) -> None:
        matrix = _columns(W, "W")
        self._core = _core.local_problem(matrix, q, _each(mu, matrix.shape[0] // 2))

    @classmethod
    def _of(cls, core: _core.ContactProblem) -> "ContactProblem":
        problem = cls.__new__(cls)
        problem._core = core
        return problem

    @classmethod
    def of_bodies(cls, M: Any, H: Any, f: ArrayLike, w: ArrayLike, mu: ArrayLike) -> "ContactProblem":
        """The problem with the velocities of the bodies as unknowns."""
        columns = _columns(H, "H")
        return cls._of(_core.global_problem(_columns(M, "M"), columns, f, w, _each(mu, columns.shape[1] // 2)))

    @property
    def contacts(self) -> int:
        """How many contacts there are."""
        return self._core.contacts

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space: rows per contact."""
        return self._core.dimension

    @property
    def has_bodies(self) -> bool:
        """Whether M, H, f and w are known. If so, W and q are None; else M, H, f and w are None."""
        return self._core.is_global

    @property
    def W(self) -> scipy.sparse.csc_matrix | None:
        """2c x 2c or 3c x 3c, 1/kg; None for a problem with bodies, see `reduced`."""
        return self._core.W

    @property
    def q(self) -> np.ndarray | None:
        """Relative velocities without contact impulses, m/s; None for a problem with bodies."""
        return self._core.q

    @property
    def M(self) -> scipy.sparse.csc_matrix | None:
        """Masses and moments of inertia, n x n; None for a problem without bodies, and so are H, f and w."""
        return self._core.M

    @property
    def H(self) -> scipy.sparse.csc_matrix | None:
        """n x 2c or n x 3c."""
        return self._core.H

    @property
    def f(self) -> np.ndarray | None:
        """Impulses of the loads and the momentum before, n entries."""
        return self._core.f

    @property
    def w(self) -> np.ndarray | None:
        """Relative velocities that moving supports add, m/s."""
        return self._core.w

    @property
    def mu(self) -> np.ndarray:
        """Coefficient of friction of each contact."""
        return self._core.mu

    @property
    def info(self) -> dict[str, str]:
        """Texts of the file: title, description and math_info, as far as it has them."""
        return self._core.info

    @property
    def solution(self) -> dict[str, np.ndarray] | None:
        """The solution stored in the file, or None: impulses r, velocities u, and v of the bodies if there are any."""
        return self._core.solution

    @property
    def guesses(self) -> list[dict[str, np.ndarray]]:
        """Initial guesses stored in the file, with the keys of `solution`."""
        return self._core.guesses

    def reduced(self) -> "ContactProblem":
        """The problem in the unknowns of its contacts: W = H^T M^-1 H and q = H^T M^-1 f + w. Raises Error for an M
        that is not positive definite."""
        return self._of(self._core.reduced())

    @_arguments.takes(_core.friction_options)
    def solve(self, *, guess: ArrayLike | None = None, callback: Observer = None, threads: int = 0,
              **options: _arguments.Option) -> FrictionSolution:
        """Solves it, with the arguments of `nscdd solve`. `status` of the result says how it ended.

        OPTIONS
        guess        impulses to start from, 2c or 3c numbers
        callback     receives the solution at every check; if it returns False, the solver stops

        Solvers that factorise are faster if the problem has bodies.
        """
        return _core.solve(self._core, dict(options), guess, callback, threads)

    def verdict(self, *, threads: int = 0) -> Verdict:
        """Whether a solution exists, with proof, as `nscdd solve --verdict` finds."""
        return _core.verdict(self._core, threads)

    def __repr__(self) -> str:
        return f"<nscdd.ContactProblem of {self.contacts} contacts, {'with' if self.has_bodies else 'without'} bodies>"


def read_contact_problem(path: str | os.PathLike[str]) -> ContactProblem:
    """The contact problem of a file: HDF5 of FCLIB (.h5, .hdf5), or a text of Siconos (.dat). Raises Error naming the
    file, and line or dataset, for input that is wrong or not supported, such as rolling friction."""
    return ContactProblem._of(_core.read_contact_problem(_arguments.path(path)))


def write_contact_problem(path: str | os.PathLike[str], problem: ContactProblem,
                          solution: FrictionSolution | None = None, *, title: str | None = None,
                          description: str | None = None, math_info: str | None = None, force: bool = False) -> None:
    """Writes a contact problem, with its texts and guesses, as HDF5 of FCLIB (.h5, .hdf5), or only the problem as a
    text of Siconos (.dat). A `solution` that converged replaces that of the problem; one that did not is added to the
    guesses. Raises Error if the file exists, unless `force`, and for a solution of another problem."""
    info = [(name, text) for name, text in (("title", title), ("description", description), ("math_info", math_info))
            if text is not None]
    _core.write_contact_problem(problem._core, _arguments.path(path), solution, info, force)


@_arguments.takes(_core.friction_options)
def solve(W: Any, q: ArrayLike, mu: ArrayLike, *, guess: ArrayLike | None = None, callback: Observer = None,
          threads: int = 0, **options: _arguments.Option) -> FrictionSolution:
    """Solves `ContactProblem(W, q, mu)`, with the arguments of its method `solve`. `status` of the result says how it
    ended. Raises Error as ContactProblem does."""
    return ContactProblem(W, q, mu).solve(guess=guess, callback=callback, threads=threads, **options)


@_arguments.takes(_core.friction_options)
def reduce_and_solve(M: Any, H: Any, f: ArrayLike, w: ArrayLike, mu: ArrayLike, *, guess: ArrayLike | None = None,
                     callback: Observer = None, threads: int = 0, **options: _arguments.Option) -> FrictionSolution:
    """Solves `ContactProblem.of_bodies(M, H, f, w, mu)`, with the arguments of its method `solve`. Raises Error as
    ContactProblem does, and for an M that is not positive definite."""
    problem = ContactProblem.of_bodies(M, H, f, w, mu)
    return problem.solve(guess=guess, callback=callback, threads=threads, **options)
