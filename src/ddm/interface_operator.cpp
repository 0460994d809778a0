// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "core/memory.hpp"
#include "ddm/enriched_inertia.hpp"
#include "ddm/shifted_pencil.hpp"
#include "linalg/pencil.hpp"
#include "linalg/threads.hpp"
#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {
namespace {

// The rank of H of the undivided packing. Its rows may lie on any MPI rank.
MatrixRank rank_of_whole(const Decomposition& parts) {
  struct Place {
    Index grain;
    std::array<double, 3> centre;  // d of these
  };
  const Index d = parts.dofs_per_grain();
  const Processes& processes = parts.interface.processes();
  std::vector<Eigen::Triplet<double, Index>> own;
  std::vector<Place> places;
  bool unknown = false;
  for (const Subdomain& subdomain : parts.subdomains) {
    for_entries(subdomain.h, [&](Index i, Index j, double value) {
      own.emplace_back(d * subdomain.grains[at(i / d)] + i % d, subdomain.contacts[at(j)], value);
    });
    unknown |= subdomain.centres.cols() != count(subdomain.grains);
    for (Index i = 0; i < subdomain.centres.cols(); ++i) {
      places.push_back({subdomain.grains[at(i)], {}});
      std::copy_n(subdomain.centres.col(i).data(), d, places.back().centre.data());
    }
  }
  const Index rows = d * parts.interface.grains();
  SparseMatrix h(rows, parts.contacts);
  own = processes.gather(own);
  h.setFromTriplets(own.begin(), own.end());
  Matrix centres;
  if (!processes.any(unknown)) {
    centres = Matrix::Zero(d, parts.interface.grains());
    for (const Place& one : processes.gather(places))
      centres.col(one.grain) = Eigen::Map<const Vector>(one.centre.data(), d);
  }
  return rigid_rank(d, centres, Vector::Ones(rows), h);
}

}  // namespace

// The subdomain families, and all else that does not depend on eta.
class InterfaceFamily::Preparation {
 public:
  Preparation(const Decomposition& decomposition, Index limit, InertiaMethod method)
      : parts(decomposition),
        dense_limit(limit),
        inertia(std::move(method)),
        row_inertia(Vector::Zero(parts.interface_size())),
        locals(parts.subdomains.size()) {
    double modes = 0;
    for (const Subdomain& one : parts.subdomains)
      if (const Index n = one.inertia.size(); n <= limit) modes += bytes_of_matrix(n, n);
    require_memory(modes, fmt::format("the modes of {} subdomains", parts.subdomains.size()), "fewer grains");
    for_each_in_parallel(count(locals),
                         [&](Index e) { locals[nscdd::at(e)].emplace(parts.subdomains[nscdd::at(e)], dense_limit); });
    const Index d = parts.dofs_per_grain();
    for (Index e = 0; e < count(locals); ++e)
      for (const Tie& tie : parts.interface.ties(e))
        if (tie.sign > 0)  // the first of the two copies of the row
          row_inertia.segment(d * tie.row, d) = parts.subdomains[nscdd::at(e)].inertia.segment(d * tie.grain, d);
    parts.interface.processes().add_up({row_inertia.data(), nscdd::at(row_inertia.size())});
    const std::vector<Gluing>& gluing = parts.interface.gluing();
    scale = (!gluing.empty() && gluing[0].second.subdomain < 0 ? 1 : 2) * row_inertia.cwiseInverse();
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
      const Index d = parts.dofs_per_grain();
      for (const Subdomain& subdomain : parts.subdomains) {
        auto& rows = whole.rows.emplace_back();
        for (const Index grain : subdomain.grains) {
          const Index place = std::ranges::lower_bound(assembled.grains, grain) - assembled.grains.begin();
          for (Index k = 0; k < d; ++k) rows.push_back(d * place + k);
        }
      }
      return whole;
    });
  }

  Decomposition parts;
  Index dense_limit;
  InertiaMethod inertia;
  Vector row_inertia;  // of the copies that a row ties, equal for all copies of a grain
  Vector scale;
  std::vector<std::optional<EnrichedInertiaFamily>> locals;
  Lazy<SparseMatrix> generic;
  Lazy<MatrixRank> nullity;

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

  // f(e, M_{E,eta}) of every subdomain, called in parallel.
  template <class Function>
  auto of_each(const Function& f) const {
    std::vector<std::invoke_result_t<Function, Index, const EnrichedInertia&>> results(locals.size());
    for_each_in_parallel(count(locals), [&](Index e) { results[nscdd::at(e)] = f(e, *locals[nscdd::at(e)]); });
    return results;
  }
  // V_E = M_{E,eta}^-1 A_E^T F
  Vector velocities(Index e, const EnrichedInertia& local, const Vector& f) const {
    return local.solve(preparation->parts.interface.distribute(e, f));
  }

  // Nullity of X_0 by ranks, which do not depend on masses; eigenvalues of X_0 do.
  const MatrixRank& ranks() const {
    return preparation->nullity.get([this] {
      const Decomposition& parts = preparation->parts;
      const Processes& processes = parts.interface.processes();
      Index local = 0;
      bool unclear = false;
      for (const Subdomain& subdomain : parts.subdomains) {
        const MatrixRank rank = rigid_rank(parts.dofs_per_grain(), subdomain.centres, subdomain.inertia, subdomain.h);
        local += rank.value;
        unclear |= !rank.clear;
      }
      const MatrixRank undivided = rank_of_whole(parts);
      const Index nullity = processes.sum(local) - undivided.value;
      return MatrixRank{std::max<Index>(nullity, 0), !processes.any(unclear || !undivided.clear || nullity < 0)};
    });
  }

  std::shared_ptr<const InterfaceFamily::Preparation> preparation;
  double eta;
  std::vector<std::optional<EnrichedInertia>> locals;
  Lazy<std::unique_ptr<const EnrichedInertia>> whole;
  Lazy<ShiftedPencil> unshifted;
  Lazy<Matrix> dense;
  Lazy<KernelSplit> kernel;
};

