// SPDX-License-Identifier: GPL-3.0-or-later
#include "spectra/radius_curve.hpp"

#include "spectra/spectrum_memory.hpp"

namespace nscdd {
namespace {

enum Side { low = 0, high = 1 };

// The concave function F of one end over its coordinate u, with F and u as functions of lambda and x.
struct Concave {
  const CurveLaw& law;
  Side side;

  double stiffest() const { return law.stiffest > 0 ? law.stiffest : 1; }  // any bound will do
  bool saturates() const { return law.schwarz || (law.axis == CurveAxis::epsilon) == (side == low); }
  double u(double x) const { return saturates() ? x / (x + stiffest()) : 1 / x; }
  double du(double x) const {  // d u / d log x
    return saturates() ? x * stiffest() / ((x + stiffest()) * (x + stiffest())) : -1 / x;
  }
  double f(double lambda) const { return side == low ? lambda : 1 / lambda; }
  double df(double lambda) const { return side == low ? 1 : -1 / (lambda * lambda); }

  double least(const CurveEnd& end) const {
    return side == low ? std::max(0.0, end.lambda - end.error) : f(end.lambda + end.error);
  }
  double most(const CurveEnd& end) const {
    if (side == low) return end.lambda + end.error;
    return end.lambda > end.error ? f(end.lambda - end.error) : infinity;
  }

  // F = value + slope (u - u(x0)) as a function of x.
  Moebius line(double x0, double value, double slope) const {
    const double constant = value - slope * u(x0);
    if (saturates()) return {constant + slope, constant * stiffest(), 1, stiffest()};
    return {constant, slope, 1, 0};
  }

  // The bound of rho that follows from a bound of F.
  Moebius part(const Moebius& bound) const {
    return side == low ? one_minus(law.relaxation, bound) : over_minus_one(law.relaxation, bound);
  }

  Moebius chord(const CurvePoint& from, const CurvePoint& to) const {
    const double first = least((*from.ends)[side]), last = least((*to.ends)[side]), step = u(to.x) - u(from.x);
    if (step == 0) return part(line(from.x, std::min(first, last), 0));  // F is monotone
    return part(line(from.x, first, (last - first) / step));
  }

  // The tangent at one point, with its slope on the safe side towards the other point.
  std::optional<Moebius> tangent(const CurvePoint& at, const CurvePoint& other) const {
    const CurveEnd& end = (*at.ends)[side];
    const double value = most(end), towards = u(other.x) > u(at.x) ? 1 : -1;
    if (!std::isfinite(end.slope) || !std::isfinite(end.slope_error) || !std::isfinite(value)) return std::nullopt;
    const double factor = df(end.lambda) / du(at.x);
    return part(line(at.x, value, end.slope * factor + towards * end.slope_error * std::abs(factor)));
  }
};

// rho lies below the larger of the upper bounds and above each of the lower ones.
struct Bounds {
  std::vector<Moebius> upper, lower{{0, 0, 0, 1}};
};

Bounds bounds_between(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to) {
  Bounds bounds;
  if (law.schwarz) bounds.lower.push_back({0, std::abs(1 - law.relaxation), 0, 1});  // lambda_low <= 1 <= lambda_high
  for (const Side side : {low, high}) {
    const Concave concave{law, side};
    bounds.upper.push_back(concave.chord(from, to));
    for (const auto& tangent : {concave.tangent(from, to), concave.tangent(to, from)})
      if (tangent) bounds.lower.push_back(*tangent);
  }
  return bounds;
}

double largest(const std::vector<Moebius>& functions, double x) {
  double value = -infinity;
  for (const Moebius& m : functions) value = std::max(value, m(x));
  return value;
}

// The straight line over log x between two points.
struct Line {
  double x, radius, slope;

  Line(const CurvePoint& from, const CurvePoint& to)
      : x(from.x), radius(from.radius), slope((to.radius - from.radius) / std::log(to.x / from.x)) {}
  double operator()(double at) const { return radius + slope * std::log(at / x); }
};

struct Extreme {
  double value = -infinity, x = 1;

