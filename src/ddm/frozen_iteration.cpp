// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/frozen_iteration.hpp"

#include "ddm/granular_interface.hpp"
#include "linalg/threads.hpp"
#include "mechanics/connectivity.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

constexpr double radius_tolerance = 1e-6;

// Square roots of the inertia of one body, x, y and rim.
Eigen::Vector3d root_inertia(const DiskVelocity& v) {
  const double root = std::sqrt(1 / v.inverse_mass);
  return {root, root, root / std::sqrt(rim_mass_ratio)};
}

bool slides(ContactStatus s) { return s == ContactStatus::slide_forward || s == ContactStatus::slide_backward; }

// Impulse along n + slope t per unit of its normal component.
double slope(ContactStatus s, double friction) {
  return s == ContactStatus::slide_forward ? -friction : s == ContactStatus::slide_backward ? friction : 0.0;
}

std::vector<std::vector<ContactStatus>> by_subdomain(const GranularDecomposition& parts,
                                                     const std::vector<ContactStatus>& statuses) {
  std::vector<std::vector<ContactStatus>> result;
  for (const GranularSubdomain& subdomain : parts.subdomains) {
    result.emplace_back();
    for (const Index c : subdomain.numbers) result.back().push_back(statuses[at(c)]);
  }
  return result;
}

// One subdomain in y: the first entry of each of its bodies in its part of y, and what its contacts add.
struct LocalMaps {
  std::vector<BodyRows> bodies;
  Vector root;            // of the inertia of every entry
  SparseMatrix impulses;  // M^-1/2 G, the directions of impulses
  SparseMatrix resting;   // M^-1/2 N, the directions in which contacts keep v = 0
  SparseMatrix gluing;    // M^-1/2 A^T
};

SparseMatrix over_rows(SparseMatrix matrix, const Vector& root) {
  for (Index j = 0; j < matrix.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(matrix, j); e; ++e) e.valueRef() /= root[e.row()];
  return matrix;
}

LocalMaps local_maps(const GranularDecomposition& parts, Index e, const std::vector<ContactStatus>& statuses) {
  const GranularSubdomain& subdomain = parts.subdomains[at(e)];
  LocalMaps maps;
  std::vector<double> root;
  for (const DiskVelocity& v : subdomain.velocities) {
    maps.bodies.push_back({v.inverse_mass > 0 ? count(root) : -1});
    if (v.inverse_mass == 0) continue;
    const Eigen::Vector3d of_body = root_inertia(v);
    root.insert(root.end(), of_body.begin(), of_body.end());
  }
  maps.root = Vector::Map(root.data(), count(root));
  ConnectivityBuilder impulses(2 * statuses.size()), resting(2 * statuses.size());
  for (std::size_t k = 0; k < statuses.size(); ++k) {
    if (statuses[k] == ContactStatus::open) continue;
    const DiskContact c = subdomain.contacts.contact(k, subdomain.velocities);
    const auto put = [&](LocalVector impulse, LocalVector rest) {
      impulses.add(c.normal(), maps.bodies[at(c.a)], maps.bodies[at(c.b)], impulse);
      resting.add(c.normal(), maps.bodies[at(c.a)], maps.bodies[at(c.b)], rest);
    };
    put({1, slope(statuses[k], c.friction)}, {1, 0});
    if (statuses[k] == ContactStatus::stick) put({0, 1}, {0, 1});
  }
  maps.impulses = over_rows(impulses.matrix(maps.root.size()), maps.root);
  maps.resting = over_rows(resting.matrix(maps.root.size()), maps.root);
  SparseEntries gluing;
  for (const Tie& tie : parts.interface.ties(e))
    for (Index k = 0; k < 3; ++k) {
      const Index row = maps.bodies[at(tie.grain)].first + k;
      gluing.add(row, 3 * tie.row + k, tie.sign / maps.root[row]);
    }
  maps.gluing = gluing.matrix(maps.root.size(), parts.interface_size());
  return maps;
}

void sweep(const GranularSubdomain& subdomain, const std::vector<ContactStatus>& statuses,
           std::vector<DiskVelocity>& v) {
  for (std::size_t k = 0; k < statuses.size(); ++k) {
    if (statuses[k] == ContactStatus::open) continue;
    const DiskContact c = subdomain.contacts.contact(k, v);
    const LocalVector relative = relative_velocity(c, v);
    LocalVector change{-c.inverse_w.inverse_n * relative.n, -c.inverse_w.inverse_t * relative.t};
    if (slides(statuses[k])) change.t = slope(statuses[k], c.friction) * change.n;
    apply_impulse(c, change, v);
  }
}

}  // namespace

