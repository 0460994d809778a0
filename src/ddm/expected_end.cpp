// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/expected_end.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// Error of Taylor's first term for a unit step of log epsilon or log eta.
constexpr double curvature = 0.1;

// In which coordinate an eigenvalue runs smoothly along a sweep: lambda > 0, and < 1 for the generic
// algorithm.
struct Coordinate {
  bool generic;
  double of(double lambda) const { return generic ? std::log(lambda / (1 - lambda)) : std::log(lambda); }
  double slope(double lambda) const { return 1 / (generic ? lambda * (1 - lambda) : lambda); }
  double lambda(double t) const { return generic ? 1 / (1 + std::exp(-t)) : std::exp(t); }
};

// Steps of log epsilon and log eta.
struct Step {
  double epsilon, eta;
};

double logarithmic_step(double from, double to) { return from == to ? 0.0 : std::log(to / from); }

// A point visited: the coordinate of the end there, and how it moves with a step.
struct Known {
  double epsilon, eta, lambda, value, slope_epsilon, slope_eta;

  Known(const PencilMemory::Visited& visited, const PencilMemory::End& end, const Coordinate& coordinate)
      : epsilon(visited.epsilon),
        eta(visited.eta),
        lambda(end.lambda),
        value(coordinate.of(end.lambda)),
        slope_epsilon(end.slope_epsilon),
        slope_eta(end.slope_eta),
        scale_(coordinate.slope(end.lambda)) {}

  double move(const Step& step) const { return scale_ * (slope_epsilon * step.epsilon + slope_eta * step.eta); }
  Step to(double other_epsilon, double other_eta) const {
    return {logarithmic_step(epsilon, other_epsilon), logarithmic_step(eta, other_eta)};
  }

 private:
  double scale_;
};

struct Extrapolation {
  double value, uncertainty;
};

// Hermite's cubic along a line through both points, if they and the step are on one.
std::optional<Extrapolation> cubic(const Known& before, const Known& last, const Step& step) {
  const Step back = last.to(before.epsilon, before.eta);
  const double length = back.epsilon + back.eta;
  const bool along_one = (step.epsilon == 0 && back.epsilon == 0) || (step.eta == 0 && back.eta == 0);
  if (!along_one || length == 0 || !std::isfinite(length)) return std::nullopt;
  const double t = (step.epsilon + step.eta) / length;  // from the last point, towards the one before
  const double chord = before.value - last.value, slope = last.move(back), far_slope = before.move(back);
  const double quadratic = chord - slope, cubic = far_slope + slope - 2 * chord;
  return Extrapolation{(last.value + last.move(step)) + t * t * (quadratic + (t - 1) * cubic),
                       0.5 * std::abs(t * t * (t - 1) * cubic)};
}

}  // namespace

std::optional<EndGuess> expected_end(const PencilMemory& memory, const PencilPoint& point,
                                     PencilMemory::End PencilMemory::Visited::*end) {
  const auto& visited = memory.visited;
  if (visited.empty()) return std::nullopt;
  const Coordinate coordinate{std::isinf(point.eta)};
  const auto known = [&](const PencilMemory::Visited& v) { return Known(v, v.*end, coordinate); };
  const Known last = known(visited.back());
  const Step step = last.to(point.epsilon, point.eta);
  Extrapolation guess{last.value + last.move(step), curvature * (step.epsilon * step.epsilon + step.eta * step.eta)};
  if (visited.size() > 1) guess = cubic(known(visited.front()), last, step).value_or(guess);
  double lambda = coordinate.lambda(guess.value);
  double side = std::max(std::abs(coordinate.lambda(guess.value + guess.uncertainty) - lambda),
                         std::abs(lambda - coordinate.lambda(guess.value - guess.uncertainty)));
  // X_epsilon grows with epsilon, by no more than epsilon does, which bounds what a jump may extrapolate to.
  const double least = last.lambda * std::exp(std::min(0.0, step.epsilon) + std::min(0.0, -step.eta));
  const double most = last.lambda * std::exp(std::max(0.0, step.epsilon) + std::max(0.0, -step.eta));
  lambda = std::clamp(lambda, least, most);
  side = std::min(side, most - least);
  if (!std::isfinite(lambda) || !std::isfinite(side) || !(lambda > 0)) return std::nullopt;
  return EndGuess{lambda, side};
}

}  // namespace nscdd
