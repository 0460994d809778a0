// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/continuation.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// Error of Taylor's first term for a unit step of log epsilon or log eta.
constexpr double curvature = 0.1;

// In which coordinate an eigenvalue runs smoothly along a sweep: lambda > 0, and < 1 for the generic algorithm.
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

template <class From, class To>
Step step_between(const From& from, const To& to) {
  const auto step = [](double a, double b) { return a == b ? 0.0 : std::log(b / a); };
  return {step(from.epsilon, to.epsilon), step(from.eta, to.eta)};
}

// The coordinate of an end at a point visited, and how it moves with a step.
struct Known {
  const PencilMemory::End& end;
  double value, slope;

  double move(const Step& step) const { return slope * (end.slope_epsilon * step.epsilon + end.slope_eta * step.eta); }
};

// Hermite's cubic through both points, if they and the step are on one line. `back`: from the last to the one before.
std::optional<EndGuess> cubic(const Known& before, const Known& last, const Step& back, const Step& step) {
  const double length = back.epsilon + back.eta;
  const bool along_one = (step.epsilon == 0 && back.epsilon == 0) || (step.eta == 0 && back.eta == 0);
  if (!along_one || length == 0 || !std::isfinite(length)) return std::nullopt;
  const double t = (step.epsilon + step.eta) / length;  // from the last point, towards the one before
  const double chord = before.value - last.value, slope = last.move(back), far_slope = before.move(back);
  const double quadratic = chord - slope, cubic = far_slope + slope - 2 * chord;
  return EndGuess{(last.value + last.move(step)) + t * t * (quadratic + (t - 1) * cubic),
                  0.5 * std::abs(t * t * (t - 1) * cubic)};
}

}  // namespace

std::optional<EndGuess> PencilMemory::expected(const PencilPoint& point, End Visited::*end) const {
  if (visited.empty()) return std::nullopt;
  const Coordinate coordinate{std::isinf(point.eta)};
  const auto known = [&](const Visited& v) {
    return Known{v.*end, coordinate.of((v.*end).lambda), coordinate.slope((v.*end).lambda)};
  };
  const Visited &before = visited.front(), &newest = visited.back();
  const Known last = known(newest);
  const Step step = step_between(newest, point);
  EndGuess guess{last.value + last.move(step), curvature * (step.epsilon * step.epsilon + step.eta * step.eta)};
  if (visited.size() > 1) guess = cubic(known(before), last, step_between(newest, before), step).value_or(guess);
  double lambda = coordinate.lambda(guess.value);
  double side = std::max(std::abs(coordinate.lambda(guess.value + guess.uncertainty) - lambda),
                         std::abs(lambda - coordinate.lambda(guess.value - guess.uncertainty)));
  // X_epsilon grows with epsilon, by no more than epsilon does, which bounds what a jump may extrapolate to.
  const double least = last.end.lambda * std::exp(std::min(0.0, step.epsilon) + std::min(0.0, -step.eta));
  const double most = last.end.lambda * std::exp(std::max(0.0, step.epsilon) + std::max(0.0, -step.eta));
  lambda = std::clamp(lambda, least, most);
  side = std::min(side, most - least);
  if (!std::isfinite(lambda) || !std::isfinite(side) || !(lambda > 0)) return std::nullopt;
  return EndGuess{lambda, side};
}

}  // namespace nscdd
