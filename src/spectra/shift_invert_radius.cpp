// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/enriched_inertia.hpp"
#include "linalg/threads.hpp"
#include "spectra/spectrum_memory.hpp"

namespace nscdd {
namespace {

// Error of Taylor's first term for a unit step of log epsilon or log eta.
constexpr double curvature = 0.1;

// Coordinate in which an eigenvalue is smooth along a sweep: lambda > 0, and < 1 for the generic algorithm.
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

Step step_between(const auto& from, const auto& to) {
  const auto step = [](double a, double b) { return a == b ? 0.0 : std::log(b / a); };
  return {step(from.epsilon, to.epsilon), step(from.eta, to.eta)};
}

// The coordinate of an end at a visited point, and its slope along a step.
struct Known {
  const PencilMemory::End& end;
  double value, slope;

  double move(const Step& step) const { return slope * (end.slope_epsilon * step.epsilon + end.slope_eta * step.eta); }
};

// Hermite's cubic through both points, if these and the step are on one line. `back`: from the last point back.
std::optional<EndGuess> cubic(const Known& before, const Known& last, const Step& back, const Step& step) {
  const double length = back.epsilon + back.eta;
  const bool along_one = (step.epsilon == 0 && back.epsilon == 0) || (step.eta == 0 && back.eta == 0);
  if (!along_one || length == 0 || !std::isfinite(length)) return std::nullopt;
  const double t = (step.epsilon + step.eta) / length;  // from the last point to the one before
  const double chord = before.value - last.value, slope = last.move(back), far_slope = before.move(back);
  const double quadratic = chord - slope, cubic = far_slope + slope - 2 * chord;
  return EndGuess{(last.value + last.move(step)) + t * t * (quadratic + (t - 1) * cubic),
                  0.5 * std::abs(t * t * (t - 1) * cubic)};
}

// With more contacts the rank of the whole packing, which every MPI rank computes, takes too much memory. The zero
// eigenvalues of the rigid limit are then those below the first of these two shifts, if none lies between the two.
constexpr Index ranks_up_to = 1000000;
constexpr double rigid_zero = 1e-8, rigid_zero_again = 1e-11;

// Ends of the spectrum of (S, P), lambda = 1 - mu.
struct Ends {
  PencilEnd smallest, largest;
  bool found() const { return smallest.values.size() > 0 && largest.values.size() > 0; }
  bool converged() const { return smallest.converged && largest.converged; }
  bool certified() const { return smallest.certified && largest.certified; }
};

bool has_contacts_of(const Decomposition& all, const Decomposition& some) {
  bool misses = false;
  for (std::size_t e = 0; e < all.subdomains.size(); ++e)
    misses |= !std::ranges::includes(all.subdomains[e].contacts, some.subdomains[e].contacts);
  return !all.interface.processes().any(misses);
}

// Bounds of the spectrum without a factorisation. If S and P have the same contacts, both are functions of M^-1 K: an
// eigenvalue kappa of it gives the ratio (1 + kappa/eta) / (1 + kappa/epsilon), which runs from 1 at kappa = 0 to its
// value at the largest kappa. Fewer contacts make S larger. If S has contacts that P has not, nothing is known.
PencilPoint known_bounds(const Contraction& b) {
  const double epsilon = b.system.flexibility();
  PencilPoint point{.epsilon = epsilon, .eta = b.preconditioner.flexibility(), .rounding = lost_to_rounding(b)};
  if (b.schwarz()) {  // 0 <= W <= q D
    point.low = epsilon > 0 ? epsilon / (epsilon + stiffest(b.system.decomposition())) : 0.0;
    point.high = static_cast<double>(largest_multiplicity(b.system.decomposition().interface));
    point.without = &b.system;
    return point;
  }
  const Decomposition &system = b.system.decomposition(), &preconditioner = b.preconditioner.decomposition();
  const bool same = &system == &preconditioner;
  const double kappa = stiffest(preconditioner);
  const double ratio = epsilon > 0 ? (1 + kappa / point.eta) / (1 + kappa / epsilon) : 0.0;
  point.low = same || has_contacts_of(preconditioner, system) ? std::min(1.0, ratio) : 0.0;
  point.high = std::isinf(point.eta) ? 1.0 : (same ? std::max(1.0, ratio) : infinity);
  return point;
}

void remember(PencilMemory& memory, const PencilPoint& point, const Ends& ends) {
  auto& visited = memory.visited;
  std::erase_if(visited,
                [&](const PencilMemory::Visited& v) { return v.epsilon == point.epsilon && v.eta == point.eta; });
  if (visited.size() > 1) visited.erase(visited.begin());
  const auto kept = [](const PencilEnd& end) {
    return PencilMemory::End{end.values[0], end.slope_epsilon, end.slope_eta, end.vectors.col(0)};
  };
  visited.push_back({point.epsilon, point.eta, kept(ends.smallest), kept(ends.largest)});
}

// The family of this problem. A memory of another problem is cleared.
const ShiftedPencilFamily& family_for(const Contraction& b, const InertiaMethod& method, PencilMemory& memory,
                                      SystemForm form, const std::shared_ptr<const RigidSystem>& rigid = {}) {
  std::optional<ShiftedPencilFamily>& family = memory.families[std::isinf(b.preconditioner.flexibility()) ? 1 : 0];
  if (family && !family->serves(b, form, method)) memory = {};
  if (!family) family.emplace(b, form, method, rigid);
  return *family;
}

Ends find_ends(const Contraction& b, const PencilPoint& point, const SpectralOptions& spectral,
               const ShiftedPencilFamily& family, PencilMemory& memory) {
  using Visited = PencilMemory::Visited;
  const EndOptions options{
      .tolerance = spectral.tolerance, .eigenvalues = spectral.eigenvalues, .certify = spectral.certify};
  const auto find = [&](SpectrumEnd end, PencilMemory::End Visited::*same) {
    const Vector start = memory.visited.empty() ? Vector{} : (memory.visited.back().*same).vector;
    return find_end(family, b.preconditioner, point, end, memory.expected(point, same), start, options);
  };
  Ends ends{.smallest = find(SpectrumEnd::smallest, &Visited::smallest),
            .largest = find(SpectrumEnd::largest, &Visited::largest)};
  family.release();
  if (ends.converged()) remember(memory, point, ends);
  return ends;
}

// Uses the condensed form or, if no shift near enough to an end was reliable with it, the slower augmented.
Ends find_flexible_ends(const Contraction& b, const PencilPoint& point, const SpectralOptions& options,
                        PencilMemory& memory) {
  const auto find_by = [&](SystemForm form, PencilMemory& known) {
    return find_ends(b, point, options, family_for(b, options.inertia, known, form), known);
  };
  const Ends ends = find_by(SystemForm::condensed, memory);
  const auto done = [&](const Ends& some) { return some.converged() && (!options.certify || some.certified()); };
  if (done(ends)) return ends;
  PencilMemory own;
  const Ends again = find_by(SystemForm::augmented, own);
  return done(again) ? again : ends;
}

// `tilt`: error of S, in units of X_infinity.
SpectralRadius report(const Contraction& b, const Ends& ends, Index unit_multiplicity, double tilt,
                      const SpectralOptions& options) {
  SpectralRadius result = ends.found()
                              ? SpectralRadius{}
                              : not_converged("shift-invert", "no end of the spectrum was proved", unit_multiplicity);
  result.solver = "shift-invert";
  result.applications = ends.smallest.solves + ends.largest.solves;
  result.factorisations = ends.smallest.factorisations + ends.largest.factorisations;
  if (!ends.found()) return result;
  set_ends(result, 1.0 - ends.largest.values[0], 1.0 - ends.smallest.values[0], unit_multiplicity);
  for (const double lambda : ends.largest.values) result.low.push_back(1.0 - lambda);
  for (const double lambda : ends.smallest.values) result.high.push_back(1.0 - lambda);
  const auto mode = [&](const PencilEnd& end) -> Vector {  // schwarz: resultants M_b (X - F) f
    const Vector f = end.vectors.col(0);
    return b.schwarz() ? Vector(f - b.preconditioner.solve_generic(b.system.apply(f))) : f;
  };
  result.mode_min = mode(ends.largest);
  result.mode_max = mode(ends.smallest);
  const auto off = [&](const PencilEnd& end) { return moved_by(tilt, std::max(end.values[0], end.outside), b); };
  for (const PencilEnd* end : {&ends.smallest, &ends.largest})
    result.residual = std::max(
        result.residual, end->residual + lost_to_rounding(b) * std::max(1.0, std::abs(end->values[0])) + off(*end));
  result.converged = ends.converged() && accurate(result, options.tolerance);
  if (!ends.converged() && accurate(result, options.tolerance))
    result.failure = "some of the wanted eigenvalues were not found or not proved";
  result.certified = ends.certified();
  const double off_min = off(ends.largest), off_max = off(ends.smallest);
  result.interval_min = {1.0 - ends.largest.outside - off_min, 1.0 - ends.largest.inside + off_min};
  result.interval_max = {1.0 - ends.smallest.inside - off_max, 1.0 - ends.smallest.outside + off_max};
  result.within_min = ends.largest.within;
  result.within_max = ends.smallest.within;
  return result;
}

// The number of eigenvalues lambda below a shift next to 0; nothing if no factorisation there is reliable.
std::optional<Index> counted_below(const ShiftedPencilFamily& family, double eta, double zero, Index& factorisations) {
  for (const double shift : {zero, 2 * zero, 5 * zero}) {
    ++factorisations;
    const ShiftedPencil pencil = family.at(0, eta, shift);
    if (pencil.reliable()) return pencil.below();
  }
  return std::nullopt;
}

// Whether `kernel` eigenvalues lie below the first reliable shift next to 0, beyond what rounding makes of zeros.
bool confirms(const ShiftedPencilFamily& family, const PencilPoint& point, Index kernel, Index& factorisations) {
  const double zero = std::max(rigid_zero_again, 10 * point.rounding);
  for (const double times : {1.0, 1e1, 1e2, 1e3, 1e4})
    if (const auto counted = counted_below(family, point.eta, times * zero, factorisations)) return *counted == kernel;
  return false;
}

// Self-stresses across the interface give lambda = 0, a unit eigenvalue each. Matrix ranks, which small eigenvalues do
// not disturb, give their number. A shift next to 0 must count the same number; otherwise nothing is proved.
SpectralRadius rigid_radius(const Contraction& b, const SpectralOptions& options, SpectrumMemory& memory) {
  std::optional<RigidLimit>& limit = memory.limit;
  if (!limit || &limit->met.decomposition() != &b.system.decomposition())
    limit.emplace(RigidLimit{b.system, std::make_shared<const RigidSystem>(rigid_system(b.system.decomposition())),
                             std::nullopt});
  PencilPoint point = known_bounds(b);
  const ShiftedPencilFamily& family = family_for(b, options.inertia, memory.rigid, SystemForm::rigid, limit->system);
  Index factorisations = 0;
  const Index processes = b.system.decomposition().interface.processes().size;
  if (!limit->kernel && b.system.decomposition().contacts > ranks_up_to / processes) {
    // By inertia. An eigenvalue may be as small as 1e-8 without being 0, so two shifts must count the same; else, or if
    // one is unreliable, there is no number.
    const std::optional<Index> zeros = counted_below(family, point.eta, rigid_zero, factorisations);
    if (zeros == counted_below(family, point.eta, rigid_zero_again, factorisations)) limit->kernel = zeros;
  }
  if (!limit->kernel) {
    limit->kernel = b.system.nullity();
    limit->confirmed = false;
  }
  if (!limit->system->conclusive)
    return not_converged("shift-invert", "the rank of the contacts of a subdomain is in doubt", *limit->kernel);
  if (!limit->confirmed)
    limit->confirmed = b.system.nullity_is_clear() && confirms(family, point, *limit->kernel, factorisations);
  if (!limit->confirmed)
    return not_converged("shift-invert", "no inertia count confirms the number of unit eigenvalues", *limit->kernel);
  point.kernel = *limit->kernel;
  if (point.kernel == b.rows()) return all_unit(b.rows(), "shift-invert", std::isfinite(limit->system->tilt));
  SpectralRadius result =
      report(b, find_ends(b, point, options, family, memory.rigid), point.kernel, limit->system->tilt, options);
  result.factorisations += factorisations;
  return result;
}

// S = P: every eigenvalue of B is 0, to the last bit.
SpectralRadius no_error_left(Index size, Index wanted) {
  SpectralRadius result;
  result.solver = "shift-invert";
  set_ends(result, 0.0, 0.0, 0);
  result.low = result.high = std::vector<double>(at(std::min(size, wanted)), 0.0);
  result.certified = true;
  result.interval_min = result.interval_max = {0.0, 0.0};
  result.within_min = result.within_max = size;
  return result;
}

}  // namespace

std::optional<EndGuess> PencilMemory::expected(const PencilPoint& point, End Visited::*end) const {
  if (visited.empty()) return std::nullopt;
  const bool schwarz = point.without != nullptr;
  const Coordinate coordinate{std::isinf(point.eta) && !schwarz};
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
  // X_epsilon grows with epsilon, and not faster: this bounds the extrapolation of a jump. With schwarz: towards 1.
  const double falls = schwarz ? -std::abs(step.epsilon) : std::min(0.0, step.epsilon) + std::min(0.0, -step.eta);
  const double grows = schwarz ? std::abs(step.epsilon) : std::max(0.0, step.epsilon) + std::max(0.0, -step.eta);
  const double least = last.end.lambda * std::exp(falls), most = last.end.lambda * std::exp(grows);
  lambda = std::clamp(lambda, least, most);
  side = std::min(side, most - least);
  if (!std::isfinite(lambda) || !std::isfinite(side) || !(lambda > 0)) return std::nullopt;
  return EndGuess{lambda, side};
}

SpectralRadius shift_invert_radius(const Contraction& b, const SpectralOptions& options, SpectrumMemory& memory) {
  const double epsilon = b.system.flexibility();
  if (&b.system.decomposition() == &b.preconditioner.decomposition() && epsilon == b.preconditioner.flexibility())
    return no_error_left(b.rows(), options.eigenvalues);
  if (epsilon == 0) return rigid_radius(b, options, memory);
  return report(b, find_flexible_ends(b, known_bounds(b), options, memory.flexible), 0, 0.0, options);
}

}  // namespace nscdd
