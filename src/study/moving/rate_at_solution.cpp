// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/random.hpp"
#include "study/moving/compared_rates.hpp"
#include "study/moving/moving_tables.hpp"

namespace nscdd {

template <int D>
double status_margin(const ContactLaw& law, const GrainContact<D>& contact, GrainVelocities<D> velocities) {
  const LocalVector<D> stop = stopping_impulse<D>(contact, velocities);
  const double n = stop.n + contact.pull;
  const bool rubs = contact.friction > 0 && std::visit([](const auto& one) { return one.rubs; }, law);
  if (n <= 0) return -n;
  return rubs ? std::min(n, std::abs(contact.friction * n - norm(stop.t))) : n;
}

template double status_margin(const ContactLaw&, const GrainContact<2>&, GrainVelocities<2>);
template double status_margin(const ContactLaw&, const GrainContact<3>&, GrainVelocities<3>);

namespace {

constexpr double solved = 1e-10, step_tolerance = 1e-13;  // natural map of a solution, and the tolerance
constexpr double near = 1e-6;                             // margin of a contact near another status
constexpr double perturbation = 1e-6;                     // of F_Gamma
constexpr double size_of_errors = 1e-7;                   // of the velocities, at the beginning of a part
constexpr Index parts_of_run = 100, parts_of_tenth = 10;
constexpr Index sweeps_of_power = 100;  // in the power of the frozen iteration whose radius is computed
constexpr double least_angle = 1e-12;   // sine between errors that are multiples of each other

// The solution of the next step, to rounding.
template <int D>
GranularStep<D> solution_of(Simulation simulation) {
  simulation.dynamics.solver = {.algorithm = StepAlgorithm::automatic,
                                .criterion = Criterion::natural_map,
                                .tolerance = step_tolerance,
                                .warm_start = true};
  return solve_step<D>(simulation);
}

template <int D>
void describe(RateAtSolution& result, const GranularStep<D>& solution) {
  double squares = 0, alone = solution.report.residual.scale.alone;
  std::vector<double> margins;
  for (const GrainContact<D>& contact : solution.contacts) {
    squares += squared(contact.impulse);
    margins.push_back(status_margin<D>(solution.problem.law, contact, solution.velocities));
  }
  const double scale =
      std::sqrt(std::max(squares, alone) / static_cast<double>(std::max<std::size_t>(1, margins.size())));
  if (scale == 0) return;  // no contact carries, nor would any alone
  for (double& margin : margins) margin /= scale;
  if (!margins.empty()) result.margin = *std::ranges::min_element(margins);
  result.near_edge = std::ranges::count_if(margins, [](double margin) { return margin <= near; });
}

// An error of the velocities of length exp(logarithm).
struct ErrorVector {
  Vector direction;
  double logarithm = 0;
};

// The rate of two modes per tenth of the run: the larger root of x^2 = a x + b in modulus, e_2 ~ a e_1 + b e_0 fitted.
double rate_of_two(const ErrorVector& e0, const ErrorVector& e1, const ErrorVector& e2) {
  const Vector second = std::exp(e1.logarithm - e0.logarithm) * e1.direction;
  const Vector third = std::exp(e2.logarithm - e0.logarithm) * e2.direction;
  const Vector across = second - e0.direction.dot(second) * e0.direction;
  if (!(across.norm() > least_angle * second.norm())) return not_a_number;
  const double a = across.dot(third) / across.squaredNorm();
  const double b = e0.direction.dot(third - a * second), discriminant = a * a / 4 + b;
  return discriminant < 0 ? std::sqrt(-b) : std::abs(a) / 2 + std::sqrt(discriminant);
}

// A run next to a solution, a tenth at a time.
template <int D>
class NearbyRun {
 public:
  NearbyRun(GranularTwoStage<D>& iteration, Vector solution, Index iterations)
      : iteration_(iteration),
        solution_(std::move(solution)),
        length_(std::max<Index>(1, iterations / parts_of_run)),
        speed_(iteration.parts().free_velocities().norm()) {
    run();
    statuses_ = iteration_.statuses();
    frozen_ = frozen_contacts(iteration_.parts(), statuses_);
    end_ = iteration_.state();
    end_velocities_ = iteration_.parts().free_velocities();
    const Vector f = solution_.tail(iteration_.parts().interface_size());
    const Vector direction = RandomStream(1).normal_vector(f.size());
    error_ = Vector::Zero(solution_.size());
    error_.tail(f.size()) = perturbation * f.norm() / direction.norm() * direction;
  }

  // A tenth of the run.
  ErrorVector advance() {
    Vector velocities;
    for (Index part = 0; part < parts_of_tenth; ++part) {
      iteration_.restart(solution_ + error_);
      run();
      velocities = iteration_.parts().free_velocities() - end_velocities_;
      const double factor = size_of_errors * speed_ / velocities.norm();
      error_ = factor * (iteration_.state() - end_);
      velocities *= factor;
      scaled_ += std::log(factor);
    }
    const double size = velocities.norm();
    return {velocities / size, std::log(size) - scaled_};
  }

  Index tenth() const { return parts_of_tenth * length_; }  // iterations
  Index changed() const { return changed_; }                // iterations with other statuses
  const std::vector<ContactStatus>& statuses() const { return statuses_; }
  const std::vector<FrozenContact<D>>& frozen() const { return frozen_; }

