// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/continuation.hpp"
#include "linalg/scalar_search.hpp"
#include <nscdd/ddm/optimal_eta.hpp>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

constexpr double decades = 8;             // searched on either side of the natural scale
constexpr double root_tolerance = 1e-12;  // on log eta

// Ends of the spectrum of X_eta^-1 S outside its kernel.
struct Ends {
  double min = not_a_number, max = not_a_number;
  bool converged = false;
  double radius() const { return std::max(std::abs(1 - min), std::abs(1 - max)); }
  double relaxed_radius() const { return (max - min) / (max + min); }
  double relaxation() const { return 2 / (max + min); }
};

class Spectra {
 public:
  Spectra(const Decomposition& parts, InterfaceOperator system, const SpectralOptions& options)
      : family_(parts), system_(std::move(system)), options_(options) {}

  Ends at(double eta) {
    const SpectralRadius radius = spectral_radius({family_.at(eta), system_}, options_, &memory_);
    ++count;
    last_residual_ = radius.residual;
    unit_multiplicity = radius.unit_multiplicity;
    return {1 - radius.subdominant_max, 1 - radius.subdominant_min, radius.converged};
  }

  // The same at a point that is reported, whose residual counts. (A search also looks at flexibilities so
  // small that X_eta is numerically singular. Residuals do not matter there.)
  Ends reported(double eta) {
    const Ends ends = at(eta);
    residual = std::max(residual, last_residual_);
    all_converged = all_converged && ends.converged;
    return ends;
  }

  Index count = 0, unit_multiplicity = 0;
  double residual = 0;
  bool all_converged = true;

 private:
  InterfaceFamily family_;
  InterfaceOperator system_;
  SpectralOptions options_;
  Continuation memory_;
  double last_residual_ = 0;
};

// The eta in [low, high] where a decreasing function of log eta vanishes; 0 if it is negative throughout.
template <class Function>
double decreasing_root(double low, double high, Function&& f, double tolerance = root_tolerance) {
  const auto of_log = [&](double x) { return f(std::exp(x)); };
  double upper = std::log(high);
  // Decade by decade from above: the ends grow like 1/eta below their root, so the bracket should be narrow.
  while (true) {
    const double lower = std::max(upper - std::log(10.0), std::log(low));
    if (of_log(lower) >= 0) return std::exp(find_root(of_log, lower, upper, tolerance).x);
    if (lower <= std::log(low)) return 0;
    upper = lower;
  }
}

void find_relaxed(Optimum& best, Spectra& spectra, double low, double high) {
  const int samples = 4 * static_cast<int>(2 * decades) + 1;
  const auto radius = [&](double x) {
    const Ends ends = spectra.at(std::exp(x));
    return ends.converged ? ends.relaxed_radius() : 1.0;  // relaxed radii are below 1 where they are known
  };
  const auto point = [&](int i) { return std::log(low) + (std::log(high) - std::log(low)) * i / (samples - 1); };
  std::vector<double> values;
  for (int i = 0; i < samples; ++i) values.push_back(radius(point(i)));
  // If the curve is flat at the low end but for rounding, its infimum is there.
  const auto least = std::min_element(values.begin(), values.end());
  const auto lowest = static_cast<int>(least - values.begin());
  const bool falls_to_zero = lowest == 0 || values.front() <= *least * (1 + 1e-6);
  double x = point(lowest);
  if (!falls_to_zero && best.generic_relaxed_radius <= *least * (1 + 1e-6)) {  // nor does it pay to enrich
    best.relaxed_status = OptimumStatus::eta_to_infinity;
    best.relaxed_eta = infinity;
    best.relaxed_radius = best.generic_relaxed_radius;
    best.relaxation = best.generic_relaxation;
    return;
  }
  best.relaxed_status = OptimumStatus::interior;
  if (falls_to_zero) {
    best.relaxed_status = OptimumStatus::eta_to_zero;
    x = point(0);
  } else if (lowest + 1 < samples && values[at(lowest - 1)] > *least && values[at(lowest + 1)] > *least) {
    x = find_minimum(radius, point(lowest - 1), x, point(lowest + 1), 1e-6).x;
  }
  const Ends ends = spectra.reported(std::exp(x));
  best.relaxed_eta = std::exp(x);
  best.relaxed_radius = ends.relaxed_radius();
  best.relaxation = ends.relaxation();
}

}  // namespace

