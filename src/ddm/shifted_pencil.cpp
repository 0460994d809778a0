// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/shifted_pencil.hpp"

#include "core/disjoint_sets.hpp"

namespace nscdd {
namespace {

// Sizes of a decomposition. `entries`: an upper bound, as a contact couples its velocities in pairs.
struct Sizes {
  Index dofs = 0, contacts = 0, entries = 0;

  explicit Sizes(const Decomposition& parts) {
    for (const Subdomain& subdomain : parts.subdomains) {
      dofs += subdomain.inertia.size();
      contacts += subdomain.h.cols();
      entries += subdomain.inertia.size() + subdomain.a.nonZeros() + subdomain.h.cols();
      for (Index c = 0; c < subdomain.h.cols(); ++c) {
        const Index k = subdomain.h.col(c).nonZeros();
        entries += k * (k + 1) / 2;
      }
    }
  }
};

// M_E on the diagonal and A_E in the interface rows.
void add_inertia_and_gluing(SaddleEntries& entries, const Subdomain& subdomain, Index first, Index interface) {
  for (Index i = 0; i < subdomain.inertia.size(); ++i) entries.add(first + i, first + i, subdomain.inertia[i], 0);
  for_entries(subdomain.a, [&](Index i, Index j, double value) { entries.add(interface + i, first + j, value, 0); });
}

// The block of one decomposition: M_E and K_E = H_E H_E^T from row `first` on, and A_E in the interface rows.
void add_condensed(SaddleEntries& entries, const Decomposition& parts, Index first, Index interface) {
  for (const Subdomain& subdomain : parts.subdomains) {
    add_inertia_and_gluing(entries, subdomain, first, interface);
    const SparseMatrix stiffness = SparseMatrix(subdomain.h * subdomain.h.transpose());
    for_entries(stiffness, [&](Index i, Index j, double value) {
      if (i >= j) entries.add(first + i, first + j, 0, value);
    });
    first += stiffness.cols();
  }
}

// M_E and A_E, and behind all grains the contact impulses: H_E^T in their rows, -1 as coefficient of epsilon.
void add_augmented(SaddleEntries& entries, const Decomposition& parts, Index first_impulse, Index interface) {
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

}  // namespace

// The saddle-point matrices of all shifted pencils of two decompositions (see ShiftedPencil), as coefficients of
// functions of epsilon, eta and sigma. The order of the rows: velocities of the subdomains of S, its contact impulses
// (augmented and rigid form), velocities of the subdomains of P (finite eta only), what is eliminated with the hubs of
// each subdomain (rigid form), the interface. The last two are the border.
struct SaddlePointFamily {
  SaddlePointFamily(const Contraction& b, SystemForm form, std::shared_ptr<const RigidSystem> rigid);

  // Lower triangle. Rows of the -P block are scaled by sqrt(sigma): sigma then appears only between interface rows.
  SparseMatrix matrix(double epsilon, double eta, double sigma) const;

  // One pattern for all. For infinite eta the gluing of each grain is a group of its own: all velocities are eliminated
  // before it, once for all sigma. For finite eta sqrt(sigma) A_E ties them to it, so all copies of a grain are
  // eliminated with its gluing. A contact impulse goes with the later of its grains if their velocities are rows.
  InertiaPattern pattern() const;

  // Extends a vector of the interface to the border; `of_interface` is the way back.
  Vector on_border(const Vector& g) const {
    Vector all = Vector::Zero(border_size());
    all.tail(g.size()) = g;
    return all;
  }
  Vector of_interface(const Vector& x) const { return x.tail(interface_size()); }

  bool schwarz() const { return contraction.schwarz(); }
  Index rows() const { return inertia.rows(); }
  Index border_size() const { return rows() - border; }
  Index interface_size() const { return rows() - interface; }
  const Processes& processes() const { return contraction.system.decomposition().interface.processes(); }

