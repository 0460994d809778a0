// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

#include <fmt/format.h>

#include <cmath>

namespace nscdd {

ReferenceProblem assemble(const Packing& packing, const ContactNetwork& network,
                          const std::vector<PrescribedVelocity>& prescribed) {
  if (count(packing.mass) != packing.size())
    throw Error(fmt::format("assemble: expected a mass for each of {} grains, met {}", packing.size(),
                            packing.mass.size()));
  ReferenceProblem problem;
  const Index n = packing.size();
  problem.inertia.resize(2 * n);
  for (Index i = 0; i < n; ++i) problem.inertia.segment(2 * i, 2).setConstant(packing.mass[at(i)]);

  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * network.contacts.size());
  const auto put = [&](Index row, Index column, double value) {
    entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  };
  for (Index c = 0; c < network.size(); ++c) {
    const Contact& contact = network.contacts[at(c)];
    for (Index k = 0; k < 2; ++k) {
      put(2 * contact.a + k, c, -contact.normal[at(k)]);
      put(2 * contact.b + k, c, contact.normal[at(k)]);
    }
  }
  problem.h.resize(2 * n, network.size());
  problem.h.setFromTriplets(entries.begin(), entries.end());

  problem.arriving_velocity = Vector::Zero(2 * n);
  for (const PrescribedVelocity& one : prescribed) {
    if (one.grain < 0 || one.grain >= n)
      throw Error(
          fmt::format("prescribed velocity: expected a grain in 0..{}, met grain {}", n - 1, one.grain));
    if (!std::isfinite(one.velocity[0]) || !std::isfinite(one.velocity[1]))
      throw Error(fmt::format("prescribed velocity of grain {}: expected finite components, met ({}, {})",
                              one.grain, one.velocity[0], one.velocity[1]));
    problem.arriving_velocity.segment(2 * one.grain, 2) << one.velocity[0], one.velocity[1];
  }
  return problem;
}

std::vector<Index> grains_of_contact(const ReferenceProblem& problem, Index contact) {
  std::vector<Index> grains;
  for (SparseMatrix::InnerIterator entry(problem.h, contact); entry; ++entry) {
    const Index grain = entry.row() / problem.dofs_per_grain;
    if (grains.empty() || grains.back() != grain) grains.push_back(grain);
  }
  return grains;
}

SparseMatrix scaled_connectivity(const Vector& inertia, const SparseMatrix& h) {
  return inertia.cwiseSqrt().cwiseInverse().asDiagonal() * h;
}

}  // namespace nscdd
