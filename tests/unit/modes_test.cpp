// SPDX-License-Identifier: GPL-3.0-or-later
// Modes: the identities that tie impulses, velocities and jumps, normalisation, agreement of solvers.
#include "study/linear/modes.hpp"

#include "../support/problems.hpp"
#include "../support/sanitized.hpp"
#include "two_stage/two_stage.hpp"
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <map>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Contraction operators(const Model& model, const ModeParameters& p) {
  const Selection selection = select(model, p.contacts);
  return {InterfaceFamily(model.parts).at(p.eta), InterfaceFamily(selection.stage_one(model)).at(p.epsilon)};
}

double norm(const Vector& f, const InterfaceOperator& p) { return std::sqrt(f.dot(p.apply(f))); }

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

std::vector<Row> velocity_rows(const Model& model, const Mode& mode) {
  std::vector<Row> rows;
  const RowSink collect = [&](const Row& cells) { rows.push_back(cells); };
  mode_velocities(model, mode, as_rows(mode_velocity_columns(model.problem.dimension), collect));
  return rows;
}

std::vector<Row> impulse_rows(const Model& model, const ModeParameters& parameters, const Mode& mode) {
  std::vector<Row> rows;
  const RowSink collect = [&](const Row& cells) { rows.push_back(cells); };
  mode_impulses(model, parameters, mode, as_rows(mode_impulse_columns(model.problem.dimension), collect));
  return rows;
}

double number(const Row& row, const std::vector<Column>& columns, const std::string& name) {
  const Cell& cell = row[Table{columns, {}}.column(name)];
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*integer);
  return std::get<double>(cell);
}

}  // namespace

TEST_CASE("mode: Stage 1 balance, jumps, eigen-equation, shares and norm on every problem") {
  for (const Case& one : watched(every_problem())) {
    const Model model = build(one);
    if (model.parts.interface_size() == 0) continue;
    for (const ContactSet contacts : {ContactSet::all, ContactSet::active})
      for (const double epsilon : sanitized ? std::vector{0.0, 1e-3} : std::vector{0.0, 1e-3, 1.0})
        for (const double eta : {0.3, infinity})
          for (const SpectrumSide side : {SpectrumSide::low, SpectrumSide::high}) {
            INFO("name = ", one.spec.name, ", contacts = ", to_string(contacts), ", epsilon = ", epsilon,
                 ", eta = ", eta, ", side = ", to_string(side));
            const ModeParameters parameters{epsilon, eta, contacts, side, {}};
            const Mode mode = interface_mode(model, parameters);
            REQUIRE(mode.found());
            CHECK(mode.converged);
            CHECK(mode.side == side);
            const Contraction b = operators(model, parameters);
            const double lambda = 1 - mode.eigenvalue;
            const double scale = std::max(1.0, std::abs(lambda));
            // sum_E A_E V_E = - S F = - lambda P F
            const Vector pf = b.preconditioner.apply(mode.impulses);
            CHECK((mode.jumps + b.system.apply(mode.impulses)).norm() < 1e-10 * scale * pf.norm());
            CHECK((mode.jumps + lambda * pf).norm() < 1e-7 * scale * pf.norm());
            CHECK((b.apply(mode.impulses) - mode.eigenvalue * mode.impulses).norm() <
                  1e-7 * scale * mode.impulses.norm());
            CHECK(norm(mode.impulses, b.preconditioner) == doctest::Approx(1).epsilon(1e-12));
            CHECK(mode.impulses.maxCoeff() >= (1 - 1e-6) * mode.impulses.cwiseAbs().maxCoeff());
            CHECK(sum(mode.shares) == doctest::Approx(1).epsilon(1e-10));
            CHECK(spread(mode) >= 1 - 1e-12);
            CHECK(spread(mode) <= static_cast<double>(model.parts.interface.gluing().size()) * (1 + 1e-12));
            if (epsilon == 0) continue;
            // M_E V_E + A_E^T F = H_E r_E with the law r_E = - H_E^T V_E / epsilon
            for (std::size_t e = 0; e < model.parts.subdomains.size(); ++e) {
              const Subdomain& subdomain = b.system.decomposition().subdomains[e];
              if (subdomain.inertia.size() == 0) continue;
              const Vector r = -(subdomain.h.transpose() * mode.velocities[e]) / epsilon;
              const Vector force = subdomain.a.transpose() * mode.impulses;
              CHECK((subdomain.inertia.cwiseProduct(mode.velocities[e]) + force - subdomain.h * r).norm() <
                    1e-9 * mode.impulses.norm());
            }
          }
  }
}

