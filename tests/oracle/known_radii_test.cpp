// SPDX-License-Identifier: GPL-3.0-or-later
// Radii known in closed form (4 disks), and to 30 digits from exact arithmetic (exact_references.csv), in
// the plane and in space.
#include "../support/problems.hpp"
#include "../support/run_program.hpp"
#include "files/csv.hpp"
#include "mechanics/active_set.hpp"
#include <nscdd/core/fields.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Eigenvalues of B_eps for 4 disks: 3/(5+2 eps), 1/(5+2 eps) and the roots z of
// (4 e^3 + 44 e^2 + 153 e + 168) z^2 - (16 e^2 + 108 e + 174) z + 15 e + 42 = 0.
std::vector<double> four_disks(double e) {
  const double a = 4 * e * e * e + 44 * e * e + 153 * e + 168, b = 16 * e * e + 108 * e + 174, c = 15 * e + 42;
  const double root = std::sqrt(b * b - 4 * a * c), larger = (b + root) / (2 * a);
  return {3 / (5 + 2 * e), 1 / (5 + 2 * e), larger, c / (a * larger)};
}

// Spheres of unit diameter as exact_references.py has them.
Packing touching_spheres(const std::vector<std::array<double, 3>>& centres) {
  Packing packing;
  for (const auto& [x, y, z] : centres) {
    packing.x.push_back(x);
    packing.y.push_back(y);
    packing.z.push_back(z);
    packing.radius.push_back(0.5);
  }
  return packing;
}

Packing spheres(const std::string& name) {
  const double flat = std::sqrt(3.0) / 6, high = std::sqrt(6.0) / 3, half = std::sqrt(0.5);
  if (name == "tetrahedra")
    return touching_spheres({{0.5, flat, -high}, {0, 0, 0}, {1, 0, 0}, {0.5, 3 * flat, 0}, {0.5, flat, high}});
  if (name == "octahedron")
    return touching_spheres({{0.5, 0.5, -half}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, half}});
  if (name == "cube") return generate(CubicLattice{{.columns = 2, .rows = 2, .layers = 2, .radius = 0.5}});
  std::vector<std::array<double, 3>> centres{{0, -1, 0}, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const double z : {-half, half})
    for (const double y : {-0.5, 0.5})
      for (const double x : {-0.5, 0.5}) centres.push_back({x, y, z});
  return touching_spheres(centres);
}

// The last sphere arrives from above where the references have an active set.
Model model_of(const std::string& name) {
  const std::map<std::string, Index> disks{{"disks4", 4}, {"disks8", 8}, {"disks12", 12}};
  if (disks.contains(name)) return build(strip(disks.at(name)));
  Case one;
  one.spec.name = name;
  one.spec.packing = PackingFile{"made in a test"};
  one.packing = spheres(name);
  if (name == "cube")
    one.spec.partition = GridPartitioner{{2, 2, 1}};
  else
    one.spec.partition = GridPartitioner{{1, 1, 2}};
  Model model = build(one);
  model.problem.arriving_velocity[model.problem.arriving_velocity.size() - 1] = -1;
  return model;
}

// What shift-invert proves holds the exact ends. A unit eigenvalue is known beforehand, and lies in no interval.
void check_enclosed(const Contraction& b, double low, double high) {
  const SpectralRadius proved = spectral_radius(b, {.solver = SpectralSolver::shift_invert, .certify = true});
  CHECK(proved.certified);
  CHECK(std::abs(proved.eigenvalue_min - low) < 1e-8 * std::max(1.0, -low));
  CHECK(std::abs(proved.eigenvalue_max - high) < 1e-8);
  CHECK(proved.interval_min[0] <= low);
  CHECK(proved.interval_min[1] >= low);
  if (high == 1) {
    // 36 contacts of 13 spheres, whose rank is 32: beside 6 rigid motions the twist of the outer 12 about a diagonal,
    // as a cuboctahedron folds, opens and closes no contact.
    CHECK(proved.unit_multiplicity == 4);
  } else {
    CHECK(proved.interval_max[0] <= high);
    CHECK(proved.interval_max[1] >= high);
  }
}

std::string source_file(const std::string& name) { return (source_folder() / name).string(); }

}  // namespace

