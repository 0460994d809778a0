// SPDX-License-Identifier: GPL-3.0-or-later
#include "spectrum_ends.hpp"
#include <nscdd/ddm/pencil_end.hpp>
#include <nscdd/linalg/range_projector.hpp>
#include <nscdd/linalg/threads.hpp>

#include <array>

namespace nscdd {
namespace {

// Above this many contacts the rank of the whole packing takes much memory. Eigenvalues lambda of the rigid
// limit then count as zero that are below the first of two shifts with none between them.
constexpr Index ranks_up_to = 1000000;
constexpr double rigid_zero = 1e-8, rigid_zero_again = 1e-11;
// Error of lambda for each unit of 1 / (mass epsilon), from the digits of M lost beside K/epsilon: several
// times the largest seen against dense spectra (tests/laws).
constexpr double rounding = 4e-16;

// In units of max(1, |lambda|).
double lost_to_rounding(const Contraction& b, double epsilon) {
  const double lightest = 0.25 * b.system.scale().maxCoeff();  // 1/mass
  return rounding * (1 + (epsilon > 0 ? lightest / epsilon : 0) + lightest / b.preconditioner.eta());
}

// Ends of the spectrum of (S, P), lambda = 1 - mu.
struct Ends {
  PencilEnd smallest, largest;
  bool found() const { return smallest.values.size() > 0 && largest.values.size() > 0; }
};

// What is known of the spectrum without computing: with the same contacts, M + K/epsilon lies between
// (M + K/eta) min(1, eta/epsilon) and (M + K/eta) max(1, eta/epsilon); fewer contacts in S make S larger.
PencilPoint known_bounds(const Contraction& b, double epsilon) {
  PencilPoint point{
      .epsilon = epsilon, .eta = b.preconditioner.eta(), .rounding = lost_to_rounding(b, epsilon)};
  const double ratio = std::isinf(point.eta) ? 0.0 : epsilon / point.eta;
  point.low = std::min(1.0, ratio);
  const bool same = &b.system.parts() == &b.preconditioner.parts();
  point.high = std::isinf(point.eta) ? 1.0 : (same ? std::max(1.0, ratio) : infinity);
  return point;
}

// In which coordinate an eigenvalue runs smoothly along a sweep: lambda > 0, and < 1 for the generic
// algorithm.
struct Coordinate {
  bool generic;
  double of(double lambda) const { return generic ? std::log(lambda / (1 - lambda)) : std::log(lambda); }
  double lambda(double t) const { return generic ? 1 / (1 + std::exp(-t)) : std::exp(t); }
};

// Polynomial through the last two or three points of one line of the sweep, on logarithmic axes.
std::optional<EndGuess> extrapolate(const PencilMemory& memory, const PencilPoint& point,
                                    double PencilMemory::Visited::*end) {
  const auto& visited = memory.visited;
  if (visited.size() < 2) return std::nullopt;
  const Coordinate coordinate{std::isinf(point.eta)};
  const bool along_epsilon = visited.back().eta == point.eta;
  const auto place = [&](double epsilon, double eta) { return std::log(along_epsilon ? epsilon : eta); };
  const double x = place(point.epsilon, point.eta);
  std::vector<double> xs, ys;
  for (auto v = visited.rbegin(); v != visited.rend(); ++v) {  // newest first
    xs.push_back(place(v->epsilon, v->eta));
    ys.push_back(coordinate.of((*v).*end));
  }
  const double slope = (ys[0] - ys[1]) / (xs[0] - xs[1]);
  double guess = ys[0] + slope * (x - xs[0]);
  double uncertainty = 0.3 * std::abs(guess - ys[0]);
  if (xs.size() > 2) {
    const double before = (ys[1] - ys[2]) / (xs[1] - xs[2]);
    const double curvature = (slope - before) / (xs[0] - xs[2]);
    const double correction = curvature * (x - xs[0]) * (x - xs[1]);
    guess += correction;
    uncertainty = 0.5 * std::abs(correction);
  }
  const double value = coordinate.lambda(guess);
  const double side = std::max(std::abs(coordinate.lambda(guess + uncertainty) - value),
                               std::abs(value - coordinate.lambda(guess - uncertainty)));
  if (!std::isfinite(value) || !std::isfinite(side) || !(value > 0)) return std::nullopt;
  return EndGuess{value, side};
}

// Points of another line are of no use; a point met again takes its own place.
void remember(PencilMemory& memory, const PencilPoint& point, const Ends& ends) {
  auto& visited = memory.visited;
  const auto on_line = [&](const PencilMemory::Visited& v) {
    return (v.epsilon == point.epsilon) != (v.eta == point.eta);
  };
  std::erase_if(visited, [&](const PencilMemory::Visited& v) { return !on_line(v); });
  if (visited.size() > 1 && (visited[0].eta == point.eta) != (visited[1].eta == point.eta))
    visited.erase(visited.begin());
  if (visited.size() > 2) visited.erase(visited.begin());
  visited.push_back({point.epsilon, point.eta, ends.smallest.values[0], ends.largest.values[0],
                     ends.smallest.vectors.col(0), ends.largest.vectors.col(0)});
}

// Of this problem, what another has left being thrown away.
const ShiftedPencilFamily& family_for(const Contraction& b, SystemForm form, PencilMemory& memory) {
  std::optional<ShiftedPencilFamily>& family = memory.families[std::isinf(b.preconditioner.eta()) ? 1 : 0];
  if (family && !family->serves(b, form)) memory = {};
  if (!family) family.emplace(b, form);
  return *family;
}

Ends find_ends(const Contraction& b, const PencilPoint& point, const EndOptions& options,
               PencilMemory& memory, SystemForm form) {
  const ShiftedPencilFamily& family = family_for(b, form, memory);
  const bool line = !memory.visited.empty() && ((memory.visited.back().eta == point.eta) !=
                                                (memory.visited.back().epsilon == point.epsilon));
  using Visited = PencilMemory::Visited;
  const auto guess = [&](double Visited::*end) {
    return line ? extrapolate(memory, point, end) : std::optional<EndGuess>{};
  };
  const auto start = [&](Vector Visited::*vector) {
    return memory.visited.empty() ? Vector{} : memory.visited.back().*vector;
  };
  Ends ends;
  ends.smallest = find_end(family, b.preconditioner, point, SpectrumEnd::smallest, guess(&Visited::smallest),
                           start(&Visited::smallest_vector), options);
  ends.largest = find_end(family, b.preconditioner, point, SpectrumEnd::largest, guess(&Visited::largest),
                          start(&Visited::largest_vector), options);
  if (ends.found()) remember(memory, point, ends);
  return ends;
}

// With the condensed form, and where that has lost the digits a proof needs (a shift can be relied on from a
// thousand times the rounding away, see ShiftedPencil::reliable), with the augmented one, which takes longer.
Ends find_flexible_ends(const Contraction& b, const PencilPoint& point, const EndOptions& options,
                        PencilMemory& memory) {
  const Ends ends = find_ends(b, point, options, memory, SystemForm::condensed);
  const auto converged = [&](const Ends& of) {
    return of.smallest.converged && of.largest.converged &&
           (!options.certify || (of.smallest.certified && of.largest.certified));
  };
  if (converged(ends) || 1e3 * point.rounding < 0.3 * options.tolerance) return ends;
  PencilMemory own;
  const Ends again = find_ends(b, point, options, own, SystemForm::augmented);
  return converged(again) ? again : ends;
}

SpectralRadius report(const Contraction& b, const Ends& ends, double epsilon, Index unit_multiplicity,
                      const SpectralOptions& options) {
  SpectralRadius result = ends.found() ? SpectralRadius{} : not_converged("shift-invert");
  result.solver = "shift-invert";
  result.unit_multiplicity = unit_multiplicity;
  result.applications = ends.smallest.solves + ends.largest.solves;
  result.factorisations = ends.smallest.factorisations + ends.largest.factorisations;
  if (!ends.found()) return result;
  set_ends(result, 1.0 - ends.largest.values[0], 1.0 - ends.smallest.values[0], unit_multiplicity);
  for (const double lambda : ends.largest.values) result.low.push_back(1.0 - lambda);
  for (const double lambda : ends.smallest.values) result.high.push_back(1.0 - lambda);
  result.mode_min = ends.largest.vectors.col(0);
  result.mode_max = ends.smallest.vectors.col(0);
  for (const PencilEnd* end : {&ends.smallest, &ends.largest})
    result.residual = std::max(result.residual, end->residual + lost_to_rounding(b, epsilon) *
                                                                    std::max(1.0, std::abs(end->values[0])));
  result.converged = ends.smallest.converged && ends.largest.converged && accurate(result, options.tolerance);
  result.certified = ends.smallest.certified && ends.largest.certified;
  result.interval_min = {1.0 - ends.largest.outside, 1.0 - ends.largest.inside};
  result.interval_max = {1.0 - ends.smallest.inside, 1.0 - ends.smallest.outside};
  result.within_min = ends.largest.within;
  result.within_max = ends.smallest.within;
  return result;
}

// The rigid limit knows the range of each H_E only: contacts that depend on the others of their subdomain are
// left out, and what stays is regular at epsilon = 0.
Decomposition without_dependent_contacts(const Decomposition& parts) {
  std::vector<char> kept(at(parts.contacts), 0);
  for_each_in_parallel(count(parts.subdomains), [&](Index e) {
    const Subdomain& subdomain = parts.subdomains[at(e)];
    for (const Index c : RangeProjector(subdomain.h).independent_columns())
      kept[at(subdomain.contacts[at(c)])] = 1;
  });
  return restrict_contacts(parts, kept);
}

// Eigenvalues lambda of the rigid limit that are 0, by inertia: an eigenvalue may be as small as 1e-8 without
// being one of them. None where no factorisation near 0 can be relied on, or where the two counts differ.
std::optional<Index> counted_at_zero(const ShiftedPencilFamily& family, double eta, Index& factorisations) {
  std::optional<Index> first;
  for (const double zero : {rigid_zero, rigid_zero_again}) {
    std::optional<Index> found;
    for (const double shift : {zero, 2 * zero, 5 * zero}) {
      ++factorisations;
      const ShiftedPencil pencil = family.at(0, eta, shift);
      if (!pencil.reliable()) continue;
      found = pencil.below();
      break;
    }
    if (!found || (first && *first != *found)) return std::nullopt;
    first = found;
  }
  return first;
}

// Interface impulses that the networks can carry either way give lambda = 0, a unit eigenvalue each. Their
// number comes from ranks, which no small eigenvalue can blur; shifts that count another number are not
// believed.
SpectralRadius rigid_radius(const Contraction& b, const SpectralOptions& options,
                            const EndOptions& end_options, SpectralMemory& memory) {
  std::optional<RigidLimit>& limit = memory.limit;
  if (!limit || &limit->met.parts() != &b.system.parts())
    limit.emplace(RigidLimit{b.system, InterfaceFamily(without_dependent_contacts(b.system.parts())).at(0),
                             std::nullopt});
  const Contraction regular{b.preconditioner, limit->regular, b.relaxation};
  PencilPoint point = known_bounds(b, 0);
  const ShiftedPencilFamily& family = family_for(regular, SystemForm::augmented, memory.rigid);
  Index factorisations = 0;
  if (!limit->kernel && b.system.parts().contacts > ranks_up_to)
    limit->kernel = counted_at_zero(family, point.eta, factorisations);
  if (!limit->kernel) limit->kernel = b.system.nullity();
  point.kernel = *limit->kernel;
  if (point.kernel == b.rows()) return all_unit(b.rows(), "shift-invert");
  SpectralRadius result =
      report(b, find_ends(regular, point, end_options, memory.rigid, SystemForm::augmented), 0, point.kernel,
             options);
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

SpectralRadius shift_invert_radius(const Contraction& b, const SpectralOptions& options,
                                   SpectralMemory& memory) {
  const double epsilon = b.system.eta();
  if (&b.system.parts() == &b.preconditioner.parts() && epsilon == b.preconditioner.eta())
    return no_error_left(b.rows(), options.eigenvalues);
  EndOptions end_options{
      .tolerance = options.tolerance, .eigenvalues = options.eigenvalues, .certify = options.certify};
  if (epsilon == 0) return rigid_radius(b, options, end_options, memory);
  const PencilPoint point = known_bounds(b, epsilon);
  return report(b, find_flexible_ends(b, point, end_options, memory.flexible), epsilon, 0, options);
}

}  // namespace nscdd
