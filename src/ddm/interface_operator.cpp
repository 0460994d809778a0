// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/enriched_inertia.hpp"
#include "linalg/pencil.hpp"
#include "linalg/threads.hpp"
#include <nscdd/ddm/interface_operator.hpp>

#include <numeric>

namespace nscdd {

// Subdomain families and what else does not depend on eta.
class InterfaceFamily::Preparation {
 public:
  Preparation(const Decomposition& decomposition, Index limit)
      : parts(decomposition),
        dense_limit(limit),
        scale(Vector::Zero(parts.interface_size())),
        locals(parts.subdomains.size()) {
    for_each_in_parallel(count(locals),
                         [&](Index e) { locals[nscdd::at(e)].emplace(parts.subdomains[nscdd::at(e)], dense_limit); });
    const Index d = parts.dofs_per_grain();
    for (Index e = 0; e < count(locals); ++e)
      for (const Tie& tie : parts.interface.ties(e))
        scale.segment(d * tie.row, d) +=
            parts.subdomains[nscdd::at(e)].inertia.segment(d * tie.grain, d).cwiseInverse();
  }

  // The undivided packing. Only `solve` needs it.
  struct Whole {
    std::unique_ptr<const EnrichedInertiaFamily> family;
    std::vector<std::vector<Index>> rows;  // in the assembled system, of the unknowns of each subdomain
  };
  const Whole& whole() const {
    return whole_.get([this] {
      const Subdomain assembled = reassemble(parts);
      Whole whole{std::make_unique<EnrichedInertiaFamily>(assembled, dense_limit), {}};
      const auto begin = assembled.grains.begin();
      for (const Subdomain& subdomain : parts.subdomains) {
        auto& rows = whole.rows.emplace_back();
        for (const Index grain : subdomain.grains)
          for (Index k = 0; k < parts.dofs_per_grain(); ++k)
            rows.push_back(parts.dofs_per_grain() * (std::lower_bound(begin, assembled.grains.end(), grain) - begin) +
                           k);
      }
      return whole;
    });
  }

  Decomposition parts;
  Index dense_limit;
  Vector scale;
  std::vector<std::optional<EnrichedInertiaFamily>> locals;
  Lazy<SparseMatrix> generic;
  Lazy<Index> nullity;

 private:
  Lazy<Whole> whole_;
};

class InterfaceOperator::Implementation {
 public:
  Implementation(std::shared_ptr<const InterfaceFamily::Preparation> p, double flexibility)
      : preparation(std::move(p)), eta(flexibility), locals(preparation->locals.size()) {
    for_each_in_parallel(count(locals),
                         [&](Index e) { locals[nscdd::at(e)].emplace(*preparation->locals[nscdd::at(e)], eta); });
  }