InterfaceOperator::InterfaceOperator(std::shared_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}

double InterfaceOperator::flexibility() const { return implementation_->eta; }
const Decomposition& InterfaceOperator::decomposition() const { return implementation_->preparation->parts; }
Index InterfaceOperator::rows() const { return decomposition().interface_size(); }
const Vector& InterfaceOperator::scale() const { return implementation_->preparation->scale; }

// sum_E A_E M_E^-1 A_E^T: it couples two rows of a grain through the copies that both tie.
const SparseMatrix& InterfaceOperator::generic() const {
  return implementation_->preparation->generic.get([this] {
    const std::vector<Gluing>& gluing = decomposition().interface.gluing();
    const Vector& inertia = implementation_->preparation->row_inertia;
    const Index d = decomposition().dofs_per_grain();
    const auto same = [](const GrainCopy& a, const GrainCopy& b) {
      return a.subdomain == b.subdomain && a.subdomain >= 0 ? 1.0 : 0.0;  // -1: no copy
    };
    SparseEntries entries;
    for (Index row = 0; row < count(gluing); ++row) {
      const Gluing& own = gluing[at(row)];
      Index other = row;
      while (other > 0 && gluing[at(other - 1)].grain == own.grain) --other;
      for (; other < count(gluing) && gluing[at(other)].grain == own.grain; ++other) {
        const Gluing& met = gluing[at(other)];
        const double signs = same(own.first, met.first) + same(own.second, met.second) - same(own.first, met.second) -
                             same(own.second, met.first);
        for (Index k = 0; k < d && signs != 0; ++k)
          entries.add(d * row + k, d * other + k, signs / inertia[d * row + k]);
      }
    }
    return entries.matrix(rows(), rows());
  });
}

Vector InterfaceOperator::apply(const Vector& f) const {
  if (std::isinf(flexibility())) return generic() * f;
  return decomposition().interface.exchange(implementation_->of_each(
      [&](Index e, const EnrichedInertia& local) { return implementation_->velocities(e, local, f); }));
}

double InterfaceOperator::slope(const Vector& f) const {
  if (flexibility() == 0 || std::isinf(flexibility())) return 0;
  const auto terms = implementation_->of_each([&](Index e, const EnrichedInertia& local) {
    const Vector links = decomposition().subdomains[at(e)].h.transpose() * implementation_->velocities(e, local, f);
    return links.squaredNorm() / flexibility();
  });
  return decomposition().interface.processes().sum(std::accumulate(terms.begin(), terms.end(), 0.0));
}

