// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/primal_interface.hpp"

#include "core/fail.hpp"
#include "ddm/enriched_inertia.hpp"
#include "linalg/threads.hpp"

#include <Eigen/Cholesky>

#include <map>
#include <set>

namespace nscdd {
namespace {

void condense(CondensedSubdomain& one, const Subdomain& subdomain, Index interface_size, double flexibility) {
  if (one.local.empty()) return;
  const Index n = subdomain.inertia.size();
  const SparseMatrix k = SparseMatrix(subdomain.h * subdomain.h.transpose()) / flexibility;
  const OneBlasThread serial_blas;
  one.block = subdomain.inertia(one.local).asDiagonal();
  one.block += selected_columns(selected_columns(k, one.local).transpose(), one.local);
  SparseEntries selection;
  for (Index i = 0; i < count(one.local); ++i) selection.add(one.rows[at(i)], one.local[at(i)], 1);
  Subdomain selected = subdomain;
  selected.a = selection.matrix(interface_size, n);  // condense() gives the block of these unknowns
  const EnrichedInertiaFamily family(selected, 0);
  one.flexibility = EnrichedInertia(family, flexibility).condense();
  const Eigen::LLT<Matrix> cholesky(one.flexibility);
  one.stiffness = cholesky.solve(Matrix::Identity(one.block.rows(), one.block.rows()));
  one.stiffness = (0.5 * (one.stiffness + one.stiffness.transpose())).eval();
  if (!one.flexibility.allFinite() || cholesky.info() != Eigen::Success) one.stiffness.setConstant(not_a_number);
}

// Places, among the shared unknowns of a subdomain, of the unknowns of these shared grains, ascending.
std::vector<Index> places_of(const CondensedSubdomain& one, const std::vector<Index>& grains, Index d) {
  std::vector<Index> places;
  for (const Index grain : grains)
    for (Index k = 0; k < d; ++k)
      places.push_back(std::ranges::lower_bound(one.rows, d * grain + k) - one.rows.begin());
  return places;
}

void weigh_deluxe(PrimalInterface& interface) {
  for (CondensedSubdomain& one : interface.subdomains) one.weights.setZero(one.block.rows(), one.block.rows());
  std::map<std::vector<Index>, std::vector<Index>> classes;  // the shared grains of each set of subdomains
  for (Index g = 0; g < count(interface.sharing); ++g) classes[interface.sharing[at(g)]].push_back(g);
  for (const auto& [members, grains] : classes) {
    const Index size = interface.dofs_per_grain * count(grains);
    Matrix sum = Matrix::Zero(size, size);
    for (const Index e : members) {
      const CondensedSubdomain& one = interface.subdomains[at(e)];
      const std::vector<Index> places = places_of(one, grains, interface.dofs_per_grain);
      sum += one.stiffness(places, places);
    }
    const Eigen::LLT<Matrix> cholesky(sum);
    for (const Index e : members) {
      CondensedSubdomain& one = interface.subdomains[at(e)];
      const std::vector<Index> places = places_of(one, grains, interface.dofs_per_grain);
      one.weights(places, places) = Matrix(cholesky.solve(Matrix(one.stiffness(places, places))));
    }
  }
}

}  // namespace

bool PrimalInterface::definite() const {
  return std::ranges::all_of(subdomains, [](const CondensedSubdomain& one) { return one.stiffness.allFinite(); });
}

Index PrimalInterface::most_neighbours() const {
  std::vector<std::set<Index>> met(subdomains.size());
  for (const std::vector<Index>& members : sharing)
    for (const Index e : members) met[at(e)].insert(members.begin(), members.end());
  std::size_t most = 0;
  for (const std::set<Index>& of_one : met) most = std::max(most, of_one.size());
  return static_cast<Index>(most);
}

Vector PrimalInterface::apply(const Vector& u) const {
  std::vector<Vector> parts(subdomains.size());
  for_each_in_parallel(count(parts), [&](Index e) {
    const CondensedSubdomain& one = subdomains[at(e)];
    if (!one.rows.empty()) parts[at(e)] = one.stiffness * Vector(u(one.rows));  // the BLAS takes no empty matrix
  });
  Vector sum = Vector::Zero(u.size());
  for (std::size_t e = 0; e < parts.size(); ++e) sum(subdomains[e].rows) += parts[e];
  return sum;
}

Vector PrimalInterface::apply_dual(const Vector& f) const {
  std::vector<Vector> velocities;
  for (Index e = 0; e < count(subdomains); ++e) {
    velocities.push_back(glued.distribute(e, f));
    if (velocities.back().size() > 0) velocities.back() = subdomains[at(e)].flexibility * velocities.back();
  }
  return glued.exchange(velocities);
}

SparseMatrix PrimalInterface::sparse() const {
  SparseEntries entries;
  for (const CondensedSubdomain& one : subdomains)
    for (Index j = 0; j < count(one.rows); ++j)
      for (Index i = 0; i < count(one.rows); ++i) entries.add(one.rows[at(i)], one.rows[at(j)], one.stiffness(i, j));
  return entries.matrix(size(), size());
}

Matrix PrimalInterface::dense_preconditioner() const {
  const OneBlasThread serial_blas;
  Matrix sum = Matrix::Zero(size(), size());
  for (const CondensedSubdomain& one : subdomains)
    sum(one.rows, one.rows) += one.weights * one.flexibility * one.weights.transpose();
  return sum;
}

PrimalInterface condense(const Decomposition& parts, double flexibility) {
  const Interface& glued = parts.interface;
  if (!(flexibility > 0) || std::isinf(flexibility))
    fail("subdomains condensed onto shared grains: expected a finite flexibility > 0, met {}", flexibility);
  PrimalInterface interface;
  const Index d = interface.dofs_per_grain = glued.dofs_per_grain();
  interface.processes = glued.processes();
  interface.subdomains.resize(parts.subdomains.size());
  std::vector<std::vector<Index>> held(parts.subdomains.size());
  glued.for_glued_grains([&](Index grain, Index, Index) {
    const Index shared = count(interface.sharing);
    std::vector<Index>& members = interface.sharing.emplace_back();
    for (const GrainCopy& copy : glued.copies(grain)) {
      members.push_back(copy.subdomain);
      held[at(copy.subdomain)].push_back(shared);
      CondensedSubdomain& one = interface.subdomains[at(copy.subdomain)];
      for (Index k = 0; k < d; ++k) {
        one.local.push_back(d * copy.grain + k);
        one.rows.push_back(d * shared + k);
      }
    }
  });
  interface.glued = Interface(d, count(interface.sharing), {held.begin(), held.end()}, {}, glued.shape());
  for_each_in_parallel(count(parts.subdomains), [&](Index e) {
    CondensedSubdomain& one = interface.subdomains[at(e)];
    one.own = glued.process_of(e) == interface.processes.rank;
    if (one.own) condense(one, parts.subdomains[at(e)], interface.size(), flexibility);
  });
  for (Matrix CondensedSubdomain::*const block :
       {&CondensedSubdomain::flexibility, &CondensedSubdomain::stiffness, &CondensedSubdomain::block})
    interface.processes.share(interface.subdomains, block);
  return interface;
}

void weigh(PrimalInterface& interface, Scaling scaling) {
  const OneBlasThread serial_blas;
  if (scaling == Scaling::deluxe) return weigh_deluxe(interface);
  const auto own = [&](const CondensedSubdomain& one) -> Vector {
    return scaling == Scaling::stiffness ? Vector(one.block.diagonal()) : Vector::Ones(one.block.rows());
  };
  Vector sum = Vector::Zero(interface.size());
  for (const CondensedSubdomain& one : interface.subdomains) sum(one.rows) += own(one);
  for (CondensedSubdomain& one : interface.subdomains)
    one.weights = own(one).cwiseQuotient(Vector(sum(one.rows))).asDiagonal();
}

}  // namespace nscdd
