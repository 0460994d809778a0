// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/coarse.hpp"

#include "core/disjoint_sets.hpp"
#include "core/fail.hpp"
#include "ddm/local_preconditioner.hpp"
#include "linalg/multifrontal/analysis.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include "spectra/balanced_spectrum.hpp"
#include "study/linear/sweep_points.hpp"
#include "study/tables/study.hpp"

namespace nscdd {
namespace {

using Preconditioner = InterfacePreconditioner;

constexpr double ends_apart = BalancedSpectrum::end_width;  // relative, of the shifts that certify an end
constexpr Index most_lumped = 4000;

// The work of factorising a symmetric matrix stored in full. `group`: see SymmetricAnalysis.
FactorWork factor_work(const SparseMatrix& symmetric, const std::vector<Index>& group) {
  if (symmetric.rows() == 0) return {0, 0};
  const SymmetricAnalysis analysis(SparseMatrix(symmetric.triangularView<Eigen::Lower>()), group);
  return {analysis.entries(), analysis.work().flops(true)};
}

// The same, with the rows of each grain as a group.
FactorWork factor_work(const SparseMatrix& symmetric, Index dofs_per_grain) {
  std::vector<Index> grain(at(symmetric.rows()));
  for (Index i = 0; i < symmetric.rows(); ++i) grain[at(i)] = i / dofs_per_grain;
  return factor_work(symmetric, grain);
}

// The work of factorising M_E + K_E / eps.
FactorWork network_work(const Subdomain& subdomain, Index dofs_per_grain) {
  SparseMatrix k = subdomain.h * subdomain.h.transpose();
  return factor_work(k + diagonal_matrix(Vector::Ones(k.rows())), dofs_per_grain);
}

class CoarseStudy {
 public:
  CoarseStudy(const Model& model, const Selection& selection, const SweepParameters& sweep,
              const CoarseParameters& parameters)
      : parts_(selection.stage_one(model)),
        all_(model.parts),
        sweep_(sweep),
        parameters_(parameters),
        period_(model.network.period) {
    const Interface& glued = parts_.interface;
    const InterfaceOperator rigid = InterfaceFamily(parts_, 0, sweep.spectral.inertia).at(0);
    common_.of_case = selection.of_case;
    common_.scale = flexibility_scale(model);
    common_.self_stresses = rigid.nullity();
    common_.rank = parts_.interface_size() - common_.self_stresses;
    common_.clear_ranks = rigid.nullity_is_clear();
    glued.for_glued_grains([&](Index grain, Index, Index) {
      common_.primal_size += parts_.dofs_per_grain();
      common_.cross_points += glued.multiplicity(grain) > 2;
    });
    Matrix local = Matrix::Zero(2, count(parts_.subdomains));  // entries and flops of each
    for (Index e = 0; e < local.cols(); ++e) {
      const FactorWork work = network_work(parts_.subdomains[at(e)], parts_.dofs_per_grain());
      local.col(e) = Eigen::Vector2d(work.entries, work.flops);
    }
    const Vector sums = processes().sum_of_parts(std::move(local));
    common_.local = {sums[0], sums[1]};
    if (processes().alone()) common_.undivided = network_work(reassemble(parts_), parts_.dofs_per_grain());
  }

  CoarseResult solve(double epsilon, const CoarseMethod& method) {
    const OneBlasThread serial_blas;
    CoarseResult result = common_;
    result.epsilon = epsilon;
    result.method = method;
    if (!method.preconditioner) return result;
    if (method.preconditioner == Preconditioner::bddc) return solve_bddc(result, parts_, parameters_), result;
    result.modes = 0;
    result.coarse = {0, 0};
    const auto stage_two = [&] {
      const bool active = method.preconditioner == Preconditioner::active;
      solve_stage_two(result, parts_, active ? parts_ : all_, sweep_.spectral);
    };
    const bool local = is_local(*method.preconditioner);
    if (!local && !processes().alone()) return stage_two(), result;
    condense_at(epsilon);
    result.interface = interface_work_;
    if (local && !interface_->definite()) return result.converged = false, result;
    if (method.scaling && scaling_ != method.scaling) {
      auto weighted = std::make_shared<PrimalInterface>(*interface_);
      weigh(*weighted, *method.scaling);
      interface_ = weighted;
      scaling_ = method.scaling;
      one_level_ = {};
    }
    if (method.preconditioner == Preconditioner::lumped)
      lumped(result);
    else if (method.preconditioner == Preconditioner::dirichlet)
      dirichlet(result);
    else
      stage_two();
    return result;
  }

