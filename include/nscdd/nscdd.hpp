// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// The public face of the library, every header but those of nscdd/mpi: packings, the contact problem, subdomains,
/// contraction operators and their spectral radii, sweeps, and the files these are read from. See docs/architecture.md.
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/contact_solvers/verdict.hpp>
#include <nscdd/core/choice.hpp>
#include <nscdd/core/components.hpp>
#include <nscdd/core/fields.hpp>
#include <nscdd/core/processes.hpp>
#include <nscdd/core/table.hpp>
#include <nscdd/core/types.hpp>
#include <nscdd/ddm/bddc.hpp>
#include <nscdd/ddm/contraction.hpp>
#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/ddm/interface.hpp>
#include <nscdd/ddm/interface_operator.hpp>
#include <nscdd/ddm/partitioner.hpp>
#include <nscdd/ddm/partitioners/grid.hpp>
#include <nscdd/ddm/partitioners/metis.hpp>
#include <nscdd/ddm/schwarz.hpp>
#include <nscdd/formats/fclib.hpp>
#include <nscdd/formats/packing_file.hpp>
#include <nscdd/formats/read_model.hpp>
#include <nscdd/linalg/inertia_factor.hpp>
#include <nscdd/mechanics/friction_problem.hpp>
#include <nscdd/mechanics/law.hpp>
#include <nscdd/mechanics/reference_problem.hpp>
#include <nscdd/packing/generator.hpp>
#include <nscdd/packing/generators/deposit.hpp>
#include <nscdd/packing/generators/lattice.hpp>
#include <nscdd/packing/packing.hpp>
#include <nscdd/spectra/optimal_eta.hpp>
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/model.hpp>
#include <nscdd/study/sweep.hpp>