const Matrix& InterfaceOperator::dense() const {
  return implementation_->dense.get([this] {
    const auto condensed =
        implementation_->of_each([](Index, const EnrichedInertia& local) { return local.condense(); });
    Matrix x = Matrix::Zero(rows(), rows());
    for (std::size_t e = 0; e < condensed.size(); ++e) {
      const auto& touched = implementation_->preparation->locals[e]->rows();
      x(touched, touched) += condensed[e];
    }
    decomposition().interface.processes().add_up({x.data(), at(x.size())});
    return x;
  });
}

const KernelSplit& InterfaceOperator::kernel() const {
  return implementation_->kernel.get([this] {
    const Vector root = scale().cwiseSqrt().cwiseInverse();
    return split_kernel(root.asDiagonal() * dense() * root.asDiagonal(), nullity());
  });
}

Index InterfaceOperator::nullity() const { return flexibility() > 0 ? 0 : implementation_->ranks().value; }
bool InterfaceOperator::nullity_is_clear() const { return flexibility() > 0 || implementation_->ranks().clear; }

double InterfaceOperator::uncertainty() const {
  if (flexibility() > 0) return 0;
  const double rounding = std::max(1e-11, 2e-15 * static_cast<double>(rows()) * std::sqrt(ratio_of_masses()));
  if (!nullity_is_clear() || (nullity() > 0 && kernel().largest > rounding)) return infinity;
  const auto own = implementation_->of_each([](Index, const EnrichedInertia& local) { return local.uncertainty(); });
  return decomposition().interface.processes().maximum(own.empty() ? 0 : std::ranges::max(own));
}

double InterfaceOperator::ratio_of_masses() const {
  Eigen::Array2d largest(0, 0);  // inertia, and its inverse
  for (const Subdomain& one : decomposition().subdomains)
    if (one.inertia.size() > 0)
      largest = largest.max(Eigen::Array2d(one.inertia.maxCoeff(), 1 / one.inertia.minCoeff()));
  const Processes& processes = decomposition().interface.processes();
  return processes.maximum(largest[0]) * processes.maximum(largest[1]);
}

Vector InterfaceOperator::solve_generic(const Vector& g) const {
  const Vector& inertia = implementation_->preparation->row_inertia;
  const Index d = decomposition().dofs_per_grain();
  return decomposition().interface.solve_generic([&](Index row, Index k) { return inertia[d * row + k]; }, g);
}

Vector InterfaceOperator::solve(const Vector& g) const {
  const double eta = flexibility();
  if (eta == 0) throw Error("interface operator: the rigid limit (eta = 0) has no inverse");
  if (std::isinf(eta)) return solve_generic(g);
  const auto& subdomains = decomposition().subdomains;
  const Interface& interface = decomposition().interface;
  if (implementation_->preparation->inertia.analyse || !interface.processes().alone()) return solve_on_interface(g);
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

// X_eta is the pencil S - sigma P at sigma = 0, for any P; the inertia costs least. It must not hold this operator.
Vector InterfaceOperator::solve_on_interface(const Vector& g) const {
  const auto preparation = implementation_->preparation;
  if (!preparation->inertia.analyse)
    fail("processes: expected one, or a way to factorise, for solutions with X_eta, met {}",
         decomposition().interface.processes().size);
  const ShiftedPencil& pencil = implementation_->unshifted.get([&] {
    const auto again = [&](double flexibility) {
      return InterfaceOperator(std::make_shared<const Implementation>(preparation, flexibility));
    };
    const ShiftedPencilFamily family({again(infinity), again(flexibility())}, SystemForm::condensed,
                                     preparation->inertia);
    return family.at(flexibility(), infinity, 0, SolutionAccuracy::refined);
  });
  const bool definite = pencil.reliable() && pencil.below() == 0;
  return definite ? pencil.solve(g) : Vector::Constant(g.size(), not_a_number);
}

InterfaceFamily::InterfaceFamily(const Decomposition& parts, Index dense_limit, InertiaMethod inertia)
    : preparation_(std::make_shared<const Preparation>(parts, dense_limit, std::move(inertia))) {}

InterfaceOperator InterfaceFamily::at(double eta) const {
  return InterfaceOperator(std::make_shared<const InterfaceOperator::Implementation>(preparation_, eta));
}

}  // namespace nscdd