 private:
  const Processes& processes() const { return parts_.interface.processes(); }

  void condense_at(double epsilon) {
    if (interface_ && epsilon_ == epsilon) return;
    interface_ = std::make_shared<PrimalInterface>(condense(parts_, epsilon));
    epsilon_ = epsilon;
    scaling_ = {};
    if (!std::isnan(interface_work_.entries) || !interface_->definite()) return;
    interface_work_ = factor_work(interface_->sparse(), interface_->dofs_per_grain);
  }

  void iterate(CoarseResult& result, const LinearMap& inverse, const Vector& eigenvalues) const {
    solve_interface(
        result, [&](const Vector& f) { return interface_->apply_dual(f); }, inverse, parts_.interface_size(),
        eigenvalues);
  }

  void lumped(CoarseResult& result) const {
    const LinearMap p = local_preconditioner(interface_, Preconditioner::lumped);
    const Index n = parts_.interface_size();
    Vector eigenvalues;
    if (n <= most_lumped) {
      const Matrix product = symmetric_product(InterfaceFamily(parts_).at(epsilon_).dense(), [&](const Matrix& lower) {
        Matrix columns(n, n);
        for (Index k = 0; k < n; ++k) columns.col(k) = p(lower.col(k));
        return columns;
      });
      eigenvalues = symmetric_values(product);
      if (eigenvalues.size() > 0) {
        result.lambda_min = eigenvalues[0];
        result.lambda_max = eigenvalues[n - 1];
        const auto below = [&](double shift, auto&& holds) {  // false where there is no count
          const std::optional<Index> found = negative_eigenvalues(product - shift * Matrix::Identity(n, n));
          return found && holds(*found);
        };
        result.certified = below(result.lambda_max * (1 + ends_apart), [n](Index k) { return k == n; }) &&
                           below(result.lambda_max * (1 - ends_apart), [n](Index k) { return k < n; }) &&
                           below(result.lambda_min * (1 - ends_apart), [](Index k) { return k == 0; }) &&
                           below(result.lambda_min * (1 + ends_apart), [](Index k) { return k > 0; });
      }
    }
    result.converged = result.lambda_min > 0;
    iterate(result, p, eigenvalues);
  }

  void dirichlet(CoarseResult& result) {
    const bool geneo = result.method.space == CoarseSpace::geneo;
    CoarseVectors vectors{SparseMatrix(interface_->size(), 0), {}, {}};
    if (geneo) {
      result.threshold = parameters_.threshold.value_or(geneo_threshold(*interface_, parameters_.kappa.value_or(30)));
      result.bound = std::max(1.0, static_cast<double>(interface_->most_neighbours()) / result.threshold);
      vectors = geneo_vectors(*interface_, std::max(result.threshold, geneo_threshold(*interface_, wanted_kappas[0])));
    } else if (result.method.space == CoarseSpace::rigid) {
      vectors = rigid_vectors(*interface_, parts_, period_);
    }
    const CoarseProblem candidates(*interface_, vectors);
    const BalancedSpectrum spectrum(*interface_, candidates);
    const Index modes = geneo ? candidates.below(result.threshold) : candidates.size();
    result.modes = static_cast<double>(modes);
    result.lambda_max = spectrum.largest(modes);
    result.converged = std::isfinite(result.lambda_max);
    Vector eigenvalues = spectrum.all(modes);
    const bool known = eigenvalues.size() + modes >= interface_->size();
    if (one_level_.size() == 0) one_level_ = modes == 0 ? eigenvalues : spectrum.all(0);
    if (parts_.interface_size() + modes > interface_->size()) {  // P^-1 X_eps has ones that N C has not
      eigenvalues.conservativeResize(eigenvalues.size() + 1);
      eigenvalues.tail(1)[0] = 1;
    }
    result.lambda_min = eigenvalues.size() > 0 ? eigenvalues.minCoeff() : 1;
    const std::optional<double> width = spectrum.proved_width(result.lambda_min, result.lambda_max, modes);
    result.certified = width.has_value();
    for (std::size_t k = 0; k < wanted_kappas.size(); ++k) {
      if (one_level_.size() > 0) result.any[k] = static_cast<double>(fewest_deflated(one_level_, wanted_kappas[k]));
      if (const auto fewest = geneo ? spectrum.fewest(wanted_kappas[k]) : std::nullopt)
        result.fewest[k] = static_cast<double>(*fewest);
    }
    require_bounds(result, width == ends_apart);
    const auto coarse = std::make_shared<const CoarseProblem>(candidates.first(modes));
    if (modes > 0) {
      const SparseMatrix& u = coarse->vectors();
      result.coarse =
          factor_work(u.transpose() * SparseMatrix(interface_->sparse() * u), renumbered(coarse->subdomains()));
    }
    iterate(result, local_preconditioner(interface_, Preconditioner::dirichlet, coarse),
            known ? eigenvalues : Vector());
  }

