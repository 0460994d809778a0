// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lazy.hpp"
#include "ddm/enriched_inertia.hpp"
#include "linalg/pencil.hpp"
#include "linalg/range_projector.hpp"
#include "linalg/threads.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/ddm/interface_operator.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace nscdd {
namespace {

Vector inertia_scale(const Decomposition& parts) {
  Vector scale = Vector::Zero(parts.interface_size());
  const Index d = parts.dofs_per_grain();
  for (Index e = 0; e < count(parts.subdomains); ++e)
    for (const Tie& tie : parts.interface.ties(e))
      scale.segment(d * tie.row, d) += parts.subdomains[at(e)].inertia.segment(d * tie.grain, d).cwiseInverse();
  return scale;
}

}  // namespace

class InterfaceFamily::Preparation {
 public:
  Preparation(const Decomposition& decomposition, Index limit)
      : parts(decomposition), dense_limit(limit), scale(inertia_scale(decomposition)) {
    const Index n = count(parts.subdomains);
    rows.resize(nscdd::at(n));
    std::vector<std::optional<EnrichedInertiaFamily>> families(nscdd::at(n));
    for_each_in_parallel(n, [&](Index e) {
      rows[nscdd::at(e)] = interface_rows(parts.subdomains[nscdd::at(e)]);
      families[nscdd::at(e)].emplace(parts.subdomains[nscdd::at(e)], dense_limit);
    });
    for (auto& family : families) locals.push_back(std::move(*family));
  }

  // X_infinity = sum_E A_E M_E^-1 A_E^T, nearly diagonal
  const SparseMatrix& inertia_operator() const {
    return inertia_operator_.get([this] {
      SparseMatrix sum(parts.interface_size(), parts.interface_size());
      for (const Subdomain& subdomain : parts.subdomains)
        sum += SparseMatrix(subdomain.a * subdomain.inertia.cwiseInverse().asDiagonal() * subdomain.a.transpose());
      return sum;
    });
  }

  // The undivided packing. Only `solve` needs it.
  struct Whole {
    std::vector<Index> position;  // of a grain of the packing in the assembled system
    EnrichedInertiaFamily family;
  };
  const Whole& whole() const {
    return whole_.get([this] {
      const Subdomain assembled = reassemble(parts);
      std::vector<Index> position(nscdd::at(parts.interface.grains()), -1);
      for (Index i = 0; i < count(assembled.grains); ++i) position[nscdd::at(assembled.grains[nscdd::at(i)])] = i;
      return Whole{std::move(position), EnrichedInertiaFamily(assembled, dense_limit)};
    });
  }

  // dim ker X_0 = sum_E rank H_E - rank H, the number of self-stresses of the whole that are not those of a
  // subdomain. The ranks do not depend on masses, as the size of an eigenvalue of X_0 does.
  Index rigid_nullity() const {
    return nullity_.get([this] {
      Index nullity = -sparse_rank(reassemble(parts).h);
      for (const Subdomain& subdomain : parts.subdomains) nullity += sparse_rank(subdomain.h);
      return nullity;
    });
  }

  Decomposition parts;
  Index dense_limit;
  Vector scale;
  std::vector<std::vector<Index>> rows;  // interface rows of each subdomain
  std::vector<EnrichedInertiaFamily> locals;

 private:
  Lazy<SparseMatrix> inertia_operator_;
  Lazy<Whole> whole_;
  Lazy<Index> nullity_;
};

class InterfaceOperator::Implementation {
 public:
  Implementation(std::shared_ptr<const InterfaceFamily::Preparation> p, double flexibility)
      : preparation(std::move(p)), eta(flexibility) {
    std::vector<std::optional<EnrichedInertia>> inverses(preparation->locals.size());
    for_each_in_parallel(count(inverses),
                         [&](Index e) { inverses[nscdd::at(e)] = preparation->locals[nscdd::at(e)].at(eta); });
    for (auto& inverse : inverses) locals.push_back(std::move(*inverse));
  }

  const EnrichedInertia& whole() const {
    return whole_.get([this] { return preparation->whole().family.at(eta); });
  }

  const Matrix& dense() const {
    return dense_.get([this] { return assemble(); });
  }

  const KernelSplit& kernel() const {
    return kernel_.get([this] {
      const Vector root = preparation->scale.cwiseSqrt().cwiseInverse();
      return split_kernel(root.asDiagonal() * dense() * root.asDiagonal(), nullity());
    });
  }

  Index nullity() const { return eta > 0 ? 0 : preparation->rigid_nullity(); }

  std::shared_ptr<const InterfaceFamily::Preparation> preparation;
  double eta;
  std::vector<EnrichedInertia> locals;