  void include(double other, double at) {
    if (std::isnan(other)) other = infinity;  // no bound
    if (other > value) *this = {other, at};
  }
};

// Includes the maximum of sign (m - line) over [from, to].
void include_maximum(Extreme& extreme, const Moebius& m, const Line& line, double sign, double from, double to) {
  std::vector<double> places = stationary_places(m, line.slope);
  std::erase_if(places, [&](double x) { return x <= from || x >= to; });
  places.insert(places.end(), {from, to});
  for (const double x : places) extreme.include(sign * (m(x) - line(x)), x);
}

// Between two crossings one lower bound is the best. If rounding moves a crossing, the bound still holds.
Extreme below_line(const std::vector<Moebius>& lower, const Line& line, double from, double to) {
  std::vector<double> cuts{from, to};
  for (std::size_t i = 0; i < lower.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (const double x : crossings(lower[i], lower[j]))
        if (x > from && x < to) cuts.push_back(x);
  std::ranges::sort(cuts);
  Extreme extreme;
  for (std::size_t k = 1; k < cuts.size(); ++k) {
    const double middle = std::sqrt(cuts[k - 1] * cuts[k]);
    const auto best = std::ranges::max_element(lower, {}, [&](const Moebius& m) { return m(middle); });
    include_maximum(extreme, *best, line, -1, cuts[k - 1], cuts[k]);
  }
  return extreme;
}

CurveEnd end_of(const Contraction& b, double mu, const std::array<double, 2>& interval, const SpectralRadius& plain) {
  const double lambda = 1 - mu, rounding = static_cast<double>(b.rows()) * 2.3e-16 + lost_to_rounding(b);
  const double error =
      plain.certified ? std::max(std::abs(mu - interval[0]), std::abs(interval[1] - mu)) : plain.residual;
  return {.lambda = lambda, .error = error + rounding * std::max(1.0, lambda)};
}

// The slope of the Rayleigh quotient of the mode f. With the residual r = |S f - lambda P f|_{P^-1} / |f|_P it is exact
// up to r^2 / lambda^2 of itself, except for the low end along eta. There the quotient is that of S f for P^-1, whose
// slope differs by at most 2 r + r^2 / lambda, because d P / d log eta <= P.
void set_slope(CurveEnd& end, const Contraction& b, const Vector& mode, CurveAxis axis) {
  if (mode.size() == 0) return;
  const Vector pf = b.preconditioner.apply(mode), residual = b.system.apply(mode) - end.lambda * pf;
  const double norm = mode.dot(pf), lambda = end.lambda;
  const double r = std::sqrt(inverse_at_most(b.preconditioner, residual) / norm);
  const double slope =
      axis == CurveAxis::epsilon ? b.system.slope(mode) / norm : -lambda * b.preconditioner.slope(mode) / norm;
  end.slope = slope;
  end.slope_error = (1e-12 + 2 * r * r / (lambda * lambda)) * std::abs(slope) + 2 * r + r * r / lambda + 10 * end.error;
}

// The impulses v = H_E^T (M_E + K_E / epsilon)^-1 N_E^T g of all contacts under the sums g of the other resultants have
// the quotient (w + epsilon) / (d + epsilon) for every epsilon. It is computed on the interface, without v:
// |v|^2 = epsilon slope(g), and (d + epsilon) |v|^2 = epsilon^2 g^T Y g with Y = M_b^-1 - F.
void set_slope_of_schwarz(CurveEnd& end, const Contraction& b, const Vector& mode) {
  if (mode.size() == 0) return;
  const Interface& copies = b.system.decomposition().interface;
  const Vector g = sum_of_others(copies, mode), free = b.preconditioner.apply(g), y = free - b.system.apply(g);
  const Vector p = b.preconditioner.solve(y);
  const double energy = g.dot(y), change = sum_of_others(copies, p).dot(y) / energy;  // quotient - 1
  const double rounding = static_cast<double>(g.size()) * 2.3e-16 + lost_to_rounding(b);
  const double lost = rounding * g.dot(free) / energy;  // of the energy
  if (!(energy > 0 && lost < 0.1)) return;
  const auto others = static_cast<double>(largest_multiplicity(copies) - 1);  // norm of 1 1^T - I
  const double off = 2 * rounding * others * std::sqrt(p.dot(y) * g.dot(free)) / energy + lost * std::abs(change);
  end.error = std::max(end.error, std::abs(1 + change - end.lambda) + off);
  end.slope = -change * b.system.slope(g) / energy;
  end.slope_error = (1e-12 + 2 * lost) * std::abs(end.slope) + 10 * end.error;
}

}  // namespace

CurvePoint curve_point(const Contraction& b, const SpectralRadius& plain, CurveAxis axis) {
  CurvePoint point{.x = axis == CurveAxis::epsilon ? b.system.flexibility() : b.preconditioner.flexibility(),
                   .radius = plain.subdominant};
  if (std::isnan(plain.subdominant_min)) return point;
  std::array<CurveEnd, 2> ends{end_of(b, plain.subdominant_max, plain.interval_max, plain),
                               end_of(b, plain.subdominant_min, plain.interval_min, plain)};
  for (const auto& [side, mode] : {std::pair(low, &plain.mode_max), std::pair(high, &plain.mode_min)}) {
    if (b.schwarz())
      set_slope_of_schwarz(ends[side], b, *mode);
    else
      set_slope(ends[side], b, *mode, axis);
  }
  point.ends = ends;
  return point;
}

double inverse_at_most(const InterfaceOperator& x, const Vector& g) {
  return generic_at_most(x) * std::max(0.0, g.dot(x.solve_generic(g)));
}

double uncertainty(const CurveLaw& law, const CurvePoint& point) {
  if (!point.ends) return 0;
  const auto radius = [&](double sign) {
    const auto& [smallest, largest] = *point.ends;
    return std::max(1 - law.relaxation * (smallest.lambda - sign * smallest.error),
                    law.relaxation * (largest.lambda + sign * largest.error) - 1);
  };
  return radius(1) - std::max(0.0, radius(-1));
}

Deviation deviation(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to) {
  if (!from.ends || !to.ends) return {};
  const Bounds bounds = bounds_between(law, from, to);
  const Line line(from, to);
  Extreme above;
  for (const Moebius& m : bounds.upper) include_maximum(above, m, line, 1, from.x, to.x);
  const Extreme below = below_line(bounds.lower, line, from.x, to.x);
  const double rounding = 1e-14 * std::max({1.0, from.radius, to.radius});  // of the bounds themselves
  const double x = above.value > below.value ? above.x : below.x;
  return {.below = std::max(0.0, below.value) + rounding,
          .above = std::max(0.0, above.value) + rounding,
          .place = std::log(x / from.x) / std::log(to.x / from.x)};
}

std::array<double, 2> radius_bounds(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to, double x) {
  if (!from.ends || !to.ends) return {std::min(from.radius, to.radius), std::max(from.radius, to.radius)};
  const Bounds bounds = bounds_between(law, from, to);
  return {largest(bounds.lower, x), largest(bounds.upper, x)};
}

}  // namespace nscdd
