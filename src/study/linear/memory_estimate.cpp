// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/memory_estimate.hpp"

#include "core/fail.hpp"
#include "ddm/enriched_inertia.hpp"
#include "ddm/rigid_motions.hpp"
#include "linalg/sparse_entries.hpp"
#include "mechanics/active_set.hpp"

namespace nscdd {
namespace {

constexpr double bytes_per_number = 8;

// P, S, their scaled copy and difference, and the Cholesky factor and reduced matrix of LAPACK. In the rigid
// limit with unit eigenvalues there are also a kernel with its complement, a basis, and the restricted pencil.
constexpr double dense_matrices = 6, rigid_dense_matrices = 13;
// The deflation of ARPACK in the rigid limit splits a dense kernel up to `dense_kernel_limit` unknowns.
constexpr double rigid_kernel_matrices = 5;
// A nonsymmetric matrix, its Hessenberg and Schur forms with their bases, and complex eigenvectors.
constexpr double inexact_matrices = 9;

// Subdomains and undivided packing at eta and at epsilon, and one more while a flexibility changes.
constexpr double factors = 5;
constexpr double factor_fill = 11;  // entries of a CHOLMOD factor over n log2 n
// These four are fitted to the peak memory of shift-invert on lattices of 10^4, 10^5 and 10^6 disks in 16
// parts. On lattices cut down to a few grains per subdomain the estimate is up to 2.1 times what was
// measured, and never below it. Let the saddle point have s rows, and let b be s over the unknowns of the
// undivided packing. The rows of a grain are eliminated together, so an entry of a factor of the packing
// becomes b^2.
//   shift_fill          entries of the factor over s b log2 s
//   shift_fill_finite   how many times more with a finite eta
//   shift_bytes         bytes per grain unknown for matrices and their assembly
//   shift_bytes_finite  how many times more with a finite eta
constexpr double shift_fill = 6.9, shift_fill_finite = 1.2, shift_bytes = 1400, shift_bytes_finite = 1.5;
// In space a factor has some s^(4/3) entries, and what an order of elimination adds for the copies was fitted as b:
// face-centred cubic lattices of 10^3 to 10^5 spheres in 2 x 2 x 2, of 10^4 in 4 x 4 x 4 and 6 x 6 x 6 parts took 14 to
// 38 numbers per b s^(4/3).
constexpr double shift_fill_space = 42;
constexpr double program_bytes = 3e7;  // the program and its libraries, which outweigh small packings
// In the rigid limit the contact impulses are unknowns of their own: a deposit of 10^5 disks in 2 x 2 parts
// took 1.54 GB where a positive epsilon took 0.55 GB. They are also unknowns for the ranks, whose bytes per
// unknown were measured on a lattice of 10^4 disks in 16 strips (0.22 GB in all).
constexpr double rigid_shift = 3, rigid_ranks = 5000;
// Ranks by themselves, and the impulses that take as much, have a row for each grain unknown and for each
// contact. Bytes over m log2 m with m rows: 250 were measured on a lattice of 10^4 disks (0.22 GB in all),
// 130 on a deposit of 5 10^4 disks (0.52 GB).
constexpr double rank_bytes = 300;
// In space m are the rows and columns that clusters and bodies set aside leave, and every contact takes some bytes
// before (0.89 GB in all with ε = 0 for an fcc lattice of 99 452 spheres, of which next to nothing is left). Bytes over
// m^(4/3): 870 and 760 were measured on face-centred cubic lattices of 16^3 and 25^3 spheres in 2 x 2 x 2 parts.
constexpr double rank_bytes_space = 1000, contact_bytes_space = 600;
constexpr double model_bytes = 550;   // per unknown, for geometry, H and A
constexpr double arpack_vectors = 5;  // beside the basis

// Above `dense_impulse_limit` contacts the impulses behind an active set come from a sparse factorisation of
// the packing with its contacts, and their rank from another one, which is larger.
constexpr double dense_impulse_matrices = 2;  // the matrix, and what LAPACK reduces

// Exported operators: S, P and B, each once as it is made and once in the file that HDF5 holds in memory, the bytes of
// that file, and the condensed matrix of a subdomain or the columns at hand. Of sparse ones bytes per unknown of M, H,
// A and W, in the same places.
constexpr double exported_matrices = 12, exported_bytes = 1500;

double square(double x) { return x * x; }

// Unknowns of the grains of all subdomains, copies included.
double unknowns_of(const Model& model) {
  double unknowns = 0;
  for (const Subdomain& subdomain : model.parts.subdomains) unknowns += static_cast<double>(subdomain.inertia.size());
  return unknowns;
}

double model_need(const Model& model) {
  double modes = 0;
  for (const Subdomain& subdomain : model.parts.subdomains)
    if (subdomain.inertia.size() <= InterfaceFamily::default_dense_limit)
      modes += square(static_cast<double>(subdomain.inertia.size()));
  return model_bytes * unknowns_of(model) + bytes_per_number * modes;
}

bool in_space(const Model& model) { return model.problem.dimension == 3; }

// What sparse_rank needs: a factor of a saddle point with these rows and columns.
double factor_need(const Model& model, double rows, double columns) {
  const double n = std::max(rows + columns, 2.0);
  return in_space(model) ? rank_bytes_space * std::pow(n, 4.0 / 3) : rank_bytes * n * std::log2(n);
}

// What the rigid limit of a network in space is worked out from.
struct Network {
  Index d;
  Matrix centres;
  Vector inertia;
  SparseMatrix h;
  RigidNetwork rigid() const { return {d, centres, inertia, h}; }
};

// The subdomain may have no matrices yet.
Network network_of(const Model& model, const Subdomain& subdomain) {
  const ReferenceProblem& problem = model.problem;
  const Index d = problem.dofs_per_grain;
  SparseEntries entries;
  for (Index c = 0; c < count(subdomain.contacts); ++c)
    for (SparseMatrix::InnerIterator e(problem.h, subdomain.contacts[at(c)]); e; ++e) {
      const auto place = std::ranges::lower_bound(subdomain.grains, e.row() / d) - subdomain.grains.begin();
      entries.add(d * place + e.row() % d, c, e.value());
    }
  Network network{d, {}, subdomain.inertia, entries.matrix(d * count(subdomain.grains), count(subdomain.contacts))};
  if (problem.centres.rows() == d) network.centres = problem.centres(Eigen::all, subdomain.grains);
  return network;
}

// What ranks need in space, and the choice of independent contacts: what rigid clusters and bodies set aside leave of
// the whole packing, or of its subdomains at the same time.
double rank_need_in_space(const Model& model) {
  const ReferenceProblem& problem = model.problem;
  Index parts = 0;
  for (const Subdomain& one : model.parts.subdomains) parts += rows_and_columns_left(network_of(model, one).rigid());
  const Index whole = rows_and_columns_left({problem.dofs_per_grain, problem.centres, problem.inertia, problem.h});
  return contact_bytes_space * static_cast<double>(problem.h.cols()) +
         factor_need(model, static_cast<double>(std::max(parts, whole)), 0);
}

// What shift-invert needs in the rigid limit in space. The unknowns of S are the impulses of contacts that are not
// within a cluster, as many as can be independent.
double rigid_need_in_space(const Model& model, bool finite_eta) {
  const double unknowns = unknowns_of(model), interface = static_cast<double>(model.parts.interface_size());
  double rows = interface + (finite_eta ? unknowns : 0);
  for (const Subdomain& one : model.parts.subdomains) {
    const RigidMotions motions = rigid_motions(network_of(model, one).rigid());
    rows += static_cast<double>(std::min(motions.h.rows(), motions.h.cols()));
  }
  const double copies = (unknowns + interface) / std::max(static_cast<double>(model.problem.h.rows()), 1.0);
  return bytes_per_number * shift_fill_space * copies * std::pow(std::max(rows, 2.0), 4.0 / 3) +
         shift_bytes * (finite_eta ? shift_bytes_finite : 1) * unknowns + rank_need_in_space(model);
}

// What the impulses need that choose a set of contacts.
double choice_need(const Model& model, ContactSet contacts) {
  if (contacts == ContactSet::all) return 0;
  if (contacts == ContactSet::active && model.parts.contacts <= dense_impulse_limit)
    return bytes_per_number * dense_impulse_matrices * static_cast<double>(model.problem.h.rows()) *
           static_cast<double>(model.parts.contacts);
  const double rows = unknowns_of(model);
  const auto columns = static_cast<double>(model.parts.contacts);
  // More columns than rows cannot be independent. The unilateral problem takes less than their rank does.
  return factor_need(model, rows, contacts == ContactSet::active ? columns : std::min(rows, columns));
}

// What shift-invert needs for epsilon > 0.
double shifted_need(const Model& model, bool finite_eta) {
  const double unknowns = unknowns_of(model);
  const double rows =
      std::max((finite_eta ? 2 : 1) * unknowns + static_cast<double>(model.parts.interface_size()), 2.0);
  const double rows_per_unknown = rows / std::max(static_cast<double>(model.problem.h.rows()), 1.0);
  if (in_space(model))
    return bytes_per_number * shift_fill_space * rows_per_unknown * std::pow(rows, 4.0 / 3) +
           shift_bytes * (finite_eta ? shift_bytes_finite : 1) * unknowns;
  const double entries = shift_fill * (finite_eta ? shift_fill_finite : 1) * rows * rows_per_unknown * std::log2(rows);
  return bytes_per_number * entries + shift_bytes * (finite_eta ? shift_bytes_finite : 1) * unknowns;
}

double exact_need(const Model& model, const SweepParameters& parameters) {
  const SpectralOptions& options = parameters.spectral;
  const Index size = model.parts.interface_size();
  const auto n = static_cast<double>(size);
  const bool rigid = std::ranges::count(parameters.epsilon, 0.0) > 0;
  const SolverChoice choice = choose_solver(size, options);
  if (choice.solver == SpectralSolver::dense)
    return bytes_per_number * (rigid ? rigid_dense_matrices : dense_matrices) * square(n);
  const double unknowns = std::max(unknowns_of(model), 2.0);
  if (choice.solver == SpectralSolver::shift_invert) {
    const bool finite_eta = std::ranges::any_of(parameters.eta, [](double eta) { return std::isfinite(eta); });
    const double shifted = shifted_need(model, finite_eta);
    const bool falls_back = choice.may_take(SpectralSolver::dense);
    const double dense =
        falls_back ? bytes_per_number * (rigid ? rigid_dense_matrices : dense_matrices) * square(n) : 0;
    if (!rigid) return program_bytes + std::max(shifted, dense);
    const bool flexible = std::ranges::any_of(parameters.epsilon, [](double epsilon) { return epsilon > 0; });
    const double limit = in_space(model) ? std::max(flexible ? shifted : 0.0, rigid_need_in_space(model, finite_eta))
                                         : rigid_shift * shifted + rigid_ranks * unknowns;
    return program_bytes + std::max(limit, dense);
  }
  const double kernel = rigid && size <= dense_kernel_limit ? rigid_kernel_matrices * square(n) : 0;
  // In space what counts the unit eigenvalues of the rigid limit outweighs all else.
  const double ranks = rigid && in_space(model) ? rank_need(model).bytes : 0;
  const double need = bytes_per_number * (factors * factor_fill * unknowns * std::log2(unknowns) + kernel +
                                          (static_cast<double>(options.arpack.basis) + arpack_vectors) * n);
  return std::max(need, ranks);
}

double inexact_need(const Model& model, const SweepParameters& parameters) {
  const Index unknowns = model.parts.contacts + model.parts.interface_size();
  const auto size = static_cast<double>(unknowns);
  const SolverChoice choice = choose_inexact_solver(unknowns, parameters.spectral);
  const bool dense = choice.may_take(SpectralSolver::dense);
  const double basis = static_cast<double>(parameters.spectral.arpack.basis) + arpack_vectors;
  return bytes_per_number * (dense ? inexact_matrices * square(size) : basis * size);
}

}  // namespace

MemoryNeed sweep_need(const Model& model, const SweepParameters& parameters) {
  double need = 0;
  for (const auto& sweeps : parameters.gauss_seidel_sweeps)
    need = std::max(need, sweeps ? inexact_need(model, parameters) : exact_need(model, parameters));
  return {model_need(model) + std::max(need, choice_need(model, parameters.contacts)), model.name,
          fmt::format("{} interface unknowns", model.parts.interface_size()),
          "fewer subdomains or grains, the solver arpack where it is dense"};
}

MemoryNeed link_need(const Model& model, ContactSet contacts) {
  const bool loaded = !model.problem.arriving_velocity.isZero(0);
  return {model_need(model) + (loaded ? choice_need(model, contacts) : 0), model.name,
          fmt::format("the impulses of {} contacts", model.contacts()), "fewer grains"};
}

MemoryNeed rank_need(const Model& model) {
  const double need = in_space(model)
                          ? program_bytes + rank_need_in_space(model)
                          : factor_need(model, unknowns_of(model), static_cast<double>(model.parts.contacts));
  return {model_need(model) + need, model.name, fmt::format("the ranks of {} contacts", model.contacts()),
          "fewer grains"};
}

MemoryNeed operators_need(const Model& model, ContactSet contacts, bool dense) {
  const double matrices =
      dense ? bytes_per_number * exported_matrices * square(static_cast<double>(model.parts.interface_size())) : 0;
  const double need = program_bytes + exported_bytes * unknowns_of(model) + matrices;
  return {model_need(model) + std::max(need, choice_need(model, contacts)), model.name,
          dense ? fmt::format("S, P and B of {} interface unknowns", model.parts.interface_size())
                : fmt::format("the operators of {} grains", model.grains()),
          dense ? "--sparse-only, which leaves these out, or fewer subdomains" : "fewer grains"};
}

MemoryNeed largest_need(const StudyTable& table, Index first) {
  MemoryNeed largest;
  const auto rows = row_count(table);
  if (!rows || table.observable->moving) return largest;  // a moving case takes some hundred bytes per grain
  const Index cases = varied_case_count(table);
  for (Index number = first * cases / std::max<Index>(*rows, 1); number < cases; ++number) {
    const Case one = varied_case(table, number).one;
    try {
      MemoryNeed need = sweep_need(build(one), table.sweep);
      if (need.bytes > largest.bytes) largest = std::move(need);
    } catch (const Error& error) {
      fail("case {}: {}", one.spec.name, error.what());
    }
  }
  return largest;
}

}  // namespace nscdd