  std::shared_ptr<const InterfaceFamily::Preparation> preparation;
  double eta;
  std::vector<std::optional<EnrichedInertia>> locals;
  Lazy<std::unique_ptr<const EnrichedInertia>> whole;
  Lazy<Matrix> dense;
  Lazy<KernelSplit> kernel;
};

InterfaceOperator::InterfaceOperator(std::shared_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}

double InterfaceOperator::eta() const { return implementation_->eta; }
const Decomposition& InterfaceOperator::parts() const { return implementation_->preparation->parts; }
Index InterfaceOperator::rows() const { return parts().interface_size(); }
const Vector& InterfaceOperator::scale() const { return implementation_->preparation->scale; }

// sum_E A_E M_E^-1 A_E^T
const SparseMatrix& InterfaceOperator::generic() const {
  return implementation_->preparation->generic.get([this] {
    SparseMatrix sum(rows(), rows());
    for (const Subdomain& subdomain : parts().subdomains)
      sum += SparseMatrix(subdomain.a * subdomain.inertia.cwiseInverse().asDiagonal() * subdomain.a.transpose());
    return sum;
  });
}

Vector InterfaceOperator::apply(const Vector& f) const {
  if (std::isinf(eta())) return generic() * f;
  const auto& locals = implementation_->locals;
  std::vector<Vector> velocities(locals.size());
  for_each_in_parallel(count(locals),
                       [&](Index e) { velocities[at(e)] = locals[at(e)]->solve(parts().interface.distribute(e, f)); });
  return parts().interface.exchange(velocities);
}

double InterfaceOperator::slope(const Vector& f) const {
  if (eta() == 0 || std::isinf(eta())) return 0;
  const auto& locals = implementation_->locals;
  std::vector<double> terms(locals.size());
  for_each_in_parallel(count(locals), [&](Index e) {
    const Vector v = locals[at(e)]->solve(parts().interface.distribute(e, f));
    const Vector links = parts().subdomains[at(e)].h.transpose() * v;
    terms[at(e)] = links.squaredNorm() / eta();
  });
  return std::accumulate(terms.begin(), terms.end(), 0.0);
}

const Matrix& InterfaceOperator::dense() const {
  return implementation_->dense.get([this] {
    const auto& locals = implementation_->locals;
    std::vector<Matrix> condensed(locals.size());
    for_each_in_parallel(count(locals), [&](Index e) { condensed[at(e)] = locals[at(e)]->condense(); });
    Matrix x = Matrix::Zero(rows(), rows());
    for (std::size_t e = 0; e < locals.size(); ++e) {
      const auto& touched = implementation_->preparation->locals[e]->rows();
      x(touched, touched) += condensed[e];
    }
    return x;
  });
}

const KernelSplit& InterfaceOperator::kernel() const {
  return implementation_->kernel.get([this] {
    const Vector root = scale().cwiseSqrt().cwiseInverse();
    return split_kernel(root.asDiagonal() * dense() * root.asDiagonal(), nullity());
  });
}

// The ranks do not depend on masses, as the size of an eigenvalue of X_0 does.
Index InterfaceOperator::nullity() const {
  if (eta() > 0) return 0;
  return implementation_->preparation->nullity.get([this] {
    Index nullity = -sparse_rank(reassemble(parts()).h);
    for (const Subdomain& subdomain : parts().subdomains) nullity += sparse_rank(subdomain.h);
    return nullity;
  });
}

Vector InterfaceOperator::solve(const Vector& g) const {
  const double eta = implementation_->eta;
  if (eta == 0) throw Error("interface operator: the rigid limit (eta = 0) has no inverse");
  const auto& subdomains = parts().subdomains;
  const Interface& interface = parts().interface;
  if (std::isinf(eta))
    return interface.solve_generic(
        [&](const GrainCopy& copy, Index k) {
          return subdomains[at(copy.subdomain)].inertia[interface.dofs_per_grain() * copy.grain + k];
        },
        g);
  const auto& assembled = implementation_->preparation->whole();
  const auto multiply = [&](std::size_t e, const Vector& v) -> Vector {  // M_{E,eta} v
    const SparseMatrix& h = subdomains[e].h;
    return subdomains[e].inertia.cwiseProduct(v) + h * (h.transpose() * v) / eta;
  };
  // (M + K/eta) U = - sum_E R_E^T M_{E,eta} o_E
  std::vector<Vector> copies = interface.copies_apart(g);  // o_E
  Vector right = Vector::Zero(assembled.family->size());
  for (std::size_t e = 0; e < copies.size(); ++e) right(assembled.rows[e]) -= multiply(e, copies[e]);
  const auto& whole =
      implementation_->whole.get([&] { return std::make_unique<EnrichedInertia>(*assembled.family, eta); });
  const Vector u = whole->solve(right);
  for (std::size_t e = 0; e < copies.size(); ++e)  // M_{E,eta} (R_E U + o_E) = A_E^T F
    copies[e] = multiply(e, copies[e] + u(assembled.rows[e]));
  return interface.collect(std::move(copies));
}

InterfaceFamily::InterfaceFamily(const Decomposition& parts, Index dense_limit)
    : preparation_(std::make_shared<const Preparation>(parts, dense_limit)) {}

InterfaceOperator InterfaceFamily::at(double eta) const {
  return InterfaceOperator(std::make_shared<const InterfaceOperator::Implementation>(preparation_, eta));
}

}  // namespace nscdd
