# SPDX-License-Identifier: GPL-3.0-or-later
"""Modes: where the iteration is slow."""
from __future__ import annotations

import numpy as np

from . import _arguments, _core
from ._core import SpectralRadius
from ._operators import Contraction, _of
from ._tables import Table


class Mode:
    """An eigenvector F of a contraction, B F = mu F, and the velocities of the grains in it. The slowest mode is the
    error that remains last. F is scaled to F^T P F = 1 J. There is no mode if the interface is empty, if all
    eigenvalues are equal, or if the solver failed: then `found` is False, and arrays are empty."""

    def __init__(self, core: _core.Mode) -> None:
        self._core = core

    @property
    def found(self) -> bool:
        """Whether there is a mode."""
        return self._core.found

    @property
    def end(self) -> str:
        """The end of the spectrum that it belongs to, "low" or "high"."""
        return self._core.end

    @property
    def eigenvalue(self) -> float:
        """mu. Unit eigenvalues of the rigid limit are left out."""
        return self._core.eigenvalue

    @property
    def next(self) -> float:
        """The next eigenvalue inwards; nan if it is not known. If it equals `eigenvalue`, the mode is one of
        several."""
        return self._core.next

    @property
    def residual(self) -> float:
        """omega ||S F - lambda P F||_{P^-1}, lambda = (1 - mu) / omega: an eigenvalue of B lies within it of mu."""
        return self._core.residual

    @property
    def converged(self) -> bool:
        """Whether the residual is within the tolerance. `spectrum` says whether an eigenvalue may lie further out."""
        return self._core.converged

    @property
    def spectrum(self) -> SpectralRadius:
        """Both ends of the spectrum with their certificate."""
        return self._core.spectrum

    @property
    def impulses(self) -> np.ndarray:
        """F, interface impulses, kg m/s, one for each interface unknown."""
        return self._core.impulses

    @property
    def jumps(self) -> np.ndarray:
        """sum_E A_E V_E, velocities of copies against each other, m/s, one for each interface unknown."""
        return self._core.jumps

    @property
    def velocities(self) -> list[np.ndarray]:
        """V_E of each subdomain, m/s, a row for each of `parts.subdomains[e].grains`: the response of Stage 1 to F."""
        return self._core.velocities

    @property
    def shares(self) -> np.ndarray:
        """Part of each pair of copies in F^T P F; they add up to 1."""
        return self._core.shares

    @property
    def spread(self) -> float:
        """Number of pairs of copies over which the mode spreads; 0 if there is no mode."""
        return self._core.spread

    def impulse_table(self) -> Table:
        """A row for each pair of copies of a shared grain: the table PREFIX-impulses.csv of `nscdd modes`. Raises Error
        for a contact problem, which has no geometry, and so does `velocity_table`."""
        return Table(self._core.impulse_columns())

    def velocity_table(self) -> Table:
        """A row for each copy of each grain: the table PREFIX-velocities.csv of `nscdd modes`."""
        return Table(self._core.velocity_columns())

    def __repr__(self) -> str:
        if not self.found:
            return "<nscdd.Mode: none was found>"
        return (f"<nscdd.Mode of the {self.end} end, eigenvalue = {self.eigenvalue}, residual = {self.residual:.1e}, "
                f"converged = {self.converged}>")


@_arguments.takes(_core.spectral_options)
def mode(b: Contraction, end: str = "slowest", *, threads: int = 0, **options: _arguments.Option) -> Mode:
    """The mode of one end of the spectrum: "slowest" (the end of larger modulus), "low" or "high". The other arguments
    are those of `spectral_radius`."""
    return Mode(_core.mode(_of(b).parts, b._core, end, dict(options), threads))