TEST_CASE("mode: in the rigid limit no contact moves, and kernel impulses stay out") {
  const Model model = build(random_lattice(1, 6, 5, {2, 2}));
  const Mode mode = interface_mode(model, {.epsilon = 0});
  REQUIRE(mode.found());
  CHECK(mode.spectrum.unit_multiplicity > 0);
  CHECK(mode.eigenvalue < 1 - 1e-6);
  CHECK(std::abs(mode.eigenvalue) == mode.spectrum.subdominant);
  for (std::size_t e = 0; e < model.parts.subdomains.size(); ++e) {
    const Subdomain& subdomain = model.parts.subdomains[e];
    CHECK((subdomain.h.transpose() * mode.velocities[e]).norm() < 1e-11);
  }
}

TEST_CASE("mode: the slowest end is the one of larger modulus") {
  const Model model = build(random_lattice(2, 8, 6, {3, 2}));
  const Mode slow = interface_mode(model, {.epsilon = 1e-3});
  CHECK(slow.side == SpectrumSide::high);
  CHECK(slow.eigenvalue == slow.spectrum.value);
  const Mode diverging = interface_mode(model, {.epsilon = 1.0, .eta = 1e-2});
  CHECK(diverging.side == SpectrumSide::low);
  CHECK(diverging.eigenvalue == -diverging.spectrum.value);
  CHECK(diverging.eigenvalue < -1);
  CHECK(diverging.next >= diverging.eigenvalue);
}

TEST_CASE("mode: the algorithm itself multiplies it by its eigenvalue") {
  const Model model = build(random_lattice(3, 5, 9, {2, 3}));
  for (const double eta : {0.3, infinity}) {
    const Mode mode = interface_mode(model, {.epsilon = 0.05, .eta = eta});
    const InterfaceOperator p = InterfaceFamily(model.parts).at(eta);
    const TwoStageIteration iteration(model.parts, LinearViscous{0.05}, p, std::nullopt);
    Vector state = Vector::Zero(iteration.rows());
    state.tail(mode.impulses.size()) = mode.impulses;
    const Vector next = iteration.iterate(state).tail(mode.impulses.size());
    CHECK((next - mode.eigenvalue * mode.impulses).norm() < 1e-9 * mode.impulses.norm());
  }
}

TEST_CASE("mode: dense, ARPACK and shift-invert agree where the end is simple") {
  const Model model = build(random_lattice(11, 12, 10, {3, 3}));
  const InterfaceOperator p = InterfaceFamily(model.parts).at(infinity);
  int compared = 0;
  for (const double epsilon : {1e-3, 0.1, 10.0})
    for (const SpectrumSide side : {SpectrumSide::low, SpectrumSide::high}) {
      INFO("epsilon = ", epsilon, ", side = ", to_string(side));
      ModeParameters parameters{.epsilon = epsilon, .side = side};
      parameters.spectral.solver = SpectralSolver::dense;
      const Mode dense = interface_mode(model, parameters);
      const double gap = std::abs(dense.next - dense.eigenvalue);
      if (gap < 1e-4) continue;
      ++compared;
      for (const SpectralSolver solver : {SpectralSolver::arpack, SpectralSolver::shift_invert}) {
        parameters.spectral.solver = solver;
        const Mode other = interface_mode(model, parameters);
        REQUIRE(other.found());
        CHECK(std::abs(other.eigenvalue - dense.eigenvalue) < 1e-8);
        // an eigenvector is within residual / gap of the subspace; the sign is fixed
        CHECK(norm(other.impulses - dense.impulses, p) < 3 * (other.residual + dense.residual) / gap + 1e-9);
      }
    }
  CHECK(compared >= 4);
}

TEST_CASE("mode: equal bits from run to run, and the sign does not depend on that of the solver") {
  const Model model = build(random_lattice(2, 8, 6, {3, 2}));
  const Mode first = interface_mode(model, {.epsilon = 0.01}), second = interface_mode(model, {.epsilon = 0.01});
  CHECK(first.impulses == second.impulses);
  for (std::size_t e = 0; e < first.velocities.size(); ++e) CHECK(first.velocities[e] == second.velocities[e]);
  const InterfaceOperator p = InterfaceFamily(model.parts).at(infinity);
  CHECK((normalised(-3.0 * first.impulses, p) - first.impulses).norm() < 1e-14 * first.impulses.norm());
  Vector even = Vector::Zero(p.rows());  // two components equal to rounding: the first decides
  even[1] = -1;
  even[4] = 1 + 1e-13;
  CHECK(normalised(even, p)[1] > 0);
  CHECK(normalised(even, p)[4] < 0);
}

