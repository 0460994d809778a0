// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/frozen_iteration.hpp"

#include "ddm/granular_interface.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

constexpr double unit_tolerance = 1e-9;
constexpr Index dense_limit = 400;

using Triplets = std::vector<Eigen::Triplet<double>>;

// Square roots of the inertia of one body, x, y and rim.
Eigen::Vector3d root_inertia(const DiskVelocity& v) {
  const double root = std::sqrt(1 / v.inverse_mass);
  return {root, root, root / std::sqrt(rim_mass_ratio)};
}

bool slides(ContactStatus s) {
  return s == ContactStatus::slide_forward || s == ContactStatus::slide_backward;
}

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

// First entry of each free body of a subdomain in y, -1 for a driven one.
std::vector<Index> entries(const GranularSubdomain& subdomain, Index& next) {
  std::vector<Index> first;
  for (const DiskVelocity& v : subdomain.velocities) {
    first.push_back(v.inverse_mass > 0 ? next : -1);
    if (v.inverse_mass > 0) next += 3;
  }
  return first;
}

// Column of M^-1/2 H for the direction normal n + tangential t of a contact.
void put_column(Triplets& triplets, const DiskContact& c, std::span<const DiskVelocity> v,
                const std::vector<Index>& first, Index column, double normal, double tangential) {
  for (const auto& [body, sign] : {std::pair(c.a, -1.0), std::pair(c.b, 1.0)}) {
    const Index row = first[static_cast<std::size_t>(body)];
    if (row < 0) continue;
    const Eigen::Vector3d root = root_inertia(v[static_cast<std::size_t>(body)]);
    const std::array<double, 3> impulse = impulse_on_disk(c, sign, {normal, tangential});
    for (int k = 0; k < 3; ++k)
      triplets.emplace_back(static_cast<int>(row + k), static_cast<int>(column), impulse[at(k)] / root[k]);
  }
}

// M^-1/2 G and M^-1/2 N of one subdomain: directions of impulses, and of velocities that are kept at 0.
struct Directions {
  Triplets impulses, velocities;
  Index columns = 0;
};

Directions directions(const GranularSubdomain& subdomain, const std::vector<ContactStatus>& statuses,
                      const std::vector<Index>& first, Index column) {
  Directions result;
  const auto put = [&](const DiskContact& c, double g_n, double g_t, double n_n, double n_t) {
    put_column(result.impulses, c, subdomain.velocities, first, column + result.columns, g_n, g_t);
    put_column(result.velocities, c, subdomain.velocities, first, column + result.columns, n_n, n_t);
    ++result.columns;
  };
  for (std::size_t k = 0; k < statuses.size(); ++k) {
    const DiskContact c = subdomain.contacts.contact(k, subdomain.velocities);
    if (statuses[k] == ContactStatus::open) continue;
    put(c, 1, slope(statuses[k], c.friction), 1, 0);
    if (statuses[k] == ContactStatus::stick) put(c, 0, 1, 0, 1);
  }
  return result;
}

// M^-1/2 A^T of all copies.
Index put_gluing(Triplets& triplets, const GranularDecomposition& parts,
                 const std::vector<std::vector<Index>>& first, Index column) {
  for (const Gluing& g : parts.interface.gluing()) {
    for (const auto& [copy, sign] : {std::pair(g.first, 1.0), std::pair(g.second, -1.0)}) {
      const Eigen::Vector3d root =
          root_inertia(parts.subdomains[at(copy.subdomain)].velocities[at(copy.grain)]);
      const Index row = first[at(copy.subdomain)][at(copy.grain)];
      for (int k = 0; k < 3; ++k)
        triplets.emplace_back(static_cast<int>(row + k), static_cast<int>(column + k), sign / root[k]);
    }
    column += 3;
  }
  return column;
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

FrozenRadius largest(const Eigen::VectorXcd& values) {
  FrozenRadius result;
  for (const std::complex<double>& value : values) {
    if (std::abs(value - 1.0) <= unit_tolerance) {
      ++result.unit_multiplicity;
    } else if (std::abs(value) >= result.value) {
      result.value = std::abs(value);
      result.dominant = {value.real(), std::abs(value.imag())};
    }
  }
  return result;
}

}  // namespace

