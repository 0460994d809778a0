// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/cut_contacts.hpp"

#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace nscdd {
namespace {

// The root of the part of a block of E that Stage 2 sees: its diagonal, in space its symmetric tangential block.
template <int D>
Eigen::Matrix<double, D, D> root_of(const Eigen::Matrix<double, D, D>& e) {
  Eigen::Matrix<double, D, D> root = e.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  if constexpr (D == 3) {
    if (e(1, 2) + e(2, 1) == 0) return root;
    const Eigen::Matrix2d tangential = e.template bottomRightCorner<2, 2>();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    axes.computeDirect((tangential + tangential.transpose()) / 2);
    const Eigen::Vector2d values = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    root.template bottomRightCorner<2, 2>() =
        axes.eigenvectors() * values.asDiagonal() * axes.eigenvectors().transpose();
  }
  return root;
}

}  // namespace

template <int D>
CutContacts<D>::CutContacts(Decomposition parts, const CutOptions& options)
    : parts_(std::move(parts)), options_(options), lu_(parts_.subdomains.size()) {
  if (parts_.contacts % D != 0) fail("contacts: expected {} columns for each, met {} columns", D, parts_.contacts);
  for (const Subdomain& subdomain : parts_.subdomains) {
    own_.push_back(subdomain.contacts);
    for (Index& column : own_.back()) column -= parts_.first_contact;
  }
  if (options_.preconditioner == InterfacePreconditioner::bddc) {
    if (!options_.bddc)
      throw Error("solver.interface_preconditioner", "expected another one with nscdd, met bddc, which nscdd-mpi has");
    own_subdomain(parts_);  // one for each rank
    return;
  }
  if (parts_.interface_size() > 0 && options_.preconditioner == InterfacePreconditioner::inertia)
    preconditioner_ = InterfaceFamily(parts_, 0).at(infinity);  // X, for all relations
}

// The blocks of a subdomain's contacts, on its columns.
template <int D>
SparseMatrix CutContacts<D>::blocks_of(Index subdomain, const Blocks& blocks, Zeros zeros) const {
  const std::vector<Index>& own = own_[at(subdomain)];
  SparseEntries entries;
  for (Index k = 0; k < count(own); k += D) {
    const auto& block = blocks[at(own[at(k)] / D)];
    for (Index i = 0; i < D; ++i)
      for (Index j = 0; j < D; ++j)
        if (zeros == Zeros::stored || i == j || block(i, j) != 0) entries.add(k + i, k + j, block(i, j));
  }
  return entries.matrix(count(own), count(own));
}

// The contacts of Stage 2 as links of flexibility 1: columns of H times the roots of their conductances.
template <int D>
Decomposition CutContacts<D>::stage_two() const {
  const bool all = options_.preconditioner == InterfacePreconditioner::network;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(2, count(own_));  // sum and number, of contacts that carry
  for (Index i = 0; i < count(own_); ++i)
    for (Index k = 0; k < count(own_[at(i)]); k += D)
      if (const double e = e_[at(own_[at(i)][at(k)] / D)](0, 0); e > 0) normal.col(i) += Eigen::Vector2d(e, 1);
  const Vector sum = processes().sum_of_parts(std::move(normal));
  const double mean = sum[1] > 0 ? sum[0] / sum[1] : 0;
  Blocks roots;
  for (const auto& block : e_)
    roots.push_back(all ? std::sqrt(mean) * Eigen::Matrix<double, D, D>::Identity() : root_of<D>(block));
  Decomposition result = parts_;
  for (Index i = 0; i < count(own_); ++i) {
    Subdomain& subdomain = result.subdomains[at(i)];
    subdomain.h = subdomain.h * blocks_of(i, roots, Zeros::left_out);
  }
  return result;
}

// None if a subdomain is not positive definite in double precision.
template <int D>
LinearMap CutContacts<D>::local_map() const {
  const Decomposition parts = stage_two();
  const auto interface = std::make_shared<PrimalInterface>(condense(parts, 1));
  if (!interface->definite()) return {};
  weigh(*interface, options_.scaling);
  std::shared_ptr<const CoarseProblem> coarse;
  if (options_.coarse_space != CoarseSpace::none && options_.preconditioner == InterfacePreconditioner::dirichlet)
    coarse = std::make_shared<const CoarseProblem>(
        *interface, options_.coarse_space == CoarseSpace::rigid
                        ? rigid_vectors(*interface, parts, options_.period)
                        : geneo_vectors(*interface, geneo_threshold(*interface, options_.kappa)));
  return local_preconditioner(interface, options_.preconditioner, coarse);
}

// Stored zeros give all matrices one pattern. Driven directions of a free body have rows without entries of H.
template <int D>
SparseMatrix CutContacts<D>::system_of(Index i) const {
  const Subdomain& subdomain = parts_.subdomains[at(i)];
  SparseMatrix k = subdomain.h * blocks_of(i, e_, Zeros::stored) * SparseMatrix(subdomain.h.transpose());
  k += diagonal_matrix(subdomain.inertia);
  k.makeCompressed();
  return k;
}