TEST_CASE("mode: no mode of an empty interface, and tables without rows") {
  Case one = strip(12);
  one.spec.partition = GridPartitioner{{1, 1}};
  const Model model = build(one);
  const ModeParameters parameters;
  const Mode mode = interface_mode(model, parameters);
  CHECK_FALSE(mode.found());
  CHECK(mode.converged);
  CHECK(mode.spectrum.solver == "none");
  CHECK(velocity_rows(model, mode).empty());
  CHECK(impulse_rows(model, parameters, mode).empty());
}

TEST_CASE("mode: what is not converged is no mode, or says so") {
  const Model model = build(random_lattice(13, 10, 14, {2, 4}));
  ModeParameters parameters{.epsilon = 1e-3};
  parameters.spectral.solver = SpectralSolver::arpack;
  parameters.spectral.tolerance = 1e-14;
  parameters.spectral.arpack.basis = 4;
  parameters.spectral.arpack.maximum_restarts = 1;
  CHECK_FALSE(interface_mode(model, parameters).converged);
}

TEST_CASE("mode tables: one row per copy and per gluing row, jumps of both agree") {
  for (const Case& one : {strip(8), random_lattice(1, 6, 5, {2, 2}), two_tetrahedra(),
                          random_fcc(1, 4, 4, 4, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    const bool space = model.problem.dimension == 3;
    const ModeParameters parameters{.epsilon = 0.1};
    const Mode mode = interface_mode(model, parameters);
    const auto grain_columns = headings(mode_velocity_columns(model.problem.dimension));
    const auto row_columns = headings(mode_impulse_columns(model.problem.dimension));
    CHECK(grain_columns.size() == (space ? 12 : 10));
    CHECK(row_columns.size() == (space ? 18 : 15));
    const auto grains = velocity_rows(model, mode), rows = impulse_rows(model, parameters, mode);
    Index copies = 0;
    for (Index g = 0; g < model.grains(); ++g) copies += model.parts.interface.multiplicity(g);
    REQUIRE(count(grains) == copies);
    REQUIRE(count(rows) == count(model.parts.interface.gluing()));
    std::map<std::pair<double, double>, std::array<double, 3>> velocity;
    std::map<double, double> largest;
    for (const Row& row : grains) {
      REQUIRE(row.size() == grain_columns.size());
      const auto cell = [&](const std::string& name) { return number(row, grain_columns, name); };
      velocity[{cell("grain"), cell("subdomain")}] = {cell("velocity_x"), cell("velocity_y"),
                                                      space ? cell("velocity_z") : 0};
      if (space) CHECK(cell("z") == model.packing.z[static_cast<std::size_t>(cell("grain"))]);
      largest[cell("grain")] = std::max(largest[cell("grain")], cell("jump"));
      if (cell("multiplicity") == 1) CHECK(cell("jump") == 0);
    }
    for (const Row& row : rows) {
      REQUIRE(row.size() == row_columns.size());
      const auto cell = [&](const std::string& name) { return number(row, row_columns, name); };
      const auto first = velocity.at({cell("grain"), cell("subdomain_first")});
      const auto second = velocity.at({cell("grain"), cell("subdomain_second")});
      CHECK(std::abs(first[0] - second[0] - cell("jump_x")) < 1e-13);
      CHECK(std::abs(first[1] - second[1] - cell("jump_y")) < 1e-13);
      const double jump_z = space ? cell("jump_z") : 0;
      CHECK(std::abs(first[2] - second[2] - jump_z) < 1e-13);
      if (space) CHECK(cell("z") == model.packing.z[static_cast<std::size_t>(cell("grain"))]);
      CHECK(std::hypot(cell("jump_x"), cell("jump_y"), jump_z) <= largest.at(cell("grain")) + 1e-13);
    }
    double total = 0;
    Index counted = 0;
    double before = infinity;
    for (const InterfaceShare& pair : shares_by_interface(mode)) {
      CHECK(pair.first < pair.second);
      CHECK(pair.share <= before);
      before = pair.share;
      total += pair.share;
      counted += pair.rows;
    }
    CHECK(total == doctest::Approx(1).epsilon(1e-12));
    CHECK(counted == count(model.parts.interface.gluing()));
  }
}

TEST_CASE("mode: names of the ends of the spectrum") {
  for (const SpectrumSide side : {SpectrumSide::slowest, SpectrumSide::low, SpectrumSide::high})
    CHECK(Choice<SpectrumSide>::parse(to_string(side), "side") == side);
  CHECK_THROWS_AS(Choice<SpectrumSide>::parse("fastest", "side"), Error);
}