 private:
  void run() {
    for (Index i = 0; i < length_; ++i) {
      iteration_.iterate();
      changed_ += !statuses_.empty() && iteration_.statuses() != statuses_;
    }
  }

  GranularTwoStage<D>& iteration_;
  Vector solution_, end_, error_;  // states: of the solution, after a part from it, and the perturbation
  Vector end_velocities_;
  std::vector<ContactStatus> statuses_;
  std::vector<FrozenContact<D>> frozen_;
  Index length_, changed_ = 0;
  double speed_, scaled_ = 0;  // the logarithm of all factors
};

template <int D>
void observe(RateAtSolution& result, NearbyRun<D>& run) {
  std::vector<ErrorVector> errors;
  std::array<double, 2> now{}, change{};  // rates of one and of two modes
  for (Index k = 0; k < parts_of_run / parts_of_tenth; ++k) {
    errors.push_back(run.advance());
    if (errors.size() < 3) continue;
    const std::span<const ErrorVector> last = std::span(errors).last(3);
    const std::array<double, 2> before =
        std::exchange(now, {std::exp(last[2].logarithm - last[1].logarithm), rate_of_two(last[0], last[1], last[2])});
    for (std::size_t i = 0; i < 2; ++i) change[i] = std::abs(std::log(now[i] / before[i]));
  }
  const std::size_t best = change[1] < change[0] ? 1 : 0;
  const auto tenth = static_cast<double>(run.tenth());
  result.iterations = run.tenth() * parts_of_run / parts_of_tenth;
  result.changed = run.changed();
  if (result.changed > 0) return;
  result.observed = std::pow(now[best], 1 / tenth);
  result.observed_error = result.observed * change[best] / tenth;
  result.modes = static_cast<Index>(best) + 1;
}

template <int D>
RateAtSolution rate_in(const Simulation& simulation) {
  const StepSolver& solver = simulation.dynamics.solver;
  PreparedStep<D> step = prepare_solution<D>(simulation);
  const GranularStep<D> solution = solution_of<D>(simulation);
  RateAtSolution result;
  result.report = solution.report;
  result.report.interface_size = step.share.report.interface_size;
  result.report.eta = step.share.report.eta;
  describe(result, solution);
  if (!(result.report.residual.relative_natural_map() <= solved)) return result;

  const Vector z = restart_at(step.iteration, solution.contacts);
  const Vector before = step.iteration.parts().free_velocities();
  step.iteration.iterate();
  const double moved = (step.iteration.parts().free_velocities() - before).norm();
  result.drift = moved == 0 ? 0.0 : moved / before.norm();
  if (before.isZero(0) || z.tail(step.iteration.parts().interface_size()).isZero(0))
    return result;  // no error to watch
  step.iteration.restart(z);
  NearbyRun<D> run(step.iteration, z, solver.maximum_iterations);
  observe(result, run);
  predict(result, simulation, step.iteration.parts(), run.statuses(), run.frozen(), step.enriched,
          1 + sweeps_of_power / solver.gauss_seidel_sweeps / 2 * 2);
  return result;
}

ResultColumns<RateAtSolution> solved_rate_columns() {
  using At = RateAtSolution;
  return {
      {"natural_map", "1", "|natural map| / max(|r|, |r^1|) of the solution",
       [](const At& r) { return r.report.residual.relative_natural_map(); }},
      {"drift", "1", "|V_1 - V| / |V| of one iteration from the solution", &At::drift},
      {"active", "1", "contacts with an impulse at the solution", &At::active},
      {"stick", "1", "of them sticking", &At::stick},
      {"slide", "1", "of them sliding", &At::slide},
      {"margin", "1", "smallest distance of a contact from another status, over the mean impulse", &At::margin},
      {"near_edge", "1", "contacts whose distance is at most 1e-6", &At::near_edge},
      {"predicted", "1", "spectral radius of the frozen iteration with n_GS sweeps", &At::predicted},
      {"complex_pair", "", "whether its dominant eigenvalue is one of a complex pair", &At::complex_pair},
      {"predicted_exact", "1", "radius with an exact Stage 1; nan for large packings", &At::predicted_exact},
      {"observed", "1", "factor per iteration of the error of the velocities; nan if a status changed", &At::observed},
      {"observed_error", "1", "its change over the last tenth of the run", &At::observed_error},
      {"modes", "1", "modes in the observation, 1 or 2; 0 without one", &At::modes},
      {"relative_gap", "1", "|observed - predicted| / |1 - predicted|", &At::relative_gap},
      {"agree", "", "whether that is at most 1 %, or the rates differ by at most three errors", &At::agree},
      {"iterations", "1", "iterations run", &At::iterations},
      {"changed", "1", "of them those in which a contact had another status than in the solution", &At::changed},
      {"converged", "", "whether solution, prediction and observation are known", &At::known}};
}

}  // namespace

RateAtSolution rate_at_solution(const Simulation& simulation) {
  require_comparable(simulation.dynamics, simulation.partitioner);
  return in_dimension(simulation.system, [&](auto dimension) { return rate_in<dimension()>(simulation); });
}

constinit const Observable observables::rate_at_solution = examined_steps<solved_rate_columns, nscdd::rate_at_solution>(
    {.name = "rate_at_solution",
     .summary = "rate of Algorithm 1 next to the solution of a step with friction, predicted and observed",
     .check = [](const CaseSpec& spec) { require_comparable(*spec.dynamics, spec.partition); }});

}  // namespace nscdd
