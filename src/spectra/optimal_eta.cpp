// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/scalar.hpp"
#include "spectra/spectrum_memory.hpp"
#include <nscdd/spectra/optimal_eta.hpp>

namespace nscdd {
namespace {

constexpr double decades = 8;  // searched on either side of the natural scale

// Ends of the spectrum of X_eta^-1 S outside its kernel.
struct SpectrumEnds {
  double min = not_a_number, max = not_a_number;
  bool converged = false;
  double residual = 0;
  std::string failure = {};

  double imbalance() const { return min + max - 2; }  // 0 where both are equal and opposite about 1
  double radius() const { return std::max(std::abs(1 - min), std::abs(1 - max)); }
  double relaxed_radius() const { return (max - min) / (max + min); }
  double relaxation() const { return 2 / (max + min); }
};

class Spectra {
 public:
  Spectra(const Decomposition& parts, InterfaceOperator system, const SpectralOptions& options)
      : family_(parts), system_(std::move(system)), options_(options) {}

  SpectrumEnds at(double eta) {
    const SpectralRadius radius = spectral_radius({family_.at(eta), system_}, options_, &memory_);
    ++best.spectra;
    best.unit_multiplicity = radius.unit_multiplicity;
    return {1 - radius.subdominant_max, 1 - radius.subdominant_min, radius.converged, radius.residual, radius.failure};
  }

  // At a reported point. (A search also tries an eta at which X_eta is numerically singular: residuals do not count.)
  SpectrumEnds reported(double eta) {
    const SpectrumEnds ends = at(eta);
    best.residual = std::max(best.residual, ends.residual);
    if (all_converged && !ends.converged) best.failure = fmt::format("eta = {}: {}", eta, ends.failure);
    all_converged = all_converged && ends.converged;
    return ends;
  }

  Optimum best;
  bool all_converged = true;

 private:
  InterfaceFamily family_;
  InterfaceOperator system_;
  SpectralOptions options_;
  SpectrumMemory memory_;
};

struct Range {
  double low, high;

  explicit Range(const InterfaceOperator& x)
      : low(x.scale().mean() * std::pow(10.0, -decades)), high(x.scale().mean() * std::pow(10.0, decades)) {}

