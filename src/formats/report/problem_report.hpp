// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/formats/fclib.hpp>
#include <nscdd/study/model.hpp>

namespace nscdd {

/// What the page of a contact problem shows in addition to its linear study.
struct ProblemReport {
  std::string title;                        ///< of the file; may be empty
  std::array<double, 2> friction{};         ///< least and largest coefficient
  std::array<double, 2> normal_delassus{};  ///< least and largest W_nn, 1/kg
  Index entries = 0;                        ///< stored in W
  /// Impulses of the file, "solution" and "guess 1", ..., without velocities.
  std::vector<std::pair<std::string, FrictionState>> impulses;
  Vector normal_impulses;   ///< of the first of them, N s; empty without one
  std::vector<Index> a, b;  ///< bodies of every contact; b is -1 for a support
  Matrix points;            ///< of the contacts, D x contacts, m; empty where the file has none
  /// Bodies as they are drawn: each at the mean of the points of its contacts, with half the distance to the nearest of
  /// them as its radius. Bodies without contacts have the radius 0. Empty without points.
  Packing bodies;
};

/// `file`: the global problem of the model. Throws Error with `name` for another number of contacts, and as `reduce`.
ProblemReport report_problem(const Model& model, const FclibFile& file, const std::string& name);

}  // namespace nscdd
