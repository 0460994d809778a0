// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/pencil_side.hpp"

namespace nscdd {
namespace {

constexpr double list_distance = 1e-3;  // from the shift of a list to its first value, relative to that value

class EndList {
 public:
  EndList(PencilSide& side, PencilEnd& result) : side_(side), result_(result) {}

  // Lanczos alone may see only one copy of a multiple eigenvalue. So eigenvalues are looked for until an
  // inertia count beyond the last one wanted equals the length of the list. False if it cannot be reached.
  bool extend(const ShiftedPencil& pencil) {
    const Index wanted = std::min(side_.options.eigenvalues, side_.size() - side_.point.kernel);
    while (result_.values.size() < wanted)
      if (!add(pencil, wanted - result_.values.size())) return false;
    const double last = result_.values[wanted - 1];
    const std::optional<ShiftedPencil> outside = side_.factorise(last - side_.inward(side_.margin(last)));
    if (!outside) return false;
    const auto missing = [&, counted = side_.beyond(*outside)] {
      return counted - std::count_if(result_.values.begin(), result_.values.end(),
                                     [&](double lambda) { return side_.inward(lambda - outside->shift()) < 0; });
    };
    while (missing() > 0)
      if (!add(pencil, missing())) return false;
    if (missing() < 0) return false;
    result_.values.conservativeResize(wanted);
    result_.vectors.conservativeResize(Eigen::NoChange, wanted);
    return true;
  }

 private:
  // Looks for more eigenvalues, orthogonal to those of the list; false if none is found.
  bool add(const ShiftedPencil& pencil, Index wanted) {
    const ShiftInvertOptions options{.maximum_steps = side_.options.list_steps,
                                     .tolerance = 0.1 * side_.options.tolerance};
    const Matrix locked = result_.vectors;
    const ShiftInvertResult run = side_.lanczos(pencil, side_.end, wanted, options, {}, locked);
    const Index before = locked.cols();
    for (Index k = 0; k < run.values.size(); ++k) {
      const double error = run.bounds[k] + pencil.solution_error() * std::abs(run.values[k] - pencil.shift());
      if (error > side_.tolerance(run.values[k])) continue;
      if (is_of_kernel(run.values[k], error)) continue;
      Index place = result_.values.size();
      while (place > 0 && side_.inward(result_.values[place - 1] - run.values[k]) > 0) --place;
      insert(place, run.values[k], run.vectors.col(k));
      result_.residual = std::max(result_.residual, error);
    }
    return result_.values.size() > before;
  }

  // A long list from the largest eigenvalues inwards may reach the zeros of the rigid limit, which are left
  // out.
  bool is_of_kernel(double lambda, double error) const {
    return side_.point.kernel > 0 && lambda <= 10 * (error + side_.rounding(lambda));
  }

  void insert(Index place, double lambda, const Vector& vector) {
    const Index size = result_.values.size(), behind = size - place;
    Vector values(size + 1);
    values << result_.values.head(place), lambda, result_.values.tail(behind);
    Matrix vectors(vector.size(), size + 1);
    vectors << result_.vectors.leftCols(place), vector, result_.vectors.rightCols(behind);
    result_.values = values;
    result_.vectors = vectors;
  }

  PencilSide& side_;
  PencilEnd& result_;
};

}  // namespace

void list_behind(PencilSide& side, PencilEnd& result) {
  side.accuracy = SolutionAccuracy::refined;
  const double first = result.values[0];
  const std::optional<ShiftedPencil> pencil = side.factorise(first - side.inward(list_distance * first));
  result.converged =
      pencil && EndList(side, result).extend(*pencil) && result.residual <= side.tolerance(result.values[0]);
}

}  // namespace nscdd
