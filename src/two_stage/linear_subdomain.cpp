// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/linear_subdomain.hpp"

namespace nscdd {
namespace {

template <int D>
std::vector<FrozenContact<D>> frozen_at(const GranularSubdomain<D>& subdomain,
                                        const std::vector<ContactStatus>& statuses) {
  std::vector<FrozenContact<D>> frozen;
  for (std::size_t k = 0; k < statuses.size(); ++k) frozen.push_back(frozen_as(statuses[k], subdomain, k));
  return frozen;
}

// v += a - b
template <int D>
void add_difference(GrainVelocity<D>& v, const GrainVelocity<D>& a, const GrainVelocity<D>& b) {
  GrainUnknowns<D> sum = unknowns(v);
  const GrainUnknowns<D> plus = unknowns(a), minus = unknowns(b);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += plus[k] - minus[k];
  v = with_unknowns(sum, v.inverse_mass);
}

// The next components of a tangential vector, which move `column` on.
template <int D>
Tangent<D> next_tangent(const Vector& d, Index& column) {
  if constexpr (D == 2) {
    return d[column++];
  } else {
    column += 2;
    return {d[column - 2], d[column - 1]};
  }
}

void put_tangent(Vector& d, Index& column, double t) { d[column++] = t; }
void put_tangent(Vector& d, Index& column, TangentVector t) {
  d[column++] = t.first;
  d[column++] = t.second;
}

}  // namespace

template <int D>
LinearSubdomain<D>::LinearSubdomain(const GranularSubdomain<D>& subdomain, const ContactLaw& law,
                                    std::vector<ContactStatus> statuses, double flexibility, const Fields& fields)
    : law_(law),
      frozen_(frozen_at(subdomain, statuses)),
      contacts_(subdomain.contacts),
      base_(subdomain.velocities),
      present_(subdomain.velocities),
      flexibility_(flexibility),
      network_(frozen_network(subdomain, frozen_)) {
  if (!network_.turning.empty())
    throw Error("linear subdomain: expected contacts whose impulses do not turn, met one that slides in space");
  if (fields) fields_ = fields(network_);
  // Impulses of the step before are kept along x, y and z: where a normal has turned, one that slides without friction
  // has a part beside it. That is taken away before the model begins, as a sweep would.
  if constexpr (D == 3)
    for (std::size_t k = 0; k < frozen_.size(); ++k) {
      if (!slides(frozen_[k].status)) continue;
      const GrainContact<D> c = contacts_.contact(k, base_);
      const LocalVector<D> r{c.impulse.n, (c.impulse.n + c.pull) * frozen_[k].slope};
      apply_impulse(c, r - c.impulse, base_);
      contacts_.impulses[k] = swept(c.normal, r);
    }
  factorise();
}

template <int D>
void LinearSubdomain<D>::factorise() {
  if (network_.impulses.cols() == 0) return;
  matrix_.resize(network_.root.size(), network_.root.size());
  matrix_.setIdentity();
  matrix_ = flexibility_ * matrix_ + SparseMatrix(network_.impulses * SparseMatrix(network_.resting.transpose()));
  if (fields_) matrix_ = SparseMatrix(fields_->transpose()) * matrix_ * *fields_;
  solver_.emplace(matrix_);
  regular_ = solver_->factorise(matrix_);
}

// v + bias in the directions that rest.
template <int D>
Vector LinearSubdomain<D>::strain(const std::vector<GrainVelocity<D>>& velocities) const {
  Vector result(network_.resting.cols());
  Index column = 0;
  for (std::size_t k = 0; k < frozen_.size(); ++k) {
    if (frozen_[k].status == ContactStatus::open) continue;
    const GrainContact<D> c = contacts_.contact(k, velocities);
    const LocalVector<D> v = relative_velocity<D>(c, velocities) + c.bias;
    result[column++] = v.n;
    if (frozen_[k].status == ContactStatus::stick) put_tangent(result, column, v.t);
  }
  return result;
}

// What Stage 2 has done since.
template <int D>
void LinearSubdomain<D>::follow(const GranularSubdomain<D>& subdomain) {
  for (std::size_t i = 0; i < base_.size(); ++i) add_difference(base_[i], subdomain.velocities[i], present_[i]);
  present_ = subdomain.velocities;
}

// With one step of iterative refinement.
template <int D>
Vector LinearSubdomain<D>::solve(const Vector& b) const {
  const Vector x = solver_->solve(b);
  return x + solver_->solve(b - matrix_ * x);
}

template <int D>
LinearAnswer<D> LinearSubdomain<D>::answer(const GranularSubdomain<D>& subdomain) {
  follow(subdomain);
  LinearAnswer<D> result{contacts_.impulses, base_};
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
  for (std::size_t k = 0; k < frozen_.size(); ++k) {
    if (frozen_[k].status == ContactStatus::open) continue;
    const GrainContact<D> c = contacts_.contact(k, base_);
    LocalVector<D> r = c.impulse;
    r.n += d[column++];
    // On the edge of the cone to the last bit, so that rounding does not make the contact stick.
    r.t = frozen_[k].status == ContactStatus::stick ? r.t + next_tangent<D>(d, column)
                                                    : (r.n + c.pull) * frozen_[k].slope;
    result.impulses[k] = swept(c.normal, r);
    if (!fields_) apply_impulse(c, r - c.impulse, result.velocities);
  }
  result.admissible = admits(result);
  return result;
}

template <int D>
bool LinearSubdomain<D>::admits(const LinearAnswer<D>& answer) const {
  const auto impulse = [&](const GrainContact<D>& c) {
    const LocalVector<D> stop = stopping_impulse<D>(c, answer.velocities);
    return std::visit([&](const auto& law) { return law_at(law, c.pull).impulse(stop, c.inverse_w, c.friction); },
                      law_);
  };
  for (std::size_t k = 0; k < frozen_.size(); ++k) {
    GrainContact<D> c = contacts_.contact(k, answer.velocities);
    c.impulse = in_frame(c.normal, answer.impulses[k]);
    c.impulse = impulse(c);
    if (status_of(law_, c) != frozen_[k].status) return false;
  }
  return true;
}

template <int D>
void LinearSubdomain<D>::move(std::vector<GrainVelocity<D>>& velocities, const Vector& change) const {
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const Index first = network_.rows[i].first;
    if (first < 0) continue;
    GrainUnknowns<D> moved = unknowns(velocities[i]);
    for (Index k = 0; k < unknowns_of_grain<D>; ++k) moved[at(k)] += change[first + k];
    velocities[i] = with_unknowns(moved, velocities[i].inverse_mass);
  }
}

template <int D>
void LinearSubdomain<D>::release(GranularSubdomain<D>& subdomain) {
  if (!fields_) return;
  follow(subdomain);
  subdomain.velocities = base_;
  for (std::size_t k = 0; k < frozen_.size(); ++k) {
    const GrainContact<D> c = contacts_.contact(k, base_);
    apply_impulse(c, subdomain.contacts.impulse(k) - c.impulse, subdomain.velocities);
  }
}

template <int D>
SweepSums LinearSubdomain<D>::take(LinearAnswer<D> answer, GranularSubdomain<D>& subdomain) {
  SweepSums sums;
  for (std::size_t k = 0; k < frozen_.size(); ++k) {
    sums.change += squared(answer.impulses[k] - subdomain.contacts.impulses[k]);
    sums.impulses += squared(answer.impulses[k]);
  }
  subdomain.contacts.impulses = std::move(answer.impulses);
  subdomain.velocities = present_ = std::move(answer.velocities);
  return sums;
}

template class LinearSubdomain<2>;
template class LinearSubdomain<3>;

}  // namespace nscdd