  Contraction contraction;  // keeps the decompositions alive
  SystemForm form;
  std::shared_ptr<const RigidSystem> rigid;  // of the rigid form
  bool generic;                              // eta is infinite
  Index grain_rows = 0;                      // first contact impulse of S
  Index system_size = 0;                     // first row of the block of P
  Index border = 0;                          // first row eliminated with the hubs, or `interface` without any
  Index interface = 0;                       // first interface row
  Index negative = 0;                        // all rows on all ranks except the velocities of S
  Index shared = 0;                          // schwarz: velocities of shared grains
  // Lower triangles of one pattern: coefficients of 1, and of 1/epsilon or 1/eta (of epsilon in rows of contact
  // impulses). Between interface rows: coefficients of sigma, and of 1.
  SparseMatrix inertia, stiffness;
};

SaddlePointFamily::SaddlePointFamily(const Contraction& b, SystemForm system_form,
                                     std::shared_ptr<const RigidSystem> rigid_system)
    : contraction(b),
      form(system_form),
      rigid(std::move(rigid_system)),
      generic(std::isinf(b.preconditioner.flexibility())) {
  const Decomposition &system = b.system.decomposition(), &preconditioner = b.preconditioner.decomposition();
  const Sizes of_system(system), of_preconditioner(preconditioner);
  Index impulses = form == SystemForm::augmented ? of_system.contacts : 0, late = 0;
  grain_rows = of_system.dofs;
  if (rigid) {
    grain_rows = 0;
    for (const RigidSubdomain& own : rigid->subdomains) {
      if (!own.motions.searched) grain_rows += own.motions.inertia.size();
      impulses += count(own.early);
      late += count(own.late);
    }
  }
  system_size = grain_rows + impulses;
  border = system_size + (generic ? 0 : of_preconditioner.dofs);
  interface = border + (rigid ? std::accumulate(rigid->hub_rows.begin(), rigid->hub_rows.end(), Index{0}) : 0);
  SaddleEntries entries;
  if (rigid) {
    add_rigid(entries, *rigid, grain_rows, border, interface);
  } else {
    const Index most = generic ? b.preconditioner.generic().nonZeros() : of_preconditioner.entries;
    for (SparseEntries* one : {&entries.inertia, &entries.stiffness})  // growth would copy gigabytes
      one->reserve(at(of_system.entries + most));
    if (form == SystemForm::augmented)
      add_augmented(entries, system, grain_rows, interface);
    else
      add_condensed(entries, system, 0, interface);
  }
  if (generic) {
    const Interface& tied = system.interface;
    const auto here = [&](Index i) {  // each row of X belongs to the rank of its first copy
      return tied.process_of(tied.gluing()[nscdd::at(i / tied.dofs_per_grain())].first.subdomain) == processes().rank;
    };
    if (b.schwarz()) {
      tied.for_glued_grains([&, d = tied.dofs_per_grain()](Index, Index first, Index last) {
        shared += d;
        const auto others = static_cast<double>(last - first - 1);
        for (Index i = d * first; i < d * last; ++i)
          for (Index j = i; here(i) && j >= d * first; j -= d) {
            const double own = b.preconditioner.scale()[i], mean = own / others;  // own = 1/m
            entries.add(interface + i, interface + j, (i == j ? own : 0) - mean, mean);
          }
      });
    } else {
      for_entries(b.preconditioner.generic(), [&](Index i, Index j, double value) {
        if (i >= j && here(i)) entries.add(interface + i, interface + j, value, 0);
      });
    }
  } else {
    add_condensed(entries, preconditioner, system_size, interface);
  }
  const Index size = interface + system.interface_size();
  inertia = entries.inertia.matrix(size, size);
  entries.inertia = {};  // frees its memory
  stiffness = entries.stiffness.matrix(size, size);
  negative = processes().sum(border - grain_rows + late) + interface_size();
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
        if (!gluing && !rigid) value[p] += form == SystemForm::augmented ? k[p] * epsilon : k[p] / epsilon;
      } else if (j < border) {
        value[p] = gluing ? root * value[p] : -(value[p] + k[p] / eta);
      } else if (j >= interface) {
        value[p] = value[p] * sigma + k[p];
      }
    }
  return sum;
}

InertiaPattern SaddlePointFamily::pattern() const {
  const Decomposition& system = contraction.system.decomposition();
  const Index grains = system.interface.grains();
  std::vector<Index> group;  // at first keys: grains, then copies that are groups of their own
  group.reserve(at(rows()));
  Index keys = grains;
  const auto add = [&](Index key) { group.insert(group.end(), at(system.dofs_per_grain()), key); };
  const auto add_grains = [&](const Subdomain& subdomain) {
    for (const Index grain : subdomain.grains) add(generic ? keys++ : grain);
  };
  for (std::size_t e = 0; e < system.subdomains.size(); ++e)
    if (!rigid || !rigid->subdomains[e].motions.searched) add_grains(system.subdomains[e]);
  if (rigid && grain_rows == 0)
    for (Index impulse = 0; impulse < system_size; ++impulse) group.push_back(keys++);
  else
    group.insert(group.end(), at(system_size - grain_rows), -1);
  if (!generic) std::ranges::for_each(contraction.preconditioner.decomposition().subdomains, add_grains);
  if (rigid)
    for (const Index size : rigid->hub_rows) group.insert(group.end(), at(size), keys++);
  for (const Gluing& row : system.interface.gluing()) add(row.grain);
  return {inertia, renumbered(std::move(group)), border_size()};
}

