# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators of the interface, as linear operators of SciPy, and their spectral radius."""
from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse.linalg import LinearOperator

from . import _arguments, _core
from ._core import Decomposition, SpectralRadius


def _applied(apply: Callable[[ArrayLike], np.ndarray], f: ArrayLike) -> np.ndarray:
    """A real operator applied to a vector, which may be complex."""
    given = np.ravel(f)
    if np.iscomplexobj(given):
        return apply(given.real) + 1j * apply(given.imag)
    return apply(given)


class InterfaceOperator(LinearOperator):
    """X_eta = sum_E A_E (M_E + H_E H_E^T / eta)^-1 A_E^T, 1/kg: jumps of velocity caused by interface impulses while
    the contacts act as links of flexibility eta. Symmetric, positive definite for eta > 0. eta = inf is the operator
    without contacts, eta = 0 the rigid limit, which may be singular."""

    def __init__(self, core: _core.InterfaceOperator) -> None:
        super().__init__(np.dtype(float), (core.rows, core.rows))
        self._core = core

    @property
    def eta(self) -> float:
        """Flexibility of the contacts, 1/kg."""
        return self._core.eta

    @property
    def nullity(self) -> int:
        """Dimension of the kernel: 0 for eta > 0, in the rigid limit sum_E rank H_E - rank H."""
        return self._core.nullity

    def solve(self, g: ArrayLike) -> np.ndarray:
        """X_eta^-1 g of a vector, or of each column of a matrix, by one sparse solve with the undivided packing. Raises
        Error for eta = 0."""
        right = np.asarray(g)
        if right.ndim != 2:
            return self._core.solve(g) if right.ndim != 1 else _applied(self._core.solve, right)
        columns = [_applied(self._core.solve, column) for column in right.T]
        return np.column_stack(columns) if columns else np.zeros((self.shape[0], 0))

    @property
    def inverse(self) -> LinearOperator:
        """X_eta^-1 as an operator, such as the `Minv` of scipy.sparse.linalg.eigsh."""
        def solve(g: np.ndarray) -> np.ndarray:
            return _applied(self._core.solve, g)

        return LinearOperator(self.shape, matvec=solve, rmatvec=solve, dtype=float)

    def dense(self) -> np.ndarray:
        """X_eta as a matrix, symmetric to the last bit. It is assembled once and cannot be written to."""
        return self._core.dense()

    def _matvec(self, f: np.ndarray) -> np.ndarray:
        return _applied(self._core.apply, f)

    def _adjoint(self) -> "InterfaceOperator":
        return self

    def __repr__(self) -> str:
        return f"<nscdd.InterfaceOperator of {self.shape[0]} unknowns, eta = {self.eta}>"


class Contraction(LinearOperator):
    """B = I - omega P^-1 S: each iteration multiplies the error of the interface impulses by B. Its eigenvalues are
    real: 1 - omega lambda for the eigenvalues lambda of the symmetric pencil (S, P)."""

    def __init__(self, core: _core.Contraction, parts: Decomposition) -> None:
        super().__init__(np.dtype(float), (core.rows, core.rows))
        self._core = core
        self.parts = parts  #: the decomposition that it belongs to
        self.preconditioner = InterfaceOperator(core.preconditioner)  #: P = X_eta on all contacts
        self.system = InterfaceOperator(core.system)  #: S = X_epsilon on the contacts that Stage 1 works with

    @property
    def relaxation(self) -> float:
        """omega of F <- F + omega (F' - F)."""
        return self._core.relaxation

    def _matvec(self, f: np.ndarray) -> np.ndarray:
        return _applied(self._core.apply, f)

    @property
    def scheme(self) -> str:
        """"nscdd" or "schwarz"."""
        return self._core.scheme

    def _rmatvec(self, f: np.ndarray) -> np.ndarray:
        given = np.ravel(f)
        if self.scheme == "schwarz":
            raise NotImplementedError("the adjoint of the scheme schwarz")
        return given - self.relaxation * self.system.matvec(self.preconditioner.solve(given))

    def __repr__(self) -> str:
        return (f"<nscdd.Contraction of {self.shape[0]} unknowns, epsilon = {self.system.eta}, "
                f"eta = {self.preconditioner.eta}, relaxation = {self.relaxation}>")


def contraction(parts: Decomposition, epsilon: float | str, eta: float | str | None = math.inf, *,
                contacts: str = "all", relaxation: float = 1.0, scheme: str = "nscdd") -> Contraction:
    """The contraction operator of the two-stage algorithm.

    epsilon   flexibility of the contacts, 1/kg, or a text such as "0.1W" in multiples of the mean of W_nn; 0 is rigid
    eta       flexibility of the network that Stage 2 sees, likewise; inf (or None) is the generic algorithm
    contacts  of Stage 1: "all", "active", "unilateral" or "frozen" (see `chosen_contacts`)
    scheme    "nscdd", or "schwarz": block Jacobi with whole masses, which has no eta. Its operator maps resultants of
              contact impulses on the copies of shared grains; `system` is then N_E (M_E + K_E / epsilon)^-1 N_E^T of
              the subdomains, `preconditioner` the inverse of the masses of the copies

    Raises Error for values out of bounds, and if the choice of contacts depends on impulses that all vanish.
    """
    core = _core.contraction(parts, _arguments.spec(epsilon), _arguments.spec(eta), contacts, float(relaxation),
                             scheme)
    return Contraction(core, parts)


def _of(b: Contraction) -> Contraction:
    if not isinstance(b, Contraction):
        raise TypeError(f"b: expected a Contraction, as `contraction` makes it, met {type(b).__name__}")
    return b


@_arguments.takes(_core.spectral_options)
def spectral_radius(b: Contraction, *, threads: int = 0, **options: _arguments.Option) -> SpectralRadius:
    """Spectral radius of a contraction operator, with a bound on its error.

    OPTIONS
    threads      largest number of threads; 0 for all of the machine. No result depends on it

    The tolerance is relative to max(1, rho). The result has the eigenvalues as `low` and `high`. "arpack" neither
    certifies nor finds more than one eigenvalue at each end.

    `converged` of the result is False if the tolerance was not reached. Ctrl-C ends the work between two products or
    solves; the eigenvalues of a dense matrix are one call of LAPACK, which is not interrupted.
    """
    return _core.spectral_radius(_of(b)._core, dict(options), threads)
