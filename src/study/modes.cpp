// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/modes.hpp"

#include "ddm/enriched_inertia.hpp"
#include "linalg/threads.hpp"
#include <nscdd/study/sweep.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace nscdd {
namespace {

// Components that differ by less, relatively, count as equal: rounding must not choose the sign of a mode.
constexpr double tie = 1e-6;

// At the best eta both ends are equal and opposite. Rounding must not choose between them, as in a sweep.
SpectrumSide resolve(SpectrumSide side, const SpectralRadius& spectrum) {
  if (side != SpectrumSide::slowest) return side;
  const bool low = std::abs(spectrum.subdominant_min) > std::abs(spectrum.subdominant_max) * (1 + 1e-9);
  return low ? SpectrumSide::low : SpectrumSide::high;
}

// V_E = - (M_E + K_E / epsilon)^-1 A_E^T F
std::vector<Vector> stage_one_velocities(const Decomposition& parts, double epsilon, const Vector& f) {
  std::vector<Vector> velocities(parts.subdomains.size());
  for_each_in_parallel(count(velocities), [&](Index e) {
    const Subdomain& subdomain = parts.subdomains[at(e)];
    if (subdomain.inertia.size() == 0) return;
    const EnrichedInertiaFamily family(subdomain, InterfaceFamily::default_dense_limit);
    velocities[at(e)] = EnrichedInertia(family, epsilon).solve(-parts.interface.distribute(e, f));
  });
  return velocities;
}

// Everything that follows from F.
void derive(Mode& mode, const Contraction& b) {
  const Vector pf = b.preconditioner.apply(mode.impulses);
  const Decomposition& parts = b.system.parts();
  mode.velocities = stage_one_velocities(parts, b.system.eta(), mode.impulses);
  mode.jumps = parts.interface.exchange(mode.velocities);
  const Vector r = mode.jumps + (1.0 - mode.eigenvalue) * pf;  // - S F + lambda P F
  mode.residual = std::sqrt(std::max(0.0, r.dot(b.preconditioner.solve(r))));
  const Index d = parts.dofs_per_grain();
  for (Index k = 0; k < count(parts.interface.gluing()); ++k)
    mode.shares.push_back(mode.impulses.segment(d * k, d).dot(pf.segment(d * k, d)));
}

}  // namespace

Vector normalised(const Vector& f, const InterfaceOperator& preconditioner) {
  const double threshold = (1 - tie) * f.cwiseAbs().maxCoeff();
  Index leading = 0;
  while (std::abs(f[leading]) < threshold) ++leading;
  const double norm = std::sqrt(f.dot(preconditioner.apply(f)));
  return f * (std::copysign(1.0, f[leading]) / norm);
}

Mode interface_mode(const Model& model, const ModeParameters& parameters) {
  const Selection selection = select(model, parameters.contacts);
  const InterfaceFamily stage_two(model.parts);
  // With the same contacts P and S are of one family and share what does not depend on the flexibility.
  const InterfaceFamily stage_one =
      parameters.contacts == ContactSet::all ? stage_two : InterfaceFamily(selection.stage_one);
  const Contraction b{stage_two.at(parameters.eta), stage_one.at(parameters.epsilon)};
  SpectralOptions options = parameters.spectral;
  // For the dense solver a second eigenvalue costs nothing. It tells whether the mode is one of several.
  if (choose_solver(b.rows(), parameters.epsilon == 0, options).solver == SpectralSolver::dense)
    options.eigenvalues = std::max<Index>(options.eigenvalues, 2);
  Mode mode;
  mode.spectrum = spectral_radius(b, options);
  mode.side = resolve(parameters.side, mode.spectrum);
  const bool low = mode.side == SpectrumSide::low;
  const Vector& found = low ? mode.spectrum.mode_min : mode.spectrum.mode_max;
  const std::vector<double>& values = low ? mode.spectrum.low : mode.spectrum.high;
  mode.eigenvalue = low ? mode.spectrum.subdominant_min : mode.spectrum.subdominant_max;
  if (values.size() > 1) mode.next = values[1];
  mode.converged = selection.certain && (mode.spectrum.converged || found.size() > 0);
  if (found.size() == 0) return mode;
  mode.impulses = normalised(found, b.preconditioner);
  derive(mode, b);
  // This judges one mode. The other end of the spectrum may not have converged.
  mode.converged = mode.converged && mode.residual <= options.tolerance * std::max(1.0, std::abs(mode.eigenvalue));
  return mode;
}

std::vector<InterfaceShare> shares_by_interface(const Decomposition& parts, const Mode& mode) {
  std::map<std::pair<Index, Index>, InterfaceShare> pairs;
  for (std::size_t k = 0; k < mode.shares.size(); ++k) {
    const Gluing& row = parts.interface.gluing()[k];
    const auto [first, second] = std::minmax(row.first.subdomain, row.second.subdomain);
    InterfaceShare& pair = pairs[{first, second}];
    pair = {first, second, pair.rows + 1, pair.share + mode.shares[k]};
  }
  std::vector<InterfaceShare> all;
  for (const auto& [key, pair] : pairs) all.push_back(pair);
  std::stable_sort(all.begin(), all.end(),
                   [](const InterfaceShare& a, const InterfaceShare& b) { return a.share > b.share; });
  return all;
}

double spread(const Mode& mode) {
  double sum = 0, squares = 0;
  for (const double share : mode.shares) {
    sum += std::abs(share);
    squares += share * share;
  }
  return sum * sum / squares;
}

}  // namespace nscdd