 private:
  Matrix assemble() const {
    const Index n = preparation->parts.interface_size();
    Matrix x = Matrix::Zero(n, n);
    std::vector<Matrix> condensed(locals.size());
    for_each_in_parallel(count(locals), [&](Index e) { condensed[nscdd::at(e)] = locals[nscdd::at(e)].condense(); });
    for (std::size_t e = 0; e < locals.size(); ++e) {
      const auto& touched = preparation->rows[e];
      const Matrix& local = condensed[e];
      for (std::size_t j = 0; j < touched.size(); ++j)
        for (std::size_t i = 0; i < touched.size(); ++i)
          x(touched[i], touched[j]) += local(static_cast<Index>(i), static_cast<Index>(j));
    }
    return x;
  }

  Lazy<EnrichedInertia> whole_;
  Lazy<Matrix> dense_;
  Lazy<KernelSplit> kernel_;
};

InterfaceOperator::InterfaceOperator(std::shared_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}

double InterfaceOperator::eta() const { return implementation_->eta; }
const Decomposition& InterfaceOperator::parts() const { return implementation_->preparation->parts; }
const SparseMatrix& InterfaceOperator::generic() const { return implementation_->preparation->inertia_operator(); }
Index InterfaceOperator::rows() const { return implementation_->preparation->parts.interface_size(); }
const Vector& InterfaceOperator::scale() const { return implementation_->preparation->scale; }

Vector InterfaceOperator::apply(const Vector& f) const {
  if (std::isinf(eta())) return generic() * f;
  const auto& subdomains = implementation_->preparation->parts.subdomains;
  std::vector<Vector> velocities(subdomains.size());
  for_each_in_parallel(count(subdomains), [&](Index e) {
    velocities[at(e)] = implementation_->locals[at(e)].solve(parts().interface.distribute(e, f));
  });
  return parts().interface.exchange(velocities);
}

const Matrix& InterfaceOperator::dense() const { return implementation_->dense(); }
const KernelSplit& InterfaceOperator::kernel() const { return implementation_->kernel(); }
Index InterfaceOperator::nullity() const { return implementation_->nullity(); }

Vector InterfaceOperator::solve(const Vector& g) const {
  const double eta = implementation_->eta;
  if (eta == 0) throw Error("interface operator: the rigid limit (eta = 0) has no inverse");
  const Decomposition& parts = implementation_->preparation->parts;
  const Index d = parts.dofs_per_grain();
  if (std::isinf(eta))
    return parts.interface.solve_generic(
        [&](const GrainCopy& copy, Index k) {
          return parts.subdomains[at(copy.subdomain)].inertia[d * copy.grain + k];
        },
        g);
  const auto& position = implementation_->preparation->whole().position;
  const auto multiply = [&](std::size_t e, const Vector& v) -> Vector {  // M_{E,eta} v
    const Subdomain& subdomain = parts.subdomains[e];
    return subdomain.inertia.cwiseProduct(v) + subdomain.h * (subdomain.h.transpose() * v) / eta;
  };
  // (M + K/eta) U = - sum_E R_E^T M_{E,eta} o_E
  std::vector<Vector> copies = parts.interface.copies_apart(g);  // o_E
  const auto whole_size =
      static_cast<Index>(std::count_if(position.begin(), position.end(), [](Index p) { return p >= 0; }));
  Vector right = Vector::Zero(d * whole_size);
  for (std::size_t e = 0; e < parts.subdomains.size(); ++e) {
    const Vector r = multiply(e, copies[e]);
    const auto& grains = parts.subdomains[e].grains;
    for (Index i = 0; i < count(grains); ++i) right.segment(d * position[at(grains[at(i)])], d) -= r.segment(d * i, d);
  }
  const Vector u = implementation_->whole().solve(right);
  std::vector<Vector> impulses;  // M_{E,eta} (R_E U + o_E) = A_E^T F
  for (std::size_t e = 0; e < parts.subdomains.size(); ++e) {
    const auto& grains = parts.subdomains[e].grains;
    for (Index i = 0; i < count(grains); ++i)
      copies[e].segment(d * i, d) += u.segment(d * position[at(grains[at(i)])], d);
    impulses.push_back(multiply(e, copies[e]));
  }
  return parts.interface.collect(std::move(impulses));
}

InterfaceFamily::InterfaceFamily(const Decomposition& parts, Index dense_limit)
    : preparation_(std::make_shared<const Preparation>(parts, dense_limit)) {}

InterfaceOperator InterfaceFamily::at(double eta) const {
  return InterfaceOperator(std::make_shared<const InterfaceOperator::Implementation>(preparation_, eta));
}

const Decomposition& InterfaceFamily::parts() const { return preparation_->parts; }

}  // namespace nscdd
