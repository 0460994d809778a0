// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/saddle_point_family.hpp"

#include <cmath>

namespace nscdd {
namespace {

// Entries of the lower triangle, and the matrices that they add up to.
class Entries {
 public:
  explicit Entries(std::size_t most) {  // growing would copy gigabytes
    inertia_.reserve(most);
    stiffness_.reserve(most);
  }
  void add(Index row, Index column, double inertia, double stiffness) {
    inertia_.emplace_back(static_cast<int>(row), static_cast<int>(column), inertia);
    stiffness_.emplace_back(static_cast<int>(row), static_cast<int>(column), stiffness);
  }
  void sum_up(Index size, SparseMatrix& inertia, SparseMatrix& stiffness) {
    inertia.resize(size, size);
    inertia.setFromTriplets(inertia_.begin(), inertia_.end());
    inertia_ = {};
    stiffness.resize(size, size);
    stiffness.setFromTriplets(stiffness_.begin(), stiffness_.end());
  }

 private:
  std::vector<Eigen::Triplet<double>> inertia_, stiffness_;
};

// M_E on the diagonal and A_E in the interface rows.
void add_inertia_and_gluing(Entries& entries, const Subdomain& subdomain, Index first, Index interface) {
  for (Index i = 0; i < subdomain.inertia.size(); ++i) entries.add(first + i, first + i, subdomain.inertia[i], 0);
  for (Index j = 0; j < subdomain.inertia.size(); ++j)
    for (SparseMatrix::InnerIterator e(subdomain.a, j); e; ++e)
      entries.add(interface + e.row(), first + j, e.value(), 0);
}

// The block of one decomposition: M_E and K_E = H_E H_E^T.
void add_condensed(Entries& entries, const Decomposition& parts, Index first, Index interface) {
  for (const Subdomain& subdomain : parts.subdomains) {
    const Index n = subdomain.inertia.size();
    add_inertia_and_gluing(entries, subdomain, first, interface);
    const SparseMatrix stiffness = SparseMatrix(subdomain.h * subdomain.h.transpose());
    for (Index j = 0; j < n; ++j)
      for (SparseMatrix::InnerIterator e(stiffness, j); e; ++e)
        if (e.row() >= j) entries.add(first + e.row(), first + j, 0, e.value());
    first += n;
  }
}

// The same with the contact impulses behind all grains: H_E^T in their rows, -1 to be multiplied by epsilon.
void add_augmented(Entries& entries, const Decomposition& parts, Index first_impulse, Index interface) {
  Index first = 0;
  for (const Subdomain& subdomain : parts.subdomains) {
    add_inertia_and_gluing(entries, subdomain, first, interface);
    for (Index c = 0; c < subdomain.h.cols(); ++c, ++first_impulse) {
      entries.add(first_impulse, first_impulse, 0, -1);
      for (SparseMatrix::InnerIterator e(subdomain.h, c); e; ++e)
        entries.add(first_impulse, first + e.row(), e.value(), 0);
    }
    first += subdomain.inertia.size();
  }
}

// Of one decomposition, no fewer than there are: a contact of k velocities ties them in pairs.
std::size_t most_entries(const Decomposition& parts) {
  Index n = 0;
  for (const Subdomain& subdomain : parts.subdomains) {
    n += subdomain.inertia.size() + subdomain.a.nonZeros();
    for (Index c = 0; c < subdomain.h.cols(); ++c) {
      const Index k = subdomain.h.col(c).nonZeros();
      n += 1 + k * (k + 1) / 2;
    }
  }
  return at(n);
}

Index total_contacts(const Decomposition& parts) {
  Index n = 0;
  for (const Subdomain& subdomain : parts.subdomains) n += subdomain.h.cols();
  return n;
}

Index total_dofs(const Decomposition& parts) {
  Index n = 0;
  for (const Subdomain& subdomain : parts.subdomains) n += subdomain.inertia.size();
  return n;
}

}  // namespace

SaddlePointFamily::SaddlePointFamily(const Contraction& b, SystemForm system_form)
    : contraction(b), form(system_form), generic(std::isinf(b.preconditioner.eta())) {
  const Decomposition &system = b.system.parts(), &preconditioner = b.preconditioner.parts();
  grain_rows = total_dofs(system);
  system_size = grain_rows + (form == SystemForm::augmented ? total_contacts(system) : 0);
  interface = system_size + (generic ? 0 : total_dofs(preconditioner));
  Entries entries(most_entries(system) +
                  (generic ? at(b.preconditioner.generic().nonZeros()) : most_entries(preconditioner)));
  if (form == SystemForm::augmented) {
    add_augmented(entries, system, grain_rows, interface);
  } else {
    add_condensed(entries, system, 0, interface);
  }
  if (generic) {
    const SparseMatrix& x = b.preconditioner.generic();  // X
    for (Index j = 0; j < x.outerSize(); ++j)
      for (SparseMatrix::InnerIterator e(x, j); e; ++e)
        if (e.row() >= j) entries.add(interface + e.row(), interface + j, e.value(), 0);
  } else {
    add_condensed(entries, preconditioner, system_size, interface);
  }
  entries.sum_up(interface + system.interface_size(), inertia, stiffness);
}

SparseMatrix SaddlePointFamily::matrix(double epsilon, double eta, double sigma) const {
  const double root = std::sqrt(sigma);
  SparseMatrix sum = inertia;
  double* value = sum.valuePtr();
  const double* k = stiffness.valuePtr();
  for (Index j = 0; j < sum.outerSize(); ++j)
    for (Index p = sum.outerIndexPtr()[j]; p < sum.outerIndexPtr()[j + 1]; ++p) {
      const bool gluing = sum.innerIndexPtr()[p] >= interface && j < interface;
      if (j < system_size) {
        if (!gluing) value[p] += form == SystemForm::augmented ? k[p] * epsilon : k[p] / epsilon;
      } else if (j < interface) {
        value[p] = gluing ? root * value[p] : -(value[p] + k[p] / eta);
      } else {
        value[p] *= sigma;
      }
    }
  return sum;
}

InertiaPattern SaddlePointFamily::pattern() const {
  const Decomposition& system = contraction.system.parts();
  std::vector<Index> grain;
  grain.reserve(at(rows()));
  const auto add = [&](Index g) { grain.insert(grain.end(), at(system.dofs_per_grain()), g); };
  for (const Subdomain& subdomain : system.subdomains)
    for (const Index g : subdomain.grains) add(g);
  grain.insert(grain.end(), at(system_size - grain_rows), -1);
  if (!generic)
    for (const Subdomain& subdomain : contraction.preconditioner.parts().subdomains)
      for (const Index g : subdomain.grains) add(g);
  for (const Gluing& row : system.interface.gluing()) add(row.grain);
  std::vector<Index> number(at(system.interface.grains()), -1);  // of a grain, as it is met
  Index next = 0;
  for (Index& g : grain) {
    if (g < 0) continue;
    Index& n = number[at(g)];
    if (n < 0) n = next++;
    g = n;
  }
  return {inertia, grain, interface_size()};
}

// x^T K x over some columns.
double SaddlePointFamily::energy(const Vector& x, Index first, Index last) const {
  double sum = 0;
  for (Index j = first; j < last; ++j)
    for (SparseMatrix::InnerIterator e(stiffness, j); e; ++e)
      sum += e.value() * x[e.row()] * x[j] * (e.row() == j ? 1 : 2);
  return sum;
}

ShiftedPencil::Response SaddlePointFamily::response(const Vector& x, double epsilon, double eta, double sigma) const {
  const double system = energy(x, 0, system_size);
  return {.f = -x.tail(interface_size()),
          .system = form == SystemForm::augmented ? -system * epsilon : system / epsilon,
          .preconditioner = generic ? 0.0 : energy(x, system_size, interface) / (eta * sigma)};
}

}  // namespace nscdd