FrozenIteration::FrozenIteration(GranularDecomposition parts, const std::vector<ContactStatus>& statuses,
                                 Index sweeps, std::optional<InterfaceOperator> enriched, double relaxation)
    : parts_(std::move(parts)),
      statuses_(by_subdomain(parts_, statuses)),
      sweeps_(sweeps),
      enriched_(std::move(enriched)),
      relaxation_(relaxation) {
  copies_ = parts_;
  for (GranularSubdomain& subdomain : copies_.subdomains) subdomain.contacts = {};
  std::vector<std::vector<Index>> first;
  for (const GranularSubdomain& subdomain : parts_.subdomains) first.push_back(entries(subdomain, size_));
  Triplets triplets;
  Index columns = 0;
  for (std::size_t e = 0; e < parts_.subdomains.size(); ++e) {
    const Directions one = directions(parts_.subdomains[e], statuses_[e], first[e], columns);
    triplets.insert(triplets.end(), one.impulses.begin(), one.impulses.end());
    columns += one.columns;
  }
  columns = put_gluing(triplets, parts_, first, columns);
  SparseMatrix caused(size_, columns);
  caused.setFromTriplets(triplets.begin(), triplets.end());
  range_ = std::make_shared<RangeProjector>(caused);
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
  const auto local = by_subdomain(parts, statuses);
  Matrix system = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (std::size_t e = 0; e < parts.subdomains.size(); ++e) {
    const GranularSubdomain& subdomain = parts.subdomains[e];
    Index size = 0;
    std::vector<std::vector<Index>> first(parts.subdomains.size());
    first[e] = entries(subdomain, size);
    const Directions one = directions(subdomain, local[e], first[e], 0);
    SparseMatrix g(size, one.columns), n(size, one.columns);
    g.setFromTriplets(one.impulses.begin(), one.impulses.end());
    n.setFromTriplets(one.velocities.begin(), one.velocities.end());
    Matrix a = Matrix::Zero(size, parts.interface_size());  // M^-1/2 A_E^T
    for (const Tie& tie : parts.interface.ties(static_cast<Index>(e))) {
      const Eigen::Vector3d root = root_inertia(subdomain.velocities[at(tie.grain)]);
      for (Index k = 0; k < 3; ++k) a(first[e][at(tie.grain)] + k, 3 * tie.row + k) = tie.sign / root[k];
    }
    Matrix kept = a;
    if (one.columns > 0) {
      const Matrix w = Matrix(n.transpose() * g);
      kept -= g * Eigen::CompleteOrthogonalDecomposition<Matrix>(w).solve(Matrix(n.transpose() * a));
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

FrozenRadius frozen_radius(const Matrix& contraction) {
  if (contraction.rows() == 0) return {};
  const Eigen::EigenSolver<Matrix> solver(contraction, false);
  FrozenRadius result = largest(solver.eigenvalues());
  result.converged = solver.info() == Eigen::Success;
  return result;
}

FrozenRadius frozen_radius(const FrozenIteration& iteration, const ArpackOptions& options) {
  const Index n = iteration.rows();
  if (n == 0) return {};
  if (n <= dense_limit) return frozen_radius(dense(iteration));
  const ArnoldiResult found = arnoldi(n, linear_map(iteration), options, unit_tolerance);
  FrozenRadius result;
  result.unit_multiplicity = found.units;
  result.value = std::abs(found.value);
  result.dominant = found.value;
  result.residual = found.residual;
  result.converged = found.converged && found.residual <= 1e-6 * std::max(1.0, result.value);
  return result;
}

}  // namespace nscdd
