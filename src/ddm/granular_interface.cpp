// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/granular_interface.hpp"

namespace nscdd {
namespace {

using Copy = DiskVelocity;

const Copy& copy_of(const GranularDecomposition& parts, const GrainCopy& copy) {
  return parts.subdomains[at(copy.subdomain)].velocities[at(copy.grain)];
}

Copy& copy_of(GranularDecomposition& parts, const GrainCopy& copy) {
  return parts.subdomains[at(copy.subdomain)].velocities[at(copy.grain)];
}

// V -= M^-1 F of one copy; the rim has its own inertia.
void push(Copy& v, double x, double y, double rim) {
  v.x -= v.inverse_mass * x;
  v.y -= v.inverse_mass * y;
  v.rim -= rim_mass_ratio * v.inverse_mass * rim;
}

}  // namespace

Vector interface_jumps(const GranularDecomposition& parts) {
  Vector g(parts.interface_size());
  for (Index row = 0; row < count(parts.gluing); ++row) {
    const Copy& a = copy_of(parts, parts.gluing[at(row)].first);
    const Copy& b = copy_of(parts, parts.gluing[at(row)].second);
    g.segment(3 * row, 3) << a.x - b.x, a.y - b.y, a.rim - b.rim;
  }
  return g;
}

double glued_speed_squared(const GranularDecomposition& parts) {
  double sum = 0;
  const auto add = [&](const Copy& v) { sum += v.x * v.x + v.y * v.y + v.rim * v.rim; };
  for (std::size_t row = 0; row < parts.gluing.size(); ++row) {
    if (row == 0 || parts.gluing[row - 1].grain != parts.gluing[row].grain)
      add(copy_of(parts, parts.gluing[row].first));
    add(copy_of(parts, parts.gluing[row].second));
  }
  return sum;
}

Vector generic_interface_solve(const GranularDecomposition& parts, const Vector& g) {
  Vector f(g.size());
  const Index rows = count(parts.gluing);
  for (Index row = 0; row < rows;) {
    Index last = row;
    while (last + 1 < rows && parts.gluing[at(last + 1)].grain == parts.gluing[at(row)].grain) ++last;
    const double q = static_cast<double>(last - row + 2);
    const double copy_mass = 1 / copy_of(parts, parts.gluing[at(row)].first).inverse_mass;
    // Copy k is at minus the sum of the first k jumps from copy 0; their mean:
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
    for (Index k = row; k <= last; ++k) {
      position -= g.segment<3>(3 * k);
      mean += position / q;
    }
    position.setZero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Index k = row; k <= last; ++k) {
      sum += position - mean;
      f.segment<3>(3 * k) = copy_mass * sum;
      f[3 * k + 2] /= rim_mass_ratio;
      position -= g.segment<3>(3 * k);
    }
    row = last + 1;
  }
  return f;
}

void apply_interface_impulses(GranularDecomposition& parts, const Vector& change) {
  for (Index row = 0; row < count(parts.gluing); ++row) {
    const Gluing& g = parts.gluing[at(row)];
    const double x = change[3 * row], y = change[3 * row + 1], rim = change[3 * row + 2];
    push(copy_of(parts, g.first), x, y, rim);
    push(copy_of(parts, g.second), -x, -y, -rim);
  }
}

}  // namespace nscdd