// Without eigenvalues below the shift all rows but the velocities of S are negative; each eigenvalue takes one away.
Index ShiftedPencil::below() const {
  const Index missing = matrices_->negative - factor_.negative_eigenvalues;
  if (!matrices_->schwarz()) return missing;
  const Index size = matrices_->interface_size(), negative = size - missing;  // of Z
  return size - matrices_->shared + (shift_ > 1 ? negative : -negative);
}

double ShiftedPencil::offset() const { return matrices_->schwarz() ? 1 / (1 - shift_) : 0; }
double ShiftedPencil::scale() const { return matrices_->schwarz() ? 1 / (1 - shift_) : 1; }

Vector ShiftedPencil::solve(const Vector& g) const {
  const Vector right = matrices_->on_border(g);
  if (!refinement_) return -scale() * matrices_->of_interface(factor_.solve_on_border(right));
  const Vector x = factor_.solve_from_border(right);
  return -scale() * (matrices_->of_interface(x) + matrices_->of_interface(factor_.solve_to_border(residual(x, right))));
}

ShiftedPencil::Response ShiftedPencil::respond(const Vector& g) const {
  const SaddlePointFamily& m = *matrices_;
  const Vector right = m.on_border(g);
  Vector x = factor_.solve_from_border(right);
  if (refinement_) x += factor_.solve(residual(x, right));
  const auto energy = [&](Index first, Index last) {  // x^T K x over some columns, of all ranks
    double sum = 0;
    for (Index j = first; j < last; ++j)
      for (SparseMatrix::InnerIterator e(m.stiffness, j); e; ++e)
        sum += e.value() * x[e.row()] * x[j] * (e.row() == j ? 1 : 2);
    return m.processes().sum(sum);
  };
  const double system = m.rigid ? 0.0 : scale() * scale() * energy(0, m.system_size);
  return {.f = -scale() * m.of_interface(x),
          .system = m.form == SystemForm::augmented ? -system * epsilon_ : system / epsilon_,
          .preconditioner = m.generic ? 0.0 : energy(m.system_size, m.border) / (eta_ * shift_)};
}

Vector ShiftedPencil::residual(const Vector& x, const Vector& g) const {
  return border_residual(*refinement_, x, g, matrices_->processes());
}

ShiftedPencilFamily::ShiftedPencilFamily(const Contraction& b, SystemForm form, const InertiaMethod& method,
                                         std::shared_ptr<const RigidSystem> rigid)
    : matrices_(std::make_shared<const SaddlePointFamily>(b, form, std::move(rigid))),
      method_name_(method.name),
      factors_(method.analyse(matrices_->pattern())) {}

bool ShiftedPencilFamily::serves(const Contraction& b, SystemForm form, const InertiaMethod& method) const {
  const Contraction& own = matrices_->contraction;
  return &b.system.decomposition() == &own.system.decomposition() && b.scheme == own.scheme &&
         &b.preconditioner.decomposition() == &own.preconditioner.decomposition() &&
         std::isinf(b.preconditioner.flexibility()) == matrices_->generic && form == matrices_->form &&
         method.name == method_name_;
}

ShiftedPencil ShiftedPencilFamily::at(double epsilon, double eta, double sigma, SolutionAccuracy accuracy) const {
  ShiftedPencil pencil;
  pencil.matrices_ = matrices_;
  pencil.epsilon_ = epsilon;
  pencil.eta_ = eta;
  pencil.shift_ = sigma;
  SparseMatrix matrix = matrices_->matrix(epsilon, eta, sigma);
  pencil.factor_ = factors_.factorise(matrix, {epsilon, eta});
  if (!pencil.regular()) return pencil;
  pencil.inexactness_ = inexactness(pencil.factor_, matrix, matrices_->border_size(), matrices_->processes());
  // A step of refinement costs three more solutions.
  const double refined_above = accuracy == SolutionAccuracy::refined ? 1e-10 : 1e-6;
  if (pencil.inexactness_ > refined_above) pencil.refinement_ = std::move(matrix);
  return pencil;
}

}  // namespace nscdd
