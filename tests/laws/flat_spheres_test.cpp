// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres whose centres lie in a plane are the disks of that plane: no contact sees them move out of it, where Stage 1
// and Stage 2 therefore agree, and leave no error.
#include "../support/problems.hpp"
#include "mechanics/active_set.hpp"
#include "study/linear/modes.hpp"
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

struct FlatPoint {
  double epsilon, eta;
};
constexpr FlatPoint points[] = {{0, 0.3}, {0, infinity}, {1e-2, 0.3}, {1e-2, infinity},
                                {1, 0.3}, {1, infinity}, {50, 2},     {0.3, 0.3}};

// The spectrum of the disks, with a 0 for every unknown out of the plane.
void check_same(const SpectralRadius& space, const SpectralRadius& plane, double tolerance) {
  REQUIRE(space.converged);
  REQUIRE(plane.converged);
  const double allowed = tolerance * std::max(1.0, plane.value);
  CHECK(std::abs(space.value - plane.value) <= allowed);
  CHECK(std::abs(space.subdominant - plane.subdominant) <= allowed);
  CHECK(std::abs(space.eigenvalue_min - std::min(plane.eigenvalue_min, 0.0)) <= allowed);
  CHECK(std::abs(space.eigenvalue_max - std::max(plane.eigenvalue_max, 0.0)) <= allowed);
  CHECK(space.unit_multiplicity == plane.unit_multiplicity);
}

}  // namespace

TEST_CASE("flat spheres: the radii of the disks to 1e-12, of all contacts, the active and the carrying ones") {
  int compared = 0;
  for (const Case& one : with_interface(plane_problems())) {
    CAPTURE(one.spec.name);
    const Model plane = build(one), space = build(flat(one));
    REQUIRE(space.problem.dimension == 3);
    REQUIRE(space.network.size() == plane.network.size());
    CHECK(space.partition.subdomain_of_contact == plane.partition.subdomain_of_contact);
    CHECK(2 * space.parts.interface_size() == 3 * plane.parts.interface_size());
    CHECK(flexibility_scale(space) == flexibility_scale(plane));
    for (const ContactSet contacts : {ContactSet::all, ContactSet::active, ContactSet::unilateral}) {
      const Selection of_plane = select(plane, contacts), of_space = select(space, contacts);
      CHECK(of_space.of_case.active_contacts == of_plane.of_case.active_contacts);
      CHECK(of_space.of_case.rule == of_plane.of_case.rule);
      const InterfaceFamily all_plane(plane.parts), all_space(space.parts);
      const InterfaceFamily some_plane(of_plane.stage_one(plane)), some_space(of_space.stage_one(space));
      for (const FlatPoint& point : points) {
        INFO("epsilon = ", point.epsilon, ", eta = ", point.eta);
        const Contraction b{all_plane.at(point.eta), some_plane.at(point.epsilon)},
            c{all_space.at(point.eta), some_space.at(point.epsilon)};
        check_same(spectral_radius(c), spectral_radius(b), 1e-12);
        ++compared;
      }
    }
  }
  CHECK(compared >= 7 * 24);
}

TEST_CASE("flat spheres in a plane that lies askew: the radii of the disks") {
  for (const Case& one : with_interface(plane_problems())) {
    CAPTURE(one.spec.name);
    const Model plane = build(one), askew = moved(flat(one), 0.9, 3.0, -7.0);
    REQUIRE(askew.network.size() == plane.network.size());
    const InterfaceFamily of_plane(plane.parts), of_space(askew.parts);
    for (const FlatPoint& point : points) {
      INFO("epsilon = ", point.epsilon, ", eta = ", point.eta);
      check_same(spectral_radius({of_space.at(point.eta), of_space.at(point.epsilon)}),
                 spectral_radius({of_plane.at(point.eta), of_plane.at(point.epsilon)}), 1e-9);
    }
  }
}

TEST_CASE("flat spheres: the slowest mode stays in the plane, and is that of the disks") {
  for (const Case& one : {strip(8), random_lattice(2, 8, 6, {3, 2})}) {
    CAPTURE(one.spec.name);
    const Model plane = build(one), space = build(flat(one));
    const ModeParameters parameters{.epsilon = 0.1};
    const Mode of_plane = interface_mode(plane, parameters), of_space = interface_mode(space, parameters);
    REQUIRE(std::abs(of_plane.next - of_plane.eigenvalue) > 1e-3);  // one mode, up to its sign
    CHECK(std::abs(of_space.eigenvalue - of_plane.eigenvalue) < 1e-12);
    const auto rows = count(plane.parts.interface.gluing());
    REQUIRE(of_space.impulses.size() == 3 * rows);
    for (Index k = 0; k < rows; ++k) {
      const auto in_space = of_space.impulses.segment(3 * k, 3);
      CHECK((in_space.head(2) - of_plane.impulses.segment(2 * k, 2)).norm() < 1e-8);
      CHECK(std::abs(in_space[2]) < 1e-8);
    }
  }
}