  // A bound that is proved, violated by a sharp number, is an error of nscdd; otherwise rounding may be the cause.
  static void require_bounds(CoarseResult& result, bool sharp) {
    const bool bounded = !(result.bound < result.lambda_max * (1 - ends_apart));
    bool possible = true;
    for (std::size_t k = 0; k < wanted_kappas.size(); ++k) possible &= !(result.fewest[k] < result.any[k]);
    if (sharp && !(bounded && possible))
      fail(
          "{}: expected a largest eigenvalue of at most {} with GenEO, and no fewer vectors than {} and {}, met {}, "
          "{} and {}: this is an error of nscdd",
          result.of_case.name, result.bound, result.any[0], result.any[1], result.lambda_max, result.fewest[0],
          result.fewest[1]);
    result.converged &= bounded && possible;
  }

  const Decomposition& parts_;  // contacts of the system
  const Decomposition& all_;    // contacts of X_eta
  const SweepParameters& sweep_;
  const CoarseParameters& parameters_;
  const Period period_;
  CoarseResult common_;
  std::shared_ptr<const PrimalInterface> interface_;
  double epsilon_ = 0;
  std::optional<Scaling> scaling_;
  Vector one_level_;  // eigenvalues of the Dirichlet preconditioner without coarse space
  FactorWork interface_work_;
};

}  // namespace

Index coarse_spaces(const Model& model, const SweepParameters& sweep, const CoarseParameters& parameters,
                    const Sink<CoarseResult>& sink, const Monitor& monitor, Index first) {
  check_coarse(parameters);
  if (model.parts.interface_size() == 0)
    fail("{}: expected subdomains that share grains, met an empty interface", model.name);
  if (std::ranges::any_of(sweep.epsilon, [](double epsilon) { return epsilon == 0; }))
    fail("{}: expected epsilon > 0 for preconditioners of X_epsilon, met 0, where X_0 is singular", model.name);
  const std::vector<CoarseMethod> methods = methods_of(parameters);
  const Selection selection = select(model, sweep.contacts);
  CoarseStudy study(model, selection, sweep, parameters);
  const Index total = count(sweep.epsilon) * count(methods);
  Index failed = 0;
  for (Index number = first; number < total; ++number) {
    const double asked = sweep.epsilon[at(number / count(methods))];
    CoarseResult result = study.solve(sweep.relative_epsilon ? asked * flexibility_scale(model) : asked,
                                      methods[at(number % count(methods))]);
    result.converged &= selection.certain;
    failed += !result.converged;
    sink(result);
    if (!report(monitor, number + 1, total)) break;
  }
  return failed;
}

constinit const Observable observables::coarse_space{
    .name = "coarse_space",
    .summary = "condition numbers of preconditioned interface problems, and the coarse vectors that they need",
    .keys = {"epsilon", "contacts", "preconditioner", "scaling", "coarse_space", "kappa", "threshold", "counts"},
    .columns = [](const StudyTable& table) { return headings(coarse_columns(table.sweep.relative_epsilon)); },
    .run =
        [](const ObservedCase& work) {
          const SweepParameters& sweep = work.table.sweep;
          return coarse_spaces(build(work.one), sweep, work.table.coarse,
                               as_rows(coarse_columns(sweep.relative_epsilon), work.sink), work.monitor, work.first);
        },
    .rows = [](const StudyTable& table) { return count(table.sweep.epsilon) * count(methods_of(table.coarse)); },
    .known =
        [](const StudyTable& table, Index row) {
          const std::vector<CoarseMethod> methods = methods_of(table.coarse);
          const CoarseMethod& method = methods[at(row % count(methods))];
          KnownCells cells{{"preconditioner", to_cell(name_of(method.preconditioner))},
                           {"scaling", to_cell(name_of(method.scaling))},
                           {"coarse_space", to_cell(to_string(method.space))}};
          if (!table.sweep.relative_epsilon)
            cells.emplace_back("epsilon", table.sweep.epsilon[at(row / count(methods))]);
          return cells;
        }};

}  // namespace nscdd