FrozenIteration::FrozenIteration(GranularDecomposition parts, const std::vector<ContactStatus>& statuses, Index sweeps,
                                 std::optional<InterfaceOperator> enriched, double relaxation)
    : parts_(std::move(parts)),
      statuses_(by_subdomain(parts_, statuses)),
      sweeps_(sweeps),
      enriched_(std::move(enriched)),
      relaxation_(relaxation) {
  copies_ = parts_;
  for (GranularSubdomain& subdomain : copies_.subdomains) subdomain.contacts = {};
  SparseEntries impulses, gluing;
  Index columns = 0;
  for (Index e = 0; e < count(parts_.subdomains); ++e) {
    const LocalMaps maps = local_maps(parts_, e, statuses_[at(e)]);
    impulses.add_block(maps.impulses, size_, columns);
    gluing.add_block(maps.gluing, size_, 0);
    columns += maps.impulses.cols();
    size_ += maps.root.size();
  }
  impulses.add_block(gluing.matrix(size_, parts_.interface_size()), 0, columns);
  range_ = std::make_shared<RangeProjector>(impulses.matrix(size_, columns + parts_.interface_size()));
}

Vector FrozenIteration::apply(const Vector& y) const {
  GranularDecomposition work = copies_;
  Index k = 0;
  const auto exchange = [&](const auto& visit) {
    k = 0;
    for (GranularSubdomain& subdomain : work.subdomains)
      for (DiskVelocity& v : subdomain.velocities) {
        if (v.inverse_mass == 0) continue;
        visit(v, root_inertia(v));
        k += 3;
      }
  };
  exchange([&](DiskVelocity& v, const Eigen::Vector3d& root) {
    v.x = y[k] / root[0];
    v.y = y[k + 1] / root[1];
    v.rim = y[k + 2] / root[2];
  });
  for (std::size_t e = 0; e < work.subdomains.size(); ++e) {
    GranularSubdomain& subdomain = work.subdomains[e];
    for (DiskVelocity& v : subdomain.velocities)
      if (v.inverse_mass == 0) v.x = v.y = v.rim = 0;
    for (Index n = 0; n < sweeps_; ++n) sweep(parts_.subdomains[e], statuses_[e], subdomain.velocities);
  }
  if (work.interface_size() > 0) {
    const Vector jumps = interface_jumps(work);
    apply_interface_impulses(
        work, relaxation_ * (enriched_ ? enriched_->solve(jumps) : generic_interface_solve(work, jumps)));
  }
  Vector image(size_);
  exchange([&](DiskVelocity& v, const Eigen::Vector3d& root) {
    image.segment<3>(k) << v.x * root[0], v.y * root[1], v.rim * root[2];
  });
  return project(image);
}

Matrix frozen_contraction(const GranularDecomposition& parts, const std::vector<ContactStatus>& statuses,
                          const std::optional<InterfaceOperator>& enriched, double relaxation) {
  const OneBlasThread serial_blas;
  const auto local = by_subdomain(parts, statuses);
  Matrix system = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (Index e = 0; e < count(parts.subdomains); ++e) {
    const LocalMaps maps = local_maps(parts, e, local[at(e)]);
    const Matrix a(maps.gluing);
    Matrix kept = a;
    if (maps.impulses.cols() > 0) {
      const Matrix w(maps.resting.transpose() * maps.impulses);
      kept -=
          maps.impulses * Eigen::CompleteOrthogonalDecomposition<Matrix>(w).solve(Matrix(maps.resting.transpose() * a));
    }
    system += a.transpose() * kept;
  }
  Matrix b = Matrix::Identity(system.rows(), system.cols());
  for (Index k = 0; k < system.cols(); ++k) {
    const Vector column = system.col(k);
    b.col(k) -= relaxation * (enriched ? enriched->solve(column) : generic_interface_solve(parts, column));
  }
  return b;
}

MapRadius frozen_radius(const Matrix& contraction) {
  return map_radius(contraction, {.tolerance = radius_tolerance}, UnitEigenvalues::passed_over);
}

MapRadius frozen_radius(const FrozenIteration& iteration, const ArpackOptions& options) {
  return map_radius(iteration, {.tolerance = radius_tolerance, .arpack = options}, UnitEigenvalues::passed_over);
}

}  // namespace nscdd
