// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/report/problem_report.hpp"

#include "core/fail.hpp"
#include "study/linear/inspection.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

Packing drawn_bodies(const Model& model, const ProblemReport& report) {
  const Index dimension = report.points.rows();
  Matrix places = Matrix::Zero(3, model.grains());
  Vector touched = Vector::Zero(model.grains()), nearest = Vector::Constant(model.grains(), infinity);
  const auto for_each_end = [&](auto&& act) {
    for (Index c = 0; c < model.contacts(); ++c)
      for (const Index body : {report.a[at(c)], report.b[at(c)]})
        if (body >= 0) act(body, report.points.col(c));
  };
  for_each_end([&](Index body, const auto& point) {
    places.col(body).head(dimension) += point;
    ++touched[body];
  });
  places.array().rowwise() /= touched.transpose().array().max(1);
  for (Index i = 0; i < touched.size(); ++i)  // not drawn, but within the picture
    if (touched[i] == 0) places.col(i).head(dimension) = report.points.rowwise().mean();
  for_each_end([&](Index body, const auto& point) {
    nearest[body] = std::min(nearest[body], (places.col(body).head(dimension) - point).norm());
  });
  // A body with a single contact is at its point and has no size: it gets the mean of the others.
  double sum = 0, sized = 0;
  for (Index i = 0; i < nearest.size(); ++i)
    if (touched[i] > 1) std::tie(sum, sized) = std::pair(sum + nearest[i], sized + 1);
  const Vector extent = report.points.rowwise().maxCoeff() - report.points.rowwise().minCoeff();
  const double usual = sum > 0 ? sum / sized : std::max(extent.norm(), 1.0) / 50;
  Packing bodies;
  for (Index i = 0; i < nearest.size(); ++i) {
    bodies.x.push_back(places(0, i));
    bodies.y.push_back(places(1, i));
    if (dimension == 3) bodies.z.push_back(places(2, i));
    bodies.radius.push_back(touched[i] == 0 ? 0 : (touched[i] > 1 && nearest[i] > 0 ? nearest[i] : usual) / 2);
  }
  return bodies;
}

}  // namespace

ProblemReport report_problem(const Model& model, const FclibFile& file, const std::string& name) {
  const LocalFrictionProblem local = reduce(std::get<GlobalFrictionProblem>(file.problem), name);
  if (local.contacts() != model.contacts())
    fail("{}: expected the {} contacts of the model, met {}", name, model.contacts(), local.contacts());
  ProblemReport report;
  report.title = file.info.title.value_or("");
  report.entries = local.w.nonZeros();
  problem_contacts(model, [&](const ProblemContact& c) {
    report.a.push_back(c.body_a);
    report.b.push_back(c.body_b);
  });
  report.points = file.points;
  if (local.contacts() == 0) return report;
  const Vector diagonal = local.w.diagonal();
  const auto normals = [&](const Vector& v) { return v(Eigen::seqN(0, local.contacts(), local.dimension)); };
  report.friction = {local.friction.minCoeff(), local.friction.maxCoeff()};
  report.normal_delassus = {normals(diagonal).minCoeff(), normals(diagonal).maxCoeff()};
  const auto add = [&](const std::string& what, const FclibSolution& found) {
    if (report.impulses.empty()) report.normal_impulses = normals(found.r);
    report.impulses.emplace_back(what, friction_state(local, found.r));
    report.impulses.back().second.velocities = {};
  };
  if (file.solution) add("solution", *file.solution);
  for (std::size_t k = 0; k < file.guesses.size(); ++k) add(fmt::format("guess {}", k + 1), file.guesses[k]);
  if (report.points.size() > 0) report.bodies = drawn_bodies(model, report);
  return report;
}

}  // namespace nscdd
