# SPDX-License-Identifier: GPL-3.0-or-later
"""Packings that move."""
from __future__ import annotations

import os
from typing import Callable, Mapping, Optional

from . import _arguments, _core
from ._core import Packing, Step
from ._tables import Table

#: A function that receives each step once it is taken; if it returns False, the run ends.
StepObserver = Optional[Callable[[Step], object]]


class Run:
    """A finished run of a simulation."""

    def __init__(self, core: _core.Run) -> None:
        self.steps = Table(core.columns)  #: a row for each step: the table `summary` of a trajectory (docs/formats.md)
        self.end = core.end  #: "completed", "at rest", "stopped", "broke down" or "impossible"
        self.reason = core.reason  #: of a breakdown or a step without a solution: its number, and grains or contacts
        self.last = core.last  #: the last good step
        #: the grains at the end: free ones and, as clumps, those of bodies that are free along all directions. The
        #: masses of the grains of a clump are scaled to that of the body; its inertia is then that of its grains. Walls,
        #: planks and cylinders of bodies are left out
        self.packing = core.packing

    def __repr__(self) -> str:
        return f"<nscdd.Run of {self.steps.rows} steps, {self.end}{': ' * bool(self.reason)}{self.reason}>"


def simulate(case: str | os.PathLike[str], *, packing: Packing | None = None,
             subdomains: str | tuple[int, int] | tuple[int, int, int] | None = None,
             settings: Mapping[str, object] | None = None,
             callback: StepObserver = None, progress: _arguments.Progress = None, threads: int = 0) -> Run:
    """Takes the steps of a case file with [dynamics] (docs/cases.md), of a packing file without boundaries, or of a
    folder DATBOX of LMGC90, in memory: nothing is written. Clumps of the packing move as rigid bodies.

    packing     replaces the packing of the case, such as the `packing` of a run that settled it
    subdomains  (columns, rows), in space (columns, rows, layers), or "metis:N"; replaces those of the case
    settings    overrides parameters of the case, {"dynamics.steps": 50, "solver.algorithm": "generic"}
    callback    receives each step once it is taken; if it returns False, the run ends
    progress    counts steps

    Ctrl-C ends the run within a step, between two iterations. A breakdown raises no error: see `end` and `reason`.
    Raises Error for bad input, for a setting without effect, and for a case whose packing another case settles, unless
    `packing` is given.
    """
    cut = None if subdomains is None else _arguments.subdomains(subdomains)
    if cut is not None and not isinstance(cut, str):
        raise TypeError("subdomains: expected (columns, rows), (columns, rows, layers) or a text such as "
                        f"'metis:4', met {subdomains!r}")
    return Run(_core.simulate(_arguments.path(case), packing, cut, _arguments.settings(settings or {}), callback,
                              _arguments.progress(progress), threads))