TEST_CASE("4 disks: closed form of both ends for all epsilon to 1e-12") {
  const Model model = build(strip(4));
  const InterfaceFamily family(model.parts);
  for (double exponent = -10; exponent <= 6; exponent += 0.125) {
    const double epsilon = std::pow(10.0, exponent);
    CAPTURE(epsilon);
    const std::vector<double> expected = four_disks(epsilon);
    for (const SpectralSolver solver : {SpectralSolver::dense, SpectralSolver::arpack}) {
      const SpectralRadius radius = spectral_radius({family.at(infinity), family.at(epsilon)}, {.solver = solver});
      REQUIRE(radius.converged);
      CHECK(std::abs(radius.value - *std::max_element(expected.begin(), expected.end())) < 1e-12);
      CHECK(std::abs(radius.eigenvalue_min - *std::min_element(expected.begin(), expected.end())) < 1e-12);
    }
  }
}

TEST_CASE("4 disks: rho(B_0) = (29 + sqrt 57)/56, rho(B-bar) = 3/5") {
  const Model model = build(strip(4));
  const SpectralRadius rigid = spectral_radius(contraction(model.parts, Generic{}, LinearViscous{0}));
  CHECK(std::abs(rigid.value - (29 + std::sqrt(57.0)) / 56) < 1e-14);
  const std::vector<char> active = active_contacts(model.problem, rigid_impulses(model.problem));
  CHECK(active == std::vector<char>{1, 1, 0, 1, 1});
  const SpectralRadius nonsmooth = spectral_radius(contraction(model.parts, Generic{}, LinearViscous{0}, active));
  CHECK(std::abs(nonsmooth.value - 0.6) < 1e-14);
}

TEST_CASE("the scheme schwarz: every radius against exact arithmetic to 1e-12") {
  const std::string path = source_file("tests/oracle/exact_schwarz.csv");
  const CsvText references = parse_csv(read_text(path), path);
  for (const auto& row : references.rows) {  // case, contact_set, epsilon, eta, three numbers
    CAPTURE(row[0]);
    const double epsilon = parse_number(row[2], "epsilon");
    const SpectralRadius radius = spectral_radius(schwarz_contraction(model_of(row[0]).parts, LinearViscous{epsilon}));
    CHECK(std::abs(radius.value - parse_number(row[4], "")) < 1e-12);
    CHECK(std::abs(radius.eigenvalue_min - parse_number(row[5], "")) < 1e-12);
    CHECK(std::abs(radius.eigenvalue_max - parse_number(row[6], "")) < 1e-12);
  }
  CHECK(references.rows.size() == 21);
}

TEST_CASE("4, 8 and 12 disks, four packings of spheres: every radius against exact arithmetic to 1e-12") {
  const std::string path = source_file("tests/oracle/exact_references.csv");
  const CsvText references = parse_csv(read_text(path), path);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(references.columns.begin(), references.columns.end(), name) -
                                    references.columns.begin());
  };
  Index compared = 0;
  for (const auto& row : references.rows) {
    const Model model = model_of(row[column("case")]);
    const double epsilon = parse_number(row[column("epsilon")], "epsilon");
    const double eta = parse_number(row[column("eta")], "eta");
    INFO("case = ", row[column("case")], ", contact_set = ", row[column("contact_set")], ", epsilon = ", epsilon,
         ", eta = ", eta);
    const bool all = row[column("contact_set")] == "all";
    const Contraction b = all ? contraction(model.parts, Enriched{eta}, LinearViscous{epsilon})
                              : contraction(model.parts, Enriched{eta}, LinearViscous{epsilon},
                                            active_contacts(model.problem, rigid_impulses(model.problem)));
    const double value = parse_number(row[column("spectral_radius")], "");
    const double low = parse_number(row[column("eigenvalue_min")], "");
    const double high = parse_number(row[column("eigenvalue_max")], "");
    const SpectralRadius radius = spectral_radius(b);
    CHECK(std::abs(radius.value - value) < 1e-12);
    CHECK(std::abs(radius.eigenvalue_min - low) < 1e-12);
    CHECK(std::abs(radius.eigenvalue_max - high) < 1e-12);
    if (model.packing.dimension() == 3) check_enclosed(b, low, high);
    ++compared;
  }
  CHECK(compared == 114);
}
