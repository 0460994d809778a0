# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast domain decomposition converges on granular media, and why.

NumPy arrays go in, NumPy arrays and SciPy operators come out:

    packing = nscdd.Packing(x, y, radius)
    parts = nscdd.decompose(packing, subdomains=(3, 2))
    b = nscdd.contraction(parts, epsilon=1e-3, eta=0.3)
    print(nscdd.spectral_radius(b, certify=True))

docs/python.md of the source tree shows more. Lengths are in m, masses in kg, times in s, flexibilities epsilon and
eta in 1/kg. Long work lets other threads run, and Ctrl-C ends it.
"""
from ._core import (ContactNetwork, Decomposition, Error, FrictionSolution, Packing, SpectralRadius, Step,
                    Subdomain, Verdict)
from ._core import version as __version__
from ._friction import ContactProblem, read_contact_problem, reduce_and_solve, solve, write_contact_problem
from ._modes import Mode, mode
from ._operators import Contraction, InterfaceOperator, contraction, spectral_radius
from ._packings import chosen_contacts, contacts, decompose, generate, read_case, read_packing
from ._simulation import Run, simulate
from ._tables import CurveTable, Table, curve, optimum, sweep

__all__ = [
    "ContactNetwork", "ContactProblem", "Contraction", "CurveTable", "Decomposition", "Error", "FrictionSolution",
    "InterfaceOperator", "Mode", "Packing", "Run", "SpectralRadius", "Step", "Subdomain", "Table", "Verdict",
    "__version__", "chosen_contacts", "contacts", "contraction", "curve", "decompose", "generate", "mode", "optimum",
    "read_case", "read_contact_problem", "read_packing", "reduce_and_solve", "simulate", "solve", "spectral_radius",
    "sweep", "write_contact_problem",
]
