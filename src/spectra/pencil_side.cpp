// SPDX-License-Identifier: GPL-3.0-or-later
#include "spectra/pencil_end.hpp"

namespace nscdd {

std::optional<ShiftedPencil> PencilSide::factorise(double shift, double side) {
  // First within the tolerance of the end, then far from the usual cause, an eigenvalue of a part of the packing.
  for (const double step : {0.2, 0.5, 3.0, 30.0, 300.0}) {
    ++result.factorisations;
    ShiftedPencil pencil = family.at(point.epsilon, point.eta, shift, accuracy);
    if (pencil.reliable()) return pencil;
    shift = std::max(shift + side * inward(step * tolerance(shift)), 0.5 * shift);
  }
  return std::nullopt;
}

ShiftedPencil::Response PencilSide::respond(const ShiftedPencil& pencil, const Vector& x, const Vector& px) {
  ++result.solves;
  ShiftedPencil::Response response = pencil.respond(px);
  if (pencil.offset() == 0) return response;
  const double before = response.f.squaredNorm();
  response.f += pencil.offset() * x;
  response.system *= response.f.squaredNorm() / before;  // x is nearly the eigenvector
  return response;
}

ShiftInvertResult PencilSide::lanczos(const ShiftedPencil& pencil, SpectrumEnd towards, Index wanted,
                                      const ShiftInvertOptions& lanczos_options, const Vector& start,
                                      const Matrix& locked) {
  const LinearMap product = [this](const Vector& x) -> Vector { return apply(x); };
  const LinearMap solve = [&](const Vector& x) -> Vector { return ++result.solves, pencil.solve(x); };
  return shift_invert_lanczos({p.rows(), solve, product, pencil.shift(), pencil.offset()}, towards, wanted,
                              lanczos_options, start, locked);
}

void PencilSide::list_behind() {
  accuracy = SolutionAccuracy::refined;
  const std::optional<ShiftedPencil> pencil = factorise(just_outside(result.values[0]));
  result.converged =
      pencil && (polish(*pencil), extend_list(*pencil)) && result.residual <= tolerance(result.values[0]);
}

// Inverse iteration: components of other vectors in a locked one disturb values, the more the nearer to the shift.
void PencilSide::polish(const ShiftedPencil& pencil) {
  Vector x = result.vectors.col(0);
  for (int k = 0; k < 2; ++k) {
    x = inverse(pencil, x);
    x /= std::sqrt(x.dot(apply(x)));
  }
  if (x.allFinite()) result.vectors.col(0) = x;
}

// Lanczos may find one copy of a multiple eigenvalue: searches until an inertia count equals the length of the list.
bool PencilSide::extend_list(const ShiftedPencil& pencil) {
  const Index wanted = std::min(options.eigenvalues, p.rows() - point.kernel);
  std::optional<ShiftedPencil> nearer;  // behind a gap too wide for the first shift
  while (result.values.size() < wanted) {
    const Added added = add_to_list(nearer ? *nearer : pencil, wanted - result.values.size());
    if (added.any) continue;
    const double last_shift = nearer ? nearer->shift() : pencil.shift();
    // A shift that moves by rounding alone finds what the last one found.
    const auto nears = [&](double shift) { return inward(shift - last_shift) > 1e-6 * std::abs(last_shift); };
    if (!added.seen || !nears(just_outside(*added.seen))) return false;
    nearer = factorise(just_outside(*added.seen));
    if (!nearer || !nears(nearer->shift())) return false;
  }
  const double last = result.values[wanted - 1];
  const std::optional<ShiftedPencil> outside = factorise(last - inward(margin(last)));
  if (!outside) return false;
  const auto missing = [&, counted = beyond(*outside)] {
    return counted - std::count_if(result.values.begin(), result.values.end(),
                                   [&](double lambda) { return inward(lambda - outside->shift()) < 0; });
  };
  // Missing copies are of the last values, or before a gap: search from the shifts used, then next to the last.
  bool next_to_last = false;
  while (missing() > 0) {
    if (add_to_list(nearer ? *nearer : pencil, missing()).any || (nearer && add_to_list(pencil, missing()).any))
      continue;
    if (next_to_last) return false;
    next_to_last = true;
    nearer = factorise(just_outside(last));
    if (!nearer) return false;
  }
  if (missing() < 0) return false;
  result.values.conservativeResize(wanted);
  result.vectors.conservativeResize(Eigen::NoChange, wanted);
  return true;
}

// Second-order error of an eigenvalue due to inexact locked vectors. The image of its vector under (S - sigma P)^-1 P
// has parts c_j along them; with nu = 1 / (lambda - sigma) the error is sum_j c_j^2 / |nu - nu_j|, over nu^2.
double PencilSide::disturbance(const ShiftedPencil& pencil, const Vector& x, double lambda, const Matrix& locked,
                               const Vector& known) {
  const Vector image = apply(inverse(pencil, x)), along = (locked.transpose() * image).cwiseAbs();
  const double nu = 1 / (lambda - pencil.shift());
  double sum = 0;
  for (Index j = 0; j < along.size(); ++j)
    if (along[j] > 0) sum += along[j] * along[j] / std::max(along[j], std::abs(nu - 1 / (known[j] - pencil.shift())));
  return sum / (nu * nu);
}

// Searches for more eigenvalues, orthogonal to those of the list.
PencilSide::Added PencilSide::add_to_list(const ShiftedPencil& pencil, Index wanted) {
  constexpr Index list_steps = 300;  // of Lanczos
  const Matrix locked = result.vectors;
  const Vector known = result.values;
  const ShiftInvertResult run =
      lanczos(pencil, end, wanted, {.maximum_steps = list_steps, .tolerance = 0.1 * options.tolerance}, {}, locked);
  // Rounding grows with the distance from the shift, relative to that of the nearest eigenvalue.
  double nearest = run.values.size() > 0 ? std::abs(run.values[0] - pencil.shift()) : 0;
  for (const double value : known) nearest = std::min(nearest, std::abs(value - pencil.shift()));
  for (Index k = 0; k < run.values.size(); ++k) {
    const double lambda = run.values[k];
    const double error = run.bounds[k] + pencil.solution_error() * std::abs(lambda - pencil.shift()) +
                         disturbance(pencil, run.vectors.col(k), lambda, locked, known) +
                         rounding(lambda) * std::max(1.0, std::abs(lambda - pencil.shift()) / nearest);
    if (error > tolerance(lambda)) continue;
    // A long list from the largest eigenvalues inwards may reach the zeros of the rigid limit.
    if (point.kernel > 0 && lambda <= 10 * (error + rounding(lambda))) continue;
    // With schwarz a list ends at mu = 0, the kernel of the inner product.
    if (point.without != nullptr && inward(1 - lambda) <= 1e-6 * std::abs(1 - known[0])) continue;
    Index place = result.values.size();
    while (place > 0 && inward(result.values[place - 1] - lambda) > 0) --place;
    const Index size = result.values.size(), behind = size - place;
    Vector values(size + 1);
    values << result.values.head(place), lambda, result.values.tail(behind);
    Matrix vectors(run.vectors.rows(), size + 1);
    vectors << result.vectors.leftCols(place), run.vectors.col(k), result.vectors.rightCols(behind);
    result.values = values;
    result.vectors = vectors;
    result.residual = std::max(result.residual, error);
  }
  Added added{result.values.size() > locked.cols(), std::nullopt};
  if (run.values.size() > 0) added.seen = run.values[0];
  return added;
}

}  // namespace nscdd
