// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/dynamics.hpp"

#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <cmath>

namespace nscdd {
namespace {

double length_of(const BoundarySpec& spec) { return std::hypot(spec.to[0] - spec.from[0], spec.to[1] - spec.from[1]); }

void add_wall(GranularSystem& system, const BoundarySpec& spec, Index boundary) {
  const double length = length_of(spec);
  system.walls.push_back({.point = spec.from,
                          .normal = {(spec.from[1] - spec.to[1]) / length, (spec.to[0] - spec.from[0]) / length},
                          .boundary = boundary});
}

void add_disks(GranularSystem& system, std::vector<double>& x, std::vector<double>& y, const BoundarySpec& spec,
               Index boundary) {
  const double length = length_of(spec);
  // As few gaps as keep them no wider than asked for; rounding must not add one.
  const Index gaps = std::max<Index>(1, static_cast<Index>(std::ceil(length / spec.distance() * (1 - 1e-12))));
  for (Index k = 0; k <= gaps; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(gaps);
    x.push_back(spec.from[0] + s * (spec.to[0] - spec.from[0]));
    y.push_back(spec.from[1] + s * (spec.to[1] - spec.from[1]));
    system.radius.push_back(spec.radius);
    system.mass.push_back(1);
    system.driven_by.push_back(boundary);
  }
}

void drive_grains(GranularSystem& system, const BoundarySpec& spec, Index boundary, Index grains) {
  const std::string key = fmt::format("boundary[{}].first", boundary);
  const Index first = spec.first < 0 ? spec.first + grains : spec.first;
  const Index last = spec.last < 0 ? spec.last + grains : spec.last;
  if (first < 0 || last >= grains || first > last)
    throw Error(key, fmt::format("expected grains first <= last in 0..{} (or negative, from the end), "
                                 "met {} and {} of boundary '{}'",
                                 grains - 1, spec.first, spec.last, spec.name));
  for (Index i = first; i <= last; ++i) {
    if (system.driven_by[at(i)] >= 0)
      throw Error(key, fmt::format("expected grains driven once, met grain {} of boundaries '{}' and '{}'", i,
                                   system.boundaries[at(system.driven_by[at(i)])].name, spec.name));
    system.driven_by[at(i)] = boundary;
  }
}

}  // namespace

GranularScene scene(const Packing& packing, const Dynamics& dynamics) {
  if (packing.mass.empty()) throw Error("dynamics: expected grains with masses, met a packing without");
  GranularScene result;
  GranularSystem& system = result.system;
  system.radius = packing.radius;
  system.mass = packing.mass;
  system.driven_by.assign(packing.radius.size(), -1);
  std::vector<double> x = packing.x, y = packing.y;
  for (const BoundarySpec& spec : dynamics.boundaries) {
    check(spec);
    const Index boundary = count(system.boundaries);
    system.boundaries.push_back({spec.name, spec.motion, spec.orientation});
    switch (spec.shape) {
      case BoundaryShape::wall:
        add_wall(system, spec, boundary);
        break;
      case BoundaryShape::disks:
        add_disks(system, x, y, spec, boundary);
        break;
      case BoundaryShape::grains:
        drive_grains(system, spec, boundary, packing.size());
        break;
    }
  }
  result.state = initial_state(system, std::move(x), std::move(y));
  check(system, result.state);
  return result;
}

}  // namespace nscdd