  // Where a decreasing function of log eta vanishes; 0 if it is negative throughout.
  double decreasing_root(auto&& f, double tolerance) const {
    const auto of_log = [&](double x) { return f(std::exp(x)); };
    double upper = std::log(high);
    if (of_log(upper) >= 0) return high;  // no root below
    // Decade by decade from above: the ends grow like 1/eta below their root, so the bracket should be narrow.
    while (upper > std::log(low)) {
      const double lower = std::max(upper - std::log(10.0), std::log(low));
      if (of_log(lower) >= 0) return std::exp(find_root(of_log, lower, upper, tolerance).x);
      upper = lower;
    }
    return 0;
  }
};

void find_relaxed(Spectra& spectra, const Range& range) {
  Optimum& best = spectra.best;
  const int samples = 4 * static_cast<int>(2 * decades) + 1;
  const auto radius = [&](double x) {
    const SpectrumEnds ends = spectra.at(std::exp(x));
    return ends.converged ? ends.relaxed_radius() : 1.0;  // known relaxed radii are below 1
  };
  const double first = std::log(range.low), length = std::log(range.high) - first;
  const auto point = [&](int i) { return first + length * i / (samples - 1); };
  std::vector<double> values;
  for (int i = 0; i < samples; ++i) values.push_back(radius(point(i)));
  const auto least = std::min_element(values.begin(), values.end());
  const auto lowest = static_cast<int>(least - values.begin());
  double x = point(lowest);
  if (best.generic_relaxed_radius <= *least * (1 + 1e-6)) {  // enriching does not pay
    best.relaxed_status = OptimumStatus::eta_to_infinity;
    best.relaxed_eta = infinity;
    best.relaxed_radius = best.generic_relaxed_radius;
    best.relaxation = best.generic_relaxation;
    return;
  }
  // If the curve is flat at the low end but for rounding, its infimum is there.
  if (lowest == 0 || values.front() <= *least * (1 + 1e-6)) {
    best.relaxed_status = OptimumStatus::eta_to_zero;
    x = point(0);
  } else if (lowest + 1 < samples && values[at(lowest - 1)] > *least && values[at(lowest + 1)] > *least) {
    x = find_minimum(radius, point(lowest - 1), x, point(lowest + 1), 1e-6).x;
  }
  const SpectrumEnds ends = spectra.reported(std::exp(x));
  best.relaxed_eta = std::exp(x);
  best.relaxed_radius = ends.relaxed_radius();
  best.relaxation = ends.relaxation();
}

}  // namespace

Optimum optimum(const Decomposition& parts, const Decomposition& stage_one, double epsilon,
                const SpectralOptions& options) {
  if (parts.interface_size() == 0)
    return {.status = OptimumStatus::no_interface, .relaxed_status = OptimumStatus::no_interface};
  const InterfaceOperator system = InterfaceFamily(stage_one).at(epsilon);
  Spectra spectra(parts, system, options);
  Optimum& best = spectra.best;
  const SpectrumEnds generic = spectra.reported(infinity);
  best.generic_radius = generic.radius();
  best.generic_relaxed_radius = generic.relaxed_radius();
  best.generic_relaxation = generic.relaxation();
  const auto finish = [&](OptimumStatus status) {
    best.status = spectra.all_converged ? status : OptimumStatus::not_converged;
    if (best.status != OptimumStatus::interior && best.status != OptimumStatus::eta_to_zero)
      best.relaxed_status = best.status;
    return best;
  };
  if (best.unit_multiplicity == parts.interface_size()) return finish(OptimumStatus::all_unit);
  // A radius within its residual cannot be told from 0, and its spectra have no ends to search for.
  if (!(best.generic_radius > std::max(1e-14, best.residual))) return finish(OptimumStatus::already_exact);

  Range range(system);
  if (epsilon > 0) {  // the root of the linear case is eta = epsilon: the range must contain it
    range.low = std::min(range.low, epsilon / 100);
    range.high = std::max(range.high, epsilon * 100);
  }
  const auto root = [&](auto&& f) { return range.decreasing_root([&](double e) { return f(spectra.at(e)); }, 1e-12); };
  const double eta = root([](const SpectrumEnds& ends) { return ends.imbalance(); });
  best.eta = eta > 0 ? eta : range.low;
  best.radius = spectra.reported(best.eta).radius();
  best.convergent_from = root([](const SpectrumEnds& ends) { return ends.max - 2; });
  best.better_from = root([&](const SpectrumEnds& ends) { return ends.max - 1 - best.generic_radius; });
  for (const double threshold : {best.convergent_from, best.better_from})
    if (threshold > 0) spectra.reported(threshold);
  find_relaxed(spectra, range);
  return finish(eta > 0 ? OptimumStatus::interior : OptimumStatus::eta_to_zero);
}

double stable_eta(const Decomposition& parts, double relaxation, const SpectralOptions& options) {
  if (parts.interface_size() == 0) return 0;
  const InterfaceOperator generic = InterfaceFamily(parts).at(infinity);
  Spectra spectra(parts, generic, options);
  // max - 2/omega falls from large values at eta = 0 to 1 - 2/omega.
  return Range(generic).decreasing_root([&](double eta) { return relaxation * spectra.at(eta).max - 2; }, 1e-3);
}

double optimal_eta(const Decomposition& parts, const Decomposition& active, const SpectralOptions& options) {
  if (parts.interface_size() == 0) return infinity;
  const InterfaceOperator system = InterfaceFamily(active).at(0.0);
  Spectra spectra(parts, system, options);
  const Range range(system);
  const auto imbalance = [&](double eta) { return spectra.at(eta).imbalance(); };
  if (imbalance(range.high) >= 0) return range.high;
  const double root = range.decreasing_root(imbalance, 1e-3);
  if (root > 0) return root;
  // With an exact Stage 1 the radius falls to 0. Nine tenths of the gain are enough.
  const double generic = spectra.at(range.high).radius(), best = spectra.at(range.low).radius();
  double eta = range.high;
  while (eta > range.low && spectra.at(eta).radius() > best + 0.1 * (generic - best)) eta /= std::sqrt(10.0);
  return std::max(eta, range.low);
}

}  // namespace nscdd
