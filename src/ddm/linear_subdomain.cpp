// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/linear_subdomain.hpp"

namespace nscdd {
namespace {

std::vector<FrozenContact<2>> frozen_at(const GranularSubdomain<2>& subdomain,
                                        const std::vector<ContactStatus>& statuses) {
  std::vector<FrozenContact<2>> frozen;
  for (std::size_t k = 0; k < statuses.size(); ++k)
    frozen.push_back(
        frozen_as<2>(statuses[k], subdomain.contacts.contact(k, subdomain.velocities), subdomain.velocities));
  return frozen;
}

}  // namespace

LinearSubdomain::LinearSubdomain(const GranularSubdomain<2>& subdomain, const ContactLaw& law,
                                 std::vector<ContactStatus> statuses, double flexibility, const Fields& fields)
    : law_(law),
      statuses_(std::move(statuses)),
      contacts_(subdomain.contacts),
      base_(subdomain.velocities),
      present_(subdomain.velocities),
      flexibility_(flexibility),
      network_(frozen_network(subdomain, frozen_at(subdomain, statuses_))) {
  if (fields) fields_ = fields(network_);
  factorise();
}

void LinearSubdomain::factorise() {
  if (network_.impulses.cols() == 0) return;
  matrix_.resize(network_.root.size(), network_.root.size());
  matrix_.setIdentity();
  matrix_ = flexibility_ * matrix_ + SparseMatrix(network_.impulses * SparseMatrix(network_.resting.transpose()));
  if (fields_) matrix_ = SparseMatrix(fields_->transpose()) * matrix_ * *fields_;
  solver_.emplace(matrix_);
  regular_ = solver_->factorise(matrix_);
}

// v + bias in the directions that rest.
Vector LinearSubdomain::strain(const std::vector<GrainVelocity<2>>& velocities) const {
  Vector result(network_.resting.cols());
  Index column = 0;
  for (std::size_t k = 0; k < statuses_.size(); ++k) {
    if (statuses_[k] == ContactStatus::open) continue;
    const GrainContact<2> c = contacts_.contact(k, velocities);
    const LocalVector<2> v = relative_velocity(c, velocities) + c.bias;
    result[column++] = v.n;
    if (statuses_[k] == ContactStatus::stick) result[column++] = v.t;
  }
  return result;
}

// What Stage 2 has done since.
void LinearSubdomain::follow(const GranularSubdomain<2>& subdomain) {
  for (std::size_t i = 0; i < base_.size(); ++i) {
    base_[i].x += subdomain.velocities[i].x - present_[i].x;
    base_[i].y += subdomain.velocities[i].y - present_[i].y;
    base_[i].rim += subdomain.velocities[i].rim - present_[i].rim;
  }
  present_ = subdomain.velocities;
}

// With one step of iterative refinement.
Vector LinearSubdomain::solve(const Vector& b) const {
  const Vector x = solver_->solve(b);
  return x + solver_->solve(b - matrix_ * x);
}

LinearAnswer LinearSubdomain::answer(const GranularSubdomain<2>& subdomain) {
  follow(subdomain);
  LinearAnswer result{contacts_.impulses, base_};
  Vector d;
  if (solver_) {
    const Vector here = strain(base_);
    const Vector load = network_.impulses * -here;
    const Vector change =  // of M^1/2 V
        fields_ ? Vector(*fields_ * solve(fields_->transpose() * load)) : solve(load);
    if (fields_) move(result.velocities, change.cwiseQuotient(network_.root));
    d = (here + network_.resting.transpose() * change) / -flexibility_;
  }
  Index column = 0;
  for (std::size_t k = 0; k < statuses_.size(); ++k) {
    if (statuses_[k] == ContactStatus::open) continue;
    const GrainContact<2> c = contacts_.contact(k, base_);
    LocalVector<2>& r = result.impulses[k];
    r.n += d[column++];
    // On the edge of the cone to the last bit, so that rounding does not make the contact stick.
    r.t = statuses_[k] == ContactStatus::stick ? r.t + d[column++]
                                               : sliding_slope(statuses_[k], c.friction) * (r.n + c.pull);
    if (!fields_) apply_impulse(c, r - c.impulse, result.velocities);
  }
  result.admissible = admits(result);
  return result;
}

bool LinearSubdomain::admits(const LinearAnswer& answer) const {
  const auto impulse = [&](const GrainContact<2>& c) {
    const LocalVector<2> stop = stopping_impulse(c, answer.velocities);
    return std::visit([&](const auto& law) { return law_at(law, c.pull).impulse(stop, c.inverse_w, c.friction); },
                      law_);
  };
  for (std::size_t k = 0; k < statuses_.size(); ++k) {
    GrainContact<2> c = contacts_.contact(k, answer.velocities);
    c.impulse = answer.impulses[k];
    c.impulse = impulse(c);
    if (status_of(law_, c) != statuses_[k]) return false;
  }
  return true;
}

void LinearSubdomain::move(std::vector<GrainVelocity<2>>& velocities, const Vector& change) const {
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const Index first = network_.rows[i].first;
    if (first < 0) continue;
    velocities[i].x += change[first];
    velocities[i].y += change[first + 1];
    velocities[i].rim += change[first + 2];
  }
}

void LinearSubdomain::release(GranularSubdomain<2>& subdomain) {
  if (!fields_) return;
  follow(subdomain);
  subdomain.velocities = base_;
  for (std::size_t k = 0; k < statuses_.size(); ++k) {
    const GrainContact<2> c = contacts_.contact(k, base_);
    apply_impulse(c, subdomain.contacts.impulses[k] - c.impulse, subdomain.velocities);
  }
}

SweepSums LinearSubdomain::take(LinearAnswer answer, GranularSubdomain<2>& subdomain) {
  SweepSums sums;
  for (std::size_t k = 0; k < statuses_.size(); ++k) {
    sums.change += squared(answer.impulses[k] - subdomain.contacts.impulses[k]);
    sums.impulses += squared(answer.impulses[k]);
  }
  subdomain.contacts.impulses = std::move(answer.impulses);
  subdomain.velocities = present_ = std::move(answer.velocities);
  return sums;
}

}  // namespace nscdd
