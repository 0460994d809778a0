// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a packing: modes that a sweep leaves, places where they are kept, interruption.
#include "study/linear/packing_report.hpp"

#include "../support/problems.hpp"
#include "../support/sanitized.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("packing report: a mode is that of nscdd modes, at its own point and relative to the fastest copy") {
  std::array<Index, 4> compared{};
  for (const Case& one : watched(every_problem())) {
    const Model model = build(one);
    if (model.parts.interface_size() == 0 || !model.has_geometry()) continue;
    CAPTURE(one.spec.name);
    PackingReportParameters parameters;
    parameters.sweep.epsilon = sanitized ? std::vector{0.0, 0.2} : std::vector{0.0, 0.2, 3.0};
    parameters.sweep.eta = {0.3, infinity};
    parameters.contact_sets = contact_sets_of(model);
    const auto report = report_packing(model, parameters);
    REQUIRE(report);
    REQUIRE(report->grids.size() == parameters.contact_sets.size());
    for (const RadiusGrid& grid : report->grids)
      for (const KeptMode& kept : grid.modes) {
        INFO("epsilon = ", kept.epsilon, ", eta = ", kept.eta);
        ModeParameters at_point;
        at_point.epsilon = parameters.sweep.epsilon[at(kept.epsilon)];
        at_point.eta = parameters.sweep.eta[at(kept.eta)];
        at_point.contacts = grid.contacts;
        const Mode mode = interface_mode(model, at_point);
        CHECK(kept.eigenvalue == doctest::Approx(mode.eigenvalue).epsilon(1e-9));
        CHECK(kept.side == mode.side);
        if (std::abs(mode.next - mode.eigenvalue) < 1e-3) continue;  // one vector of several
        std::vector<std::array<double, 3>> velocities;
        double fastest = 0;
        mode_velocities(model, mode, [&](const ModeVelocity& copy) {
          velocities.push_back(copy.velocity);
          fastest = std::max(fastest, std::hypot(copy.velocity[0], copy.velocity[1], copy.velocity[2]));
        });
        const auto d = static_cast<std::size_t>(model.packing.dimension());
        REQUIRE(kept.velocities.size() == d * velocities.size());
        double worst = 0;
        for (std::size_t k = 0; k < kept.velocities.size(); ++k)
          worst = std::max(worst, std::abs(velocities[k / d][k % d] / fastest - kept.velocities[k]));
        CHECK(worst < 1e-4);
        ++compared[d];
      }
  }
  for (const std::size_t d : {2U, 3U}) CHECK(compared[d] > (sanitized ? 3 : 20));
}

TEST_CASE("packing report: modes are kept at places evenly spread, with both ends, and never more than there is room") {
  for (const Index rows : {1, 2, 8})
    for (const Index columns : {1, 5, 26})
      for (const Index most : {0, 1, 3, 17, 100, 1000}) {
        const ModePlaces places = mode_places(rows, columns, most);
        INFO("rows = ", rows, ", columns = ", columns, ", most = ", most);
        CHECK(count(places.rows) * count(places.columns) <= std::max<Index>(most, 1));
        CHECK(places.rows.front() == 0);
        CHECK(places.columns.back() == columns - 1);
        CHECK(std::ranges::is_sorted(places.rows));
        if (most >= rows * columns) CHECK(count(places.rows) * count(places.columns) == rows * columns);
        CHECK(places.hold(places.rows.back(), places.columns.front()));
        CHECK(!places.hold(rows, 0));
      }
}

TEST_CASE("packing report: little room keeps fewer modes and all radii") {
  const Model model = build(every_problem().front());
  PackingReportParameters parameters;
  parameters.sweep.epsilon = {0.1, 1, 10};
  parameters.sweep.eta = {1, 2, 4, infinity};
  parameters.contact_sets = {ContactSet::all};
  parameters.mode_velocities = 1;
  const auto report = report_packing(model, parameters);
  REQUIRE(report);
  CHECK(report->grids.front().modes_asked == 1);
  CHECK(report->grids.front().modes.size() <= 1);
  CHECK(report->grids.front().points.size() == 12);
  CHECK(report->grids.front().best.size() == 3);
}

TEST_CASE("packing report: a monitor that stops at any unit gets no report") {
  const Model model = build(every_problem().front());
  PackingReportParameters parameters;
  parameters.sweep.epsilon = {0, 1};
  parameters.sweep.eta = {1, infinity};
  parameters.contact_sets = {ContactSet::all};
  Index units = 0;
  REQUIRE(report_packing(model, parameters, [&](Index, Index total) {
    units = total;
    return true;
  }));
  CHECK(units == 4 + 2);
  for (Index stop = 1; stop <= units; ++stop)
    CHECK(!report_packing(model, parameters, [&](Index done, Index) { return done < stop; }));
}
