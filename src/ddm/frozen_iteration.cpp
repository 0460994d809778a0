// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/frozen_iteration.hpp"

#include "ddm/frozen_network.hpp"
#include "linalg/pencil.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

constexpr double radius_tolerance = 1e-6;

// One subdomain in y, and what its contacts and its neighbours add.
struct LocalMaps {
  FrozenNetwork network;
  SparseMatrix gluing;  // M^-1/2 A^T
};

LocalMaps local_maps(const GranularDecomposition<2>& parts, Index e, const std::vector<ContactStatus>& statuses) {
  const GranularSubdomain<2>& subdomain = parts.subdomains[at(e)];
  std::vector<ContactStatus> own;
  for (const Index contact : subdomain.numbers) own.push_back(statuses[at(contact)]);
  LocalMaps maps{frozen_network(subdomain, own), {}};
  const Vector& root = maps.network.root;
  SparseEntries gluing;
  for (const Tie& tie : parts.interface.ties(e))
    for (Index k = 0; k < 3; ++k) {
      const Index row = maps.network.rows[at(tie.grain)].first + k;
      gluing.add(row, 3 * tie.row + k, tie.sign / root[row]);
    }
  maps.gluing = gluing.matrix(root.size(), parts.interface_size());
  return maps;
}

void sweep(const GranularSubdomain<2>& subdomain, const std::vector<ContactStatus>& statuses,
           std::vector<GrainVelocity<2>>& v) {
  for (std::size_t k = 0; k < subdomain.numbers.size(); ++k) {
    const ContactStatus status = statuses[at(subdomain.numbers[k])];
    if (status == ContactStatus::open) continue;
    const GrainContact<2> c = subdomain.contacts.contact(k, v);
    LocalVector<2> change = -1.0 * c.inverse_w.solve(relative_velocity(c, v));
    if (status != ContactStatus::stick) change.t = sliding_slope(status, c.friction) * change.n;
    apply_impulse(c, change, v);
  }
}

}  // namespace

FrozenIteration::FrozenIteration(GranularDecomposition<2> parts, std::vector<ContactStatus> statuses, Index sweeps,
                                 std::optional<InterfaceOperator> enriched, double relaxation)
    : parts_(std::move(parts)),
      resting_(parts_),
      statuses_(std::move(statuses)),
      sweeps_(sweeps),
      enriched_(std::move(enriched)),
      relaxation_(relaxation) {
  for (GranularSubdomain<2>& subdomain : resting_.subdomains) {
    subdomain.contacts = {};
    for (GrainVelocity<2>& v : subdomain.velocities) v = {.inverse_mass = v.inverse_mass};
  }
  SparseEntries impulses, gluing;
  Index size = 0, columns = 0;
  std::vector<double> root;
  for (Index e = 0; e < count(parts_.subdomains); ++e) {
    const LocalMaps maps = local_maps(parts_, e, statuses_);
    const FrozenNetwork& network = maps.network;
    impulses.add_block(network.impulses, size, columns);
    gluing.add_block(maps.gluing, size, 0);
    columns += network.impulses.cols();
    size += network.root.size();
    root.insert(root.end(), network.root.begin(), network.root.end());
  }
  root_ = Vector::Map(root.data(), size);
  impulses.add_block(gluing.matrix(size, parts_.interface_size()), 0, columns);
  range_ = std::make_shared<RangeProjector>(impulses.matrix(size, columns + parts_.interface_size()));
}

Vector FrozenIteration::apply(const Vector& y, Index iterations) const {
  GranularDecomposition<2> work = resting_;
  const Vector velocities = y.cwiseQuotient(root_);
  Index k = 0;
  for (GranularSubdomain<2>& subdomain : work.subdomains)
    for (GrainVelocity<2>& v : subdomain.velocities) {
      if (v.inverse_mass == 0) continue;
      v = {velocities[k], velocities[k + 1], velocities[k + 2], v.inverse_mass};
      k += 3;
    }
  for (Index i = 0; i < iterations; ++i) iterate(work);
  return project(free_velocities(work).cwiseProduct(root_));
}

void FrozenIteration::iterate(GranularDecomposition<2>& work) const {
  for (std::size_t e = 0; e < work.subdomains.size(); ++e)
    for (Index n = 0; n < sweeps_; ++n) sweep(parts_.subdomains[e], statuses_, work.subdomains[e].velocities);
  if (work.interface_size() == 0) return;
  const Vector jumps = interface_jumps(work);
  apply_interface_impulses(work,
                           relaxation_ * (enriched_ ? enriched_->solve(jumps) : generic_interface_solve(work, jumps)));
}

Matrix frozen_contraction(const GranularDecomposition<2>& parts, const std::vector<ContactStatus>& statuses,
                          const std::optional<InterfaceOperator>& enriched, double relaxation) {
  const OneBlasThread serial_blas;
  Matrix system = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (Index e = 0; e < count(parts.subdomains); ++e) {
    const LocalMaps maps = local_maps(parts, e, statuses);
    const Matrix a(maps.gluing);
    Matrix kept = a;
    const FrozenNetwork& network = maps.network;
    if (network.impulses.cols() > 0) {
      const Matrix w(network.resting.transpose() * network.impulses);
      const double threshold = std::numeric_limits<double>::epsilon() * static_cast<double>(w.rows());
      kept -= network.impulses * minimum_norm_map(w, threshold)(network.resting.transpose() * a);
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

MapRadius frozen_radius(const FrozenIteration& iteration, const ArpackOptions& options, Index power) {
  const LinearMap map = [&](const Vector& y) { return iteration.apply(y, power); };
  MapRadius radius = map_radius(iteration.rows(), map, {.tolerance = radius_tolerance, .arpack = options},
                                UnitEigenvalues::passed_over);
  if (power > 1) radius.value = std::pow(radius.value, 1 / static_cast<double>(power));
  return radius;
}

}  // namespace nscdd
