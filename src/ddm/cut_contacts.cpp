// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/cut_contacts.hpp"

#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

#include <Eigen/LU>

#include <numeric>

namespace nscdd {
namespace {

// E on the columns of a subdomain; zeros are stored, so that all matrices have one pattern.
SparseMatrix blocks_of(const Subdomain& subdomain, const std::vector<Eigen::Matrix2d>& e) {
  SparseEntries entries;
  for (Index k = 0; k < count(subdomain.contacts); k += 2) {
    const Eigen::Matrix2d& block = e[at(subdomain.contacts[at(k)] / 2)];
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 2; ++j) entries.add(k + i, k + j, block(i, j));
  }
  return entries.matrix(count(subdomain.contacts), count(subdomain.contacts));
}

// The contacts that Stage 2 sees, as links of flexibility 1: the columns of H times the roots of their conductances.
Decomposition stage_two(const Decomposition& parts, const std::vector<Eigen::Matrix2d>& e, InterfaceNetwork network) {
  double sum = 0;
  Index carrying = 0;
  for (const Eigen::Matrix2d& block : e)
    if (block(0, 0) > 0) {
      sum += block(0, 0);
      ++carrying;
    }
  const double mean = carrying > 0 ? sum / static_cast<double>(carrying) : 0;
  Decomposition result = parts;
  for (Subdomain& subdomain : result.subdomains) {
    Vector roots(count(subdomain.contacts));
    for (Index k = 0; k < roots.size(); ++k) {
      const Index column = subdomain.contacts[at(k)];
      const double own = e[at(column / 2)](column % 2, column % 2);
      roots[k] = std::sqrt(network == InterfaceNetwork::all ? mean : std::max(own, 0.0));
    }
    subdomain.h = subdomain.h * roots.asDiagonal();
  }
  return result;
}

}  // namespace

CutContacts::CutContacts(Decomposition parts, const CutOptions& options)
    : parts_(std::move(parts)), options_(options), lu_(parts_.subdomains.size()) {
  if (parts_.contacts % 2 != 0) fail("contacts: expected two columns for each, met {} columns", parts_.contacts);
  if (parts_.interface_size() > 0 && options_.network == InterfaceNetwork::none)
    preconditioner_ = InterfaceFamily(parts_, 0).at(infinity);  // X, whatever the relations are
}

bool CutContacts::factorise(std::vector<ContactRelation> relations) {
  ++work_.factorisations;
  relations_ = std::move(relations);
  longest_ = {};
  e_.clear();
  for (const ContactRelation& relation : relations_) e_.push_back(relation.p.inverse() * relation.q);
  std::vector<char> regular(parts_.subdomains.size(), 1);
  for_each_in_parallel(count(parts_.subdomains), [&](Index i) {
    const Subdomain& subdomain = parts_.subdomains[at(i)];
    if (subdomain.grains.empty()) return;  // it has no contact, or another process has it
    SparseMatrix k = subdomain.h * blocks_of(subdomain, e_) * SparseMatrix(subdomain.h.transpose());
    k.diagonal() += subdomain.inertia;
    k.makeCompressed();
    if (!lu_[at(i)]) lu_[at(i)].emplace(k);
    regular[at(i)] = lu_[at(i)]->factorise(k);
  });
  symmetric_ = std::ranges::all_of(e_, [](const Eigen::Matrix2d& block) { return block(0, 1) == block(1, 0); });
  if (parts_.interface_size() > 0 && options_.network != InterfaceNetwork::none)
    preconditioner_ =
        InterfaceFamily(stage_two(parts_, e_, options_.network), 0, options_.inertia).at(options_.flexibility);
  return !processes().any(std::ranges::count(regular, 0) > 0);
}

std::vector<Vector> CutContacts::velocities(const std::vector<Vector>& impulses) const {
  std::vector<Vector> result(impulses.size());
  for_each_in_parallel(count(impulses), [&](Index i) {
    result[at(i)] = lu_[at(i)] ? lu_[at(i)]->solve(impulses[at(i)]) : impulses[at(i)];
  });
  return result;
}

int CutContacts::determinant_sign() const {
  Index negative = 0;
  for (const std::optional<SparseLu>& lu : lu_) negative += lu && lu->determinant_sign() < 0;
  const bool odd = static_cast<Index>(processes().sum(static_cast<double>(negative))) % 2 != 0;
  return odd ? -longest_.determinant_sign : longest_.determinant_sign;
}

double CutContacts::take_operations() {
  double sum = 0;
  for (const std::optional<SparseLu>& lu : lu_) sum += lu ? lu->operations() : 0;
  const double own = sum - std::exchange(work_.flops, sum);
  const std::vector<double> of_all = processes().gather({&own, 1});
  work_.path_flops += std::ranges::max(of_all);
  return std::accumulate(of_all.begin(), of_all.end(), 0.0);
}

Vector CutContacts::apply(const Vector& f) const {
  std::vector<Vector> impulses;
  for (Index i = 0; i < count(parts_.subdomains); ++i) impulses.push_back(parts_.interface.distribute(i, f));
  return parts_.interface.exchange(velocities(impulses));
}

Vector CutContacts::precondition(const Vector& g) const { return preconditioner_->solve(g); }

Matrix CutContacts::dense() const {
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

Vector CutContacts::solve(const Vector& b) {
  ++work_.solves;
  Vector r(b.size());  // P^-1 b
  for (Index c = 0; c < count(relations_); ++c)
    r.segment<2>(2 * c) = relations_[at(c)].p.inverse() * b.segment<2>(2 * c);
  std::vector<Vector> right;
  for (const Subdomain& subdomain : parts_.subdomains) right.push_back(subdomain.h * r(subdomain.contacts));
  std::vector<Vector> v = velocities(right);
  if (parts_.interface_size() > 0) {
    const LinearMap system = [this](const Vector& f) { return apply(f); };
    const LinearMap inverse = [this](const Vector& g) { return precondition(g); };
    const Vector jumps = parts_.interface.exchange(v);
    const IterationLimits limits{options_.tolerance, options_.maximum_iterations};
    const IteratedSolution f = symmetric_ ? conjugate_gradients(system, inverse, jumps, limits)
                                          : generalised_minimal_residuals(system, inverse, jumps, limits);
    work_.iterations += f.iterations;
    work_.most_iterations = std::max(work_.most_iterations, f.iterations);
    work_.failures += Index{!f.converged};
    if (f.iterations > longest_.iterations) longest_ = f;
    for (std::size_t i = 0; i < right.size(); ++i) right[i] -= parts_.interface.distribute(static_cast<Index>(i), f.x);
    v = velocities(right);
  }
  Vector caused = Vector::Zero(b.size());  // E H_E^T V_E
  for (std::size_t i = 0; i < parts_.subdomains.size(); ++i) {
    const Subdomain& subdomain = parts_.subdomains[i];
    const Vector u = subdomain.h.transpose() * v[i];
    for (Index k = 0; k < count(subdomain.contacts); k += 2) {
      const Index c = subdomain.contacts[at(k)] / 2;
      caused.segment<2>(2 * c) = e_[at(c)] * u.segment<2>(k);
    }
  }
  processes().add_up({caused.data(), at(caused.size())});  // a contact has its part in one process
  return r - caused;
}

}  // namespace nscdd
