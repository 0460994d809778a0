// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/contact_frame.hpp"
#include <nscdd/mechanics/reference_problem.hpp>

#include <fmt/ranges.h>

namespace nscdd {
namespace {

// V^- = D (x - x_c), 2 n or 3 n entries.
Vector deformation_velocities(const Packing& packing, const Loads& loads) {
  const Index d = packing.dimension();
  Vector velocities = Vector::Zero(d * packing.size());
  if (loads.none()) return velocities;
  const auto weighted = [&m = packing.mass](const std::vector<double>& x) {
    return std::inner_product(m.begin(), m.end(), x.begin(), 0.0) / std::accumulate(m.begin(), m.end(), 0.0);
  };
  const double centre_x = weighted(packing.x), centre_y = weighted(packing.y),
               centre_z = d == 3 ? weighted(packing.z) : 0;
  for (Index i = 0; i < packing.size(); ++i) {
    const double x = packing.x[at(i)] - centre_x, y = packing.y[at(i)] - centre_y;
    velocities[d * i] = -loads.compression[0] * x + loads.shear * y;
    velocities[d * i + 1] = loads.shear * x - loads.compression[1] * y;
    if (d == 3) velocities[d * i + 2] = -loads.compression[2] * (packing.z[at(i)] - centre_z);
  }
  return velocities;
}

template <int D>
SparseMatrix connectivity(const ContactNetwork& network) {
  ConnectivityBuilder<D> h(D * network.grains, network.contacts.size());
  for (const Contact& contact : network.contacts)
    h.add(narrowed<D>(contact.normal), {D * contact.a}, {D * contact.b}, {1, {}});
  return h.matrix();
}

}  // namespace

void require_fit(const Loads& loads, Index dimension) {
  require_bounds(loads, "loads");
  if (loads.compress()) require_components(loads.compression, dimension, "loads.compression");
}

ReferenceProblem assemble(const Packing& packing, const ContactNetwork& network,
                          const std::vector<PrescribedVelocity>& prescribed, const Loads& loads) {
  if (count(packing.mass) != packing.size())
    fail("assemble: expected a mass for each of {} grains, met {}", packing.size(), packing.mass.size());
  ReferenceProblem problem;
  const Index n = packing.size(), d = packing.dimension();
  if (network.grains != n || network.dimension != d)
    fail("assemble: network: expected {} grains in {}D, met {} in {}D", n, d, network.grains, network.dimension);
  problem.dimension = problem.dofs_per_grain = d;
  problem.inertia.resize(d * n);
  problem.centres.resize(d, n);
  for (Index i = 0; i < n; ++i) {
    problem.inertia.segment(d * i, d).setConstant(packing.mass[at(i)]);
    problem.centres.col(i) = Vector::Map(packing.centre(i).data(), d);
  }
  problem.h = d == 2 ? connectivity<2>(network) : connectivity<3>(network);

  require_fit(loads, d);
  for (const auto& [length, k] : {std::pair(network.period.x, 0), std::pair(network.period.y, 1)})
    if (length > 0 && (loads.compression[at(k)] != 0 || loads.shear != 0))
      throw Error("loads", fmt::format("expected none that deform a cell along its period contacts.period_{}, met a "
                                       "compression or shear, whose velocities jump at its end",
                                       k == 0 ? 'x' : 'y'));
  problem.arriving_velocity = deformation_velocities(packing, loads);
  for (const PrescribedVelocity& one : prescribed) {
    if (one.grain < 0 || one.grain >= n)
      fail("prescribed velocity: expected a grain in 0..{}, met grain {}", n - 1, one.grain);
    require_components(one.velocity, d, fmt::format("prescribed velocity of grain {}", one.grain));
    if (!std::ranges::all_of(one.velocity, [](double v) { return std::isfinite(v); }))
      fail("prescribed velocity of grain {}: expected finite components, met ({})", one.grain,
           fmt::join(one.velocity, ", "));
    std::ranges::copy(one.velocity, problem.arriving_velocity.data() + d * one.grain);
  }
  return problem;
}

void require_arriving_velocity(const ReferenceProblem& problem) {
  if (problem.arriving_velocity.size() == 0 || problem.arriving_velocity.isZero(0))
    throw Error(
        "active contacts: expected a prescribed velocity (a [[prescribed]] or [loads] table in the case, "
        "--prescribed GRAIN:VX:VY[:VZ] or --set loads.compression=CX,CY[,CZ]) that moves a grain, met none: nothing is "
        "given, or all velocities given are zero, as those of loads are at the centre of mass; contacts 'all' need "
        "none");
}

std::vector<Index> grains_of_contact(const ReferenceProblem& problem, Index contact) {
  std::vector<Index> grains;
  for (SparseMatrix::InnerIterator entry(problem.h, contact); entry; ++entry) {
    const Index grain = entry.row() / problem.dofs_per_grain;
    if (grains.empty() || grains.back() != grain) grains.push_back(grain);
  }
  return grains;
}

double mean_normal_delassus(const ReferenceProblem& problem) {
  double sum = 0;
  for (Index c = 0; c < problem.h.cols(); c += problem.columns_per_contact)
    for (SparseMatrix::InnerIterator e(problem.h, c); e; ++e) sum += e.value() * e.value() / problem.inertia[e.row()];
  const Index contacts = problem.h.cols() / problem.columns_per_contact;
  return contacts == 0 ? 0 : sum / static_cast<double>(contacts);
}

SparseMatrix scaled_connectivity(const Vector& inertia, const SparseMatrix& h) {
  return inertia.cwiseSqrt().cwiseInverse().asDiagonal() * h;
}

}  // namespace nscdd