template <int D>
bool CutContacts<D>::factorise(std::vector<ContactRelation<D>> relations) {
  relations_ = std::move(relations);
  longest_ = {};
  e_.clear();
  for (const ContactRelation<D>& relation : relations_) e_.push_back(relation.p.inverse() * relation.q);
  symmetric_ = !processes().any(!std::ranges::all_of(e_, [](const auto& block) { return block == block.transpose(); }));
  if (options_.preconditioner == InterfacePreconditioner::bddc) {
    bddc_ = options_.bddc(
        parts_, system_of(own_subdomain(parts_)),
        {.scaling = options_.scaling,
         .threshold = options_.coarse_space == CoarseSpace::geneo ? std::optional(options_.kappa) : std::nullopt,
         .tolerance = options_.tolerance,
         .maximum_iterations = options_.maximum_iterations});
    bddc_flops_ += bddc_.setup_flops;
    return true;
  }
  std::vector<char> regular(parts_.subdomains.size(), 1);
  for_each_in_parallel(count(parts_.subdomains), [&](Index i) {
    if (parts_.subdomains[at(i)].grains.empty()) return;  // without contacts, or of another rank
    const SparseMatrix k = system_of(i);
    if (!lu_[at(i)]) lu_[at(i)].emplace(k);
    regular[at(i)] = lu_[at(i)]->factorise(k);
  });
  const bool glued = parts_.interface_size() > 0;
  if (glued && is_local(options_.preconditioner) && !(local_ = local_map())) return false;
  if (glued && is_enriched(options_.preconditioner))
    preconditioner_ = InterfaceFamily(stage_two(), 0, options_.inertia).at(options_.flexibility);
  return !processes().any(std::ranges::count(regular, 0) > 0);
}

template <int D>
std::vector<Vector> CutContacts<D>::velocities(const std::vector<Vector>& impulses) const {
  std::vector<Vector> result(impulses.size());
  for_each_in_parallel(count(impulses), [&](Index i) {
    result[at(i)] = lu_[at(i)] ? lu_[at(i)]->solve(impulses[at(i)]) : impulses[at(i)];
  });
  return result;
}

template <int D>
int CutContacts<D>::determinant_sign() const {
  Index negative = 0;
  for (const std::optional<SparseLu>& lu : lu_) negative += lu && lu->determinant_sign() < 0;
  const bool odd = processes().sum(negative) % 2 != 0;
  return odd ? -longest_.determinant_sign : longest_.determinant_sign;
}

template <int D>
double CutContacts<D>::take_operations() {
  double sum = bddc_flops_;
  for (const std::optional<SparseLu>& lu : lu_) sum += lu ? lu->operations() : 0;
  const double own = sum - std::exchange(work_.flops, sum);
  const std::vector<double> of_all = processes().gather_each(own);
  work_.path_flops += std::ranges::max(of_all);
  return std::accumulate(of_all.begin(), of_all.end(), 0.0);
}

template <int D>
Vector CutContacts<D>::apply(const Vector& f) const {
  std::vector<Vector> impulses;
  for (Index i = 0; i < count(parts_.subdomains); ++i) impulses.push_back(parts_.interface.distribute(i, f));
  return parts_.interface.exchange(velocities(impulses));
}

template <int D>
Matrix CutContacts<D>::dense() const {
  Matrix s = Matrix::Zero(parts_.interface_size(), parts_.interface_size());
  for (Index i = 0; i < count(parts_.subdomains); ++i) {
    const Subdomain& subdomain = parts_.subdomains[at(i)];
    const SparseMatrix transposed = subdomain.a.transpose();
    for (Index row = 0; row < s.rows(); ++row) {
      if (transposed.outerIndexPtr()[row] == transposed.outerIndexPtr()[row + 1]) continue;
      s.col(row) += subdomain.a * lu_[at(i)]->solve(Vector(transposed.col(row)));
    }
  }
  processes().add_up({s.data(), at(s.size())});
  return s;
}

template <int D>
std::vector<Vector> CutContacts<D>::glued_velocities(std::vector<Vector> impulses) {
  if (bddc_.solve) {
    const Index own = own_subdomain(parts_);
    const BddcSolution found = bddc_.solve(impulses[at(own)]);
    work_.iterations += found.iterations;
    work_.failures += Index{!found.converged};
    bddc_flops_ += found.flops;
    impulses[at(own)] = found.velocities;
    return impulses;
  }
  std::vector<Vector> v = velocities(impulses);
  if (parts_.interface_size() == 0) return v;
  const LinearMap system = [this](const Vector& f) { return apply(f); };
  const LinearMap inverse = [this](const Vector& g) { return precondition(g); };
  const Vector jumps = parts_.interface.exchange(v);
  const IterationLimits limits{options_.tolerance, options_.maximum_iterations};
  const IteratedSolution f = symmetric_ ? conjugate_gradients(system, inverse, jumps, limits)
                                        : generalised_minimal_residuals(system, inverse, jumps, limits);
  work_.iterations += f.iterations;
  work_.failures += Index{!f.converged};
  if (f.iterations > longest_.iterations) longest_ = f;
  for (Index i = 0; i < count(impulses); ++i) impulses[at(i)] -= parts_.interface.distribute(i, f.x);
  return velocities(impulses);
}

template <int D>
Vector CutContacts<D>::solve(const Vector& b) {
  ++work_.solves;
  Vector r(b.size());  // P^-1 b
  for (Index c = 0; c < count(relations_); ++c)
    r.segment<D>(D * c) = relations_[at(c)].p.inverse() * b.segment<D>(D * c);
  std::vector<Vector> right;
  for (std::size_t i = 0; i < own_.size(); ++i) right.push_back(parts_.subdomains[i].h * r(own_[i]));
  const std::vector<Vector> v = glued_velocities(std::move(right));
  Vector caused = Vector::Zero(b.size());  // E H_E^T V_E
  for (std::size_t i = 0; i < parts_.subdomains.size(); ++i) {
    const Vector u = parts_.subdomains[i].h.transpose() * v[i];
    for (Index k = 0; k < count(own_[i]); k += D) {
      const Index c = own_[i][at(k)] / D;
      caused.segment<D>(D * c) = e_[at(c)] * u.segment<D>(k);
    }
  }
  return r - caused;
}

template class CutContacts<2>;
template class CutContacts<3>;

}  // namespace nscdd