Optimum optimum(const Decomposition& parts, const Decomposition& stage_one, double epsilon,
                const SpectralOptions& options) {
  Optimum best;
  if (parts.interface_size() == 0) {
    best.status = best.relaxed_status = OptimumStatus::no_interface;
    return best;
  }
  const InterfaceOperator system = InterfaceFamily(stage_one).at(epsilon);
  Spectra spectra(parts, system, options);
  const Ends generic = spectra.reported(infinity);
  best.generic_radius = generic.radius();
  best.generic_relaxed_radius = generic.relaxed_radius();
  best.generic_relaxation = generic.relaxation();
  const auto finish = [&](OptimumStatus status) {
    best.status = spectra.all_converged ? status : OptimumStatus::not_converged;
    if (status == OptimumStatus::already_exact) best.relaxed_status = status;
    best.unit_multiplicity = spectra.unit_multiplicity;
    best.residual = spectra.residual;
    best.spectra = spectra.count;
    return best;
  };
  if (!(best.generic_radius > 1e-14)) return finish(OptimumStatus::already_exact);

  const double scale = system.scale().mean();
  double low = scale * std::pow(10, -decades), high = scale * std::pow(10, decades);
  if (epsilon > 0) {  // the root of the linear case is eta = epsilon: the range must reach it
    low = std::min(low, epsilon / 100);
    high = std::max(high, epsilon * 100);
  }
  const double eta = decreasing_root(low, high, [&](double e) {
    const Ends ends = spectra.at(e);
    return ends.min + ends.max - 2;
  });
  best.eta = eta > 0 ? eta : low;
  best.radius = spectra.reported(best.eta).radius();
  best.convergent_from = decreasing_root(low, high, [&](double e) { return spectra.at(e).max - 2; });
  best.better_from = decreasing_root(low, high, [&](double e) { return spectra.at(e).max - 1 - best.generic_radius; });
  for (const double threshold : {best.convergent_from, best.better_from})
    if (threshold > 0) spectra.reported(threshold);
  find_relaxed(best, spectra, low, high);
  return finish(eta > 0 ? OptimumStatus::interior : OptimumStatus::eta_to_zero);
}

double stable_eta(const Decomposition& parts, double relaxation) {
  const InterfaceFamily family(parts);
  Spectra spectra(parts, family.at(infinity), {});
  const double scale = family.at(infinity).scale().mean();
  // max - 2/omega falls from large values at eta = 0 to 1 - 2/omega.
  return decreasing_root(
      scale * std::pow(10.0, -decades), scale * std::pow(10.0, decades),
      [&](double eta) { return relaxation * spectra.at(eta).max - 2; }, 1e-3);
}

double optimal_eta(const Decomposition& parts, const Decomposition& active) {
  const InterfaceOperator system = InterfaceFamily(active).at(0.0);
  Spectra spectra(parts, system, {});
  const double scale = system.scale().mean();
  const double low = scale * std::pow(10.0, -decades), high = scale * std::pow(10.0, decades);
  const auto imbalance = [&](double eta) {
    const Ends ends = spectra.at(eta);
    return ends.min + ends.max - 2;
  };
  if (imbalance(high) >= 0) return high;
  const double root = decreasing_root(low, high, imbalance, 1e-3);
  if (root > 0) return root;
  // With an exact Stage 1 the radius falls all the way down. Nine tenths of the gain are enough.
  const double generic = spectra.at(high).radius(), best = spectra.at(low).radius();
  double eta = high;
  while (eta > low && spectra.at(eta).radius() > best + 0.1 * (generic - best)) eta /= std::sqrt(10.0);
  return std::max(eta, low);
}

}  // namespace nscdd
