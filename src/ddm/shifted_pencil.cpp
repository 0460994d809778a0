// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/ldlt/symmetric_factor.hpp"
#include <nscdd/ddm/shifted_pencil.hpp>

#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>
#include <vector>

namespace nscdd {
namespace {

// Inexactness from which solutions are refined by one step, which takes as long as three more.
constexpr double refined_above(SolutionAccuracy accuracy) {
  return accuracy == SolutionAccuracy::refined ? 1e-10 : 1e-6;
}

struct Entry {
  int row, column;
  double inertia, stiffness;
};

// M_E on the diagonal and A_E in the interface rows.
void add_inertia_and_gluing(std::vector<Entry>& entries, const Subdomain& subdomain, Index first,
                            Index interface) {
  for (Index i = 0; i < subdomain.inertia.size(); ++i)
    entries.push_back({static_cast<int>(first + i), static_cast<int>(first + i), subdomain.inertia[i], 0});
  for (Index j = 0; j < subdomain.inertia.size(); ++j)
    for (SparseMatrix::InnerIterator e(subdomain.a, j); e; ++e)
      entries.push_back({static_cast<int>(interface + e.row()), static_cast<int>(first + j), e.value(), 0});
}

// Lower triangle of the block of one decomposition: M_E and K_E = H_E H_E^T, and A_E in the interface rows.
void add_condensed(std::vector<Entry>& entries, const Decomposition& parts, Index first, Index interface) {
  for (const Subdomain& subdomain : parts.subdomains) {
    const Index n = subdomain.inertia.size();
    add_inertia_and_gluing(entries, subdomain, first, interface);
    const SparseMatrix stiffness = SparseMatrix(subdomain.h * subdomain.h.transpose());
    for (Index j = 0; j < n; ++j)
      for (SparseMatrix::InnerIterator e(stiffness, j); e; ++e)
        if (e.row() >= j)
          entries.push_back({static_cast<int>(first + e.row()), static_cast<int>(first + j), 0, e.value()});
    first += n;
  }
}

// The same with the contact impulses behind all grains: H_E^T in their rows, -1 to be multiplied by epsilon.
void add_augmented(std::vector<Entry>& entries, const Decomposition& parts, Index first_impulse,
                   Index interface) {
  Index first = 0;
  for (const Subdomain& subdomain : parts.subdomains) {
    add_inertia_and_gluing(entries, subdomain, first, interface);
    for (Index c = 0; c < subdomain.h.cols(); ++c, ++first_impulse) {
      entries.push_back({static_cast<int>(first_impulse), static_cast<int>(first_impulse), 0, -1});
      for (SparseMatrix::InnerIterator e(subdomain.h, c); e; ++e)
        entries.push_back({static_cast<int>(first_impulse), static_cast<int>(first + e.row()), e.value(), 0});
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

class ShiftedPencilFamily::Preparation {
 public:
  Preparation(const Contraction& b, SystemForm system_form)
      : contraction(b), form(system_form), generic(std::isinf(b.preconditioner.eta())) {
    const Decomposition& system = b.system.parts();
    const Decomposition& preconditioner = b.preconditioner.parts();
    grain_rows = total_dofs(system);
    system_size = grain_rows + (form == SystemForm::augmented ? total_contacts(system) : 0);
    interface = system_size + (generic ? 0 : total_dofs(preconditioner));
    const Index size = interface + system.interface_size();
    std::vector<Entry> entries;  // growing would copy gigabytes
    entries.reserve(most_entries(system) + (generic ? nscdd::at(b.preconditioner.generic().nonZeros())
                                                    : most_entries(preconditioner)));
    if (form == SystemForm::augmented) {
      add_augmented(entries, system, grain_rows, interface);
    } else {
      add_condensed(entries, system, 0, interface);
    }
    if (generic) {
      const SparseMatrix& x = b.preconditioner.generic();  // X
      for (Index j = 0; j < x.outerSize(); ++j)
        for (SparseMatrix::InnerIterator e(x, j); e; ++e)
          if (e.row() >= j)
            entries.push_back(
                {static_cast<int>(interface + e.row()), static_cast<int>(interface + j), e.value(), 0});
    } else {
      add_condensed(entries, preconditioner, system_size, interface);
    }
    assemble(entries, size);
    std::vector<Index> border(nscdd::at(system.interface_size()));
    std::iota(border.begin(), border.end(), interface);
    analysis.emplace(inertia, grain_groups(size), std::vector<char>{}, border);
  }

  // What does not depend on sigma, of the last epsilon and eta.
  SymmetricInterior interior(double epsilon, double eta, const SparseMatrix& matrix) const {
    const std::lock_guard lock(interior_mutex_);
    if (!interior_ || interior_epsilon_ != epsilon || interior_eta_ != eta) {
      interior_.reset();  // room for the next
      interior_.emplace(*analysis, matrix);
      interior_epsilon_ = epsilon;
      interior_eta_ = eta;
    }
    return *interior_;
  }

  // Sums entries of the same place, the two coefficients side by side.
  void assemble(const std::vector<Entry>& entries, Index size) {
    std::vector<Eigen::Triplet<double>> first, second;
    first.reserve(entries.size());
    for (const Entry& e : entries) first.emplace_back(e.row, e.column, e.inertia);
    inertia = SparseMatrix(size, size);
    inertia.setFromTriplets(first.begin(), first.end());
    first = {};
    second.reserve(entries.size());
    for (const Entry& e : entries) second.emplace_back(e.row, e.column, e.stiffness);
    stiffness = SparseMatrix(size, size);
    stiffness.setFromTriplets(second.begin(), second.end());
  }

  void release() const {
    const std::lock_guard lock(interior_mutex_);
    interior_.reset();
  }

  // x^T K x of the block of S, for epsilon and the velocities or contact impulses in x, and of that of -P,
  // the velocities of which are scaled by sqrt(sigma).
  ShiftedPencil::Response response(const Vector& x, double epsilon, double eta, double sigma) const {
    const auto energy = [&](Index first, Index last) {
      double sum = 0;
      for (Index j = first; j < last; ++j)
        for (Index p = stiffness.outerIndexPtr()[j]; p < stiffness.outerIndexPtr()[j + 1]; ++p) {
          const Index i = stiffness.innerIndexPtr()[p];
          sum += stiffness.valuePtr()[p] * x[i] * x[j] * (i == j ? 1 : 2);
        }
      return sum;
    };
    const double system = energy(0, system_size);
    return {.f = -x.tail(x.size() - interface),
            .system = form == SystemForm::augmented ? -system * epsilon : system / epsilon,
            .preconditioner = generic ? 0.0 : energy(system_size, interface) / (eta * sigma)};
  }

  // All copies of a grain and the gluing of these copies are eliminated together.
  std::vector<Index> grain_groups(Index size) const {
    const Decomposition& system = contraction.system.parts();
    const Index d = system.dofs_per_grain();
    std::vector<Index> grain;
    grain.reserve(nscdd::at(size));
    const auto add = [&](Index g) { grain.insert(grain.end(), nscdd::at(d), g); };
    for (const Subdomain& subdomain : system.subdomains)
      for (const Index g : subdomain.grains) add(g);
    const Index impulses = form == SystemForm::augmented ? total_contacts(system) : 0;
    grain.insert(grain.end(), nscdd::at(impulses), -1);  // with the later of their grains
    if (!generic)
      for (const Subdomain& subdomain : contraction.preconditioner.parts().subdomains)
        for (const Index g : subdomain.grains) add(g);
    for (const Gluing& row : system.interface.gluing()) add(row.grain);
    std::vector<Index> number(nscdd::at(system.interface.grains()), -1);
    Index next = 0;
    for (Index& g : grain) {
      if (g < 0) continue;
      Index& n = number[nscdd::at(g)];
      if (n < 0) n = next++;
      g = n;
    }
    return grain;
  }

  // Rows of the -P block are scaled by sqrt(sigma), so that sigma appears between rows of one interface grain
  // or of two, and nowhere else.
  SparseMatrix matrix(double epsilon, double eta, double sigma) const {
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

  Contraction contraction;  // keeps the decompositions alive
  SystemForm form;
  bool generic;
  Index grain_rows = 0;   // of the grains of S, before those of its contact impulses
  Index system_size = 0;  // of the block of S
  Index interface = 0;    // first interface row
  SparseMatrix inertia,
      stiffness;  // lower triangles of one pattern: coefficients of 1 and of 1/epsilon, 1/eta
  std::optional<SymmetricAnalysis> analysis;

 private:
  mutable std::mutex interior_mutex_;
  mutable std::optional<SymmetricInterior> interior_;
  mutable double interior_epsilon_ = not_a_number, interior_eta_ = not_a_number;
};

class ShiftedPencil::Implementation {
 public:
  Implementation(std::shared_ptr<const ShiftedPencilFamily::Preparation> p, double epsilon, double eta,
                 double sigma, SolutionAccuracy accuracy)
      : preparation(std::move(p)), epsilon_(epsilon), eta_(eta), shift(sigma) {
    SparseMatrix matrix = preparation->matrix(epsilon, eta, sigma);
    factor.emplace(preparation->interior(epsilon, eta, matrix), matrix);
    if (!factor->regular()) return;
    const Vector g = Vector::Ones(matrix.rows() - preparation->interface);
    const Vector x = factor->solve_from_border(g);
    const Vector correction = factor->solve_to_border(symmetric_residual(matrix, x, whole(g)));
    inexactness = correction.norm() / x.tail(g.size()).norm();
    if (!std::isfinite(inexactness)) inexactness = infinity;
    if (inexactness > refined_above(accuracy)) refinement = std::move(matrix);
  }

  Index below() const {
    const Index interface_size = preparation->inertia.rows() - preparation->interface;
    const Index preconditioner_size = preparation->interface - preparation->system_size;
    const Index impulses = preparation->system_size - preparation->grain_rows;
    return impulses + preconditioner_size + interface_size - factor->negative_eigenvalues();
  }

  Vector solve(const Vector& g) const {
    if (!refinement) return -factor->solve_on_border(g);
    const Vector x = factor->solve_from_border(g);
    return -(x.tail(g.size()) + factor->solve_to_border(symmetric_residual(*refinement, x, whole(g))));
  }

  Response respond(const Vector& g) const {
    return preparation->response(solve_whole(g), epsilon_, eta_, shift);
  }

 private:
  Vector solve_whole(const Vector& g) const {
    Vector x = factor->solve_from_border(g);
    if (refinement) x += factor->solve(symmetric_residual(*refinement, x, whole(g)));
    return x;
  }

  Vector whole(const Vector& g) const {
    Vector right = Vector::Zero(preparation->inertia.rows());
    right.tail(g.size()) = g;
    return right;
  }

  std::shared_ptr<const ShiftedPencilFamily::Preparation> preparation;
  double epsilon_, eta_;

 public:
  double shift;
  std::optional<SymmetricFactor> factor;
  double inexactness = infinity;
  std::optional<SparseMatrix> refinement;  // where solutions want a step of refinement
};

ShiftedPencil::ShiftedPencil(std::shared_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}
bool ShiftedPencil::regular() const { return implementation_->factor->regular(); }
double ShiftedPencil::inexactness() const { return implementation_->inexactness; }
double ShiftedPencil::solution_error() const {
  return implementation_->refinement ? implementation_->inexactness * implementation_->inexactness
                                     : implementation_->inexactness;
}
double ShiftedPencil::shift() const { return implementation_->shift; }
Index ShiftedPencil::below() const { return implementation_->below(); }
Vector ShiftedPencil::solve(const Vector& g) const { return implementation_->solve(g); }
ShiftedPencil::Response ShiftedPencil::respond(const Vector& g) const { return implementation_->respond(g); }

ShiftedPencilFamily::ShiftedPencilFamily(const Contraction& b, SystemForm form)
    : preparation_(std::make_shared<const Preparation>(b, form)) {}

bool ShiftedPencilFamily::serves(const Contraction& b, SystemForm form) const {
  const Contraction& own = preparation_->contraction;
  return &b.system.parts() == &own.system.parts() &&
         &b.preconditioner.parts() == &own.preconditioner.parts() &&
         std::isinf(b.preconditioner.eta()) == preparation_->generic && form == preparation_->form;
}

ShiftedPencil ShiftedPencilFamily::at(double epsilon, double eta, double sigma,
                                      SolutionAccuracy accuracy) const {
  return ShiftedPencil(
      std::make_shared<const ShiftedPencil::Implementation>(preparation_, epsilon, eta, sigma, accuracy));
}

void ShiftedPencilFamily::release() const { preparation_->release(); }

Index ShiftedPencilFamily::unknowns() const { return preparation_->inertia.rows(); }
double ShiftedPencilFamily::factor_entries() const {
  return preparation_->analysis->entries() + preparation_->analysis->interior_updates();
}

}  // namespace nscdd
