// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/linear_subdomain.hpp"

#include "linalg/sparse_entries.hpp"

namespace nscdd {
namespace {

// Contact k of a subdomain frozen at a status, for small changes of its impulse and velocity. The plane needs only the
// status. In space a sliding contact has the direction d and the `turning` of a FrozenContact at z = r - W^-1
// (v + bias), the impulse that would stop it (docs/theory.md, section 9).
template <int D>
FrozenContact<D> frozen_as(ContactStatus status, const GranularSubdomain<D>& subdomain, std::size_t k) {
  const GrainContact<D> contact = subdomain.contact(k);
  FrozenContact<D> result{.status = status};
  if constexpr (D == 2) {
    result.slope = sliding_slope(status, contact.friction);
  } else if (slides(status)) {
    const LocalVector<3> z = stopping_impulse<3>(contact, subdomain.velocities);
    if (const double size = norm(z.t); size > 0) {
      result.slope = (contact.friction / size) * z.t;
      result.turning = std::clamp(contact.friction * (z.n + contact.pull) / size, 0.0, 1.0);
    }
  }
  return result;
}

// Columns of a contact in G and in N.
template <int D>
Index directions(ContactStatus status) {
  return status == ContactStatus::open ? 0 : status == ContactStatus::stick ? D : 1;
}

}  // namespace

template <int D>
std::vector<FrozenContact<D>> frozen_contacts(const GranularDecomposition<D>& parts,
                                              const std::vector<ContactStatus>& statuses) {
  std::vector<FrozenContact<D>> result(statuses.size());
  for (const GranularSubdomain<D>& subdomain : parts.subdomains)
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
      result[at(subdomain.numbers[k])] = frozen_as(statuses[at(subdomain.numbers[k])], subdomain, k);
  return result;
}

TangentVector side_of(const FrozenContact<3>& contact) {
  const double size = norm(contact.slope);
  return {-contact.slope.second / size, contact.slope.first / size};
}

template <int D>
FrozenNetwork frozen_network(const GranularSubdomain<D>& subdomain, const std::vector<FrozenContact<D>>& frozen) {
  FrozenNetwork network;
  std::vector<double> root, flexibility;
  for (const GrainVelocity<D>& v : subdomain.velocities) {
    network.rows.push_back({v.inverse_mass > 0 ? count(root) : -1});
    if (v.inverse_mass == 0) continue;
    const double of_body = std::sqrt(1 / v.inverse_mass), of_rim = of_body / std::sqrt(rim_mass_ratio<D>);
    for (Index k = 0; k < unknowns_of_grain<D>; ++k) root.push_back(k < D ? of_body : of_rim);
  }
  network.root = Vector::Map(root.data(), count(root));
  const Index size = network.root.size();
  ConnectivityBuilder<D> impulses(size, D * frozen.size()), resting(size, D * frozen.size());
  for (std::size_t k = 0; k < frozen.size(); ++k) {
    const FrozenContact<D>& now = frozen[k];
    if (now.status == ContactStatus::open) continue;
    const GrainContact<D> c = subdomain.contact(k);
    const auto put = [&](LocalVector<D> impulse, LocalVector<D> rest, double flexible = 0) {
      const auto add = [&](ConnectivityBuilder<D>& columns, const LocalVector<D>& direction) {
        columns.add(c.normal, network.rows[at(c.a)], network.rows[at(c.b)], direction, c.levers.get());
      };
      add(impulses, impulse);
      add(resting, rest);
      flexibility.push_back(flexible);
    };
    if (now.status == ContactStatus::stick) {
      for (const LocalVector<D>& direction : contact_directions<D>()) put(direction, direction);
      continue;
    }
    put({1, now.slope}, {1, {}});
    if constexpr (D == 3)
      if (now.turning > 0) {  // the same factor on both keeps fast sliding contacts of size 1
        network.turning.push_back(count(flexibility));
        const LocalVector<3> side{0, std::sqrt(now.turning) * side_of(now)};
        if (c.levers) throw Error("frozen contacts: expected grains, met a body of another shape that slides in space");
        put(side, side, (1 - now.turning) / c.inverse_w().inverse_t);
      }
  }
  network.impulses = over_rows(impulses.matrix(), network.root);
  network.resting = over_rows(resting.matrix(), network.root);
  network.flexibility = Vector::Map(flexibility.data(), count(flexibility));
  return network;
}

template <int D>
LinearSubdomain<D>::LinearSubdomain(const GranularSubdomain<D>& subdomain, const ContactLaw& law,
                                    const std::vector<ContactStatus>& statuses, double flexibility,
                                    const Fields& fields)
    : law_(law),
      contacts_(subdomain.contacts),
      base_(subdomain.velocities),
      present_(subdomain.velocities),
      flexibility_(flexibility) {
  for (std::size_t k = 0; k < statuses.size(); ++k) frozen_.push_back(frozen_as(statuses[k], subdomain, k));
  network_ = frozen_network(subdomain, frozen_);
  if (!network_.turning.empty())
    throw Error("linear subdomain: expected contacts whose impulses do not turn, met one that slides in space");
  if (fields) fields_ = fields(network_);
  // Impulses of the last step are kept along x, y and z. If a normal has turned, the impulse of a contact that slides
  // without friction has a tangential part, which a sweep would remove.
  if constexpr (D == 3)
    for (std::size_t k = 0; k < frozen_.size(); ++k) {
      if (!slides(frozen_[k].status)) continue;
      const GrainContact<D> c = contacts_.contact(k, base_);
      const LocalVector<D> r{c.impulse.n, (c.impulse.n + c.pull) * frozen_[k].slope};
      apply_impulse(c, r - c.impulse, base_);
      contacts_.impulses[k] = swept(c.normal, r);
    }
  if (network_.impulses.cols() == 0) return;
  matrix_ = diagonal_matrix(Vector::Constant(network_.root.size(), flexibility_)) +
            SparseMatrix(network_.impulses * SparseMatrix(network_.resting.transpose()));
  if (fields_) matrix_ = SparseMatrix(fields_->transpose()) * matrix_ * *fields_;
  solver_.emplace(matrix_);
  regular_ = solver_->factorise(matrix_);
}

// v + bias in the resting directions.
template <int D>
Vector LinearSubdomain<D>::strain(const std::vector<GrainVelocity<D>>& velocities) const {
  Vector result(network_.resting.cols());
  Index column = 0;
  for (std::size_t k = 0; k < frozen_.size(); ++k) {
    const Index size = directions<D>(frozen_[k].status);
    if (size == 0) continue;
    const GrainContact<D> c = contacts_.contact(k, velocities);
    const std::array<double, D> v = along_directions(relative_velocity<D>(c, velocities) + c.bias);
    for (Index i = 0; i < size; ++i) result[column++] = v[at(i)];
  }
  return result;
}

// Adds the changes by Stage 2.
template <int D>
void LinearSubdomain<D>::follow(const GranularSubdomain<D>& subdomain) {
  for (std::size_t i = 0; i < base_.size(); ++i) {
    const GrainUnknowns<D> now = unknowns(subdomain.velocities[i]), before = unknowns(present_[i]);
    add(base_[i], [&](std::size_t k) { return now[k] - before[k]; });
  }
  present_ = subdomain.velocities;
}

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
    if (fields_) {
      const Vector moved = change.cwiseQuotient(network_.root);
      for (std::size_t i = 0; i < base_.size(); ++i)
        if (const Index first = network_.rows[i].first; first >= 0)
          add(result.velocities[i], [&](std::size_t k) { return moved[first + static_cast<Index>(k)]; });
    }
    d = (here + network_.resting.transpose() * change) / -flexibility_;
  }
  Index column = 0;
  for (std::size_t k = 0; k < frozen_.size(); ++k) {
    const Index size = directions<D>(frozen_[k].status);
    if (size == 0) continue;
    std::array<double, D> change{};
    for (Index i = 0; i < size; ++i) change[at(i)] = d[column++];
    const GrainContact<D> c = contacts_.contact(k, base_);
    LocalVector<D> r = c.impulse + from_directions<D>(change.data());
    // On the edge of the cone to the last bit, so that rounding does not make the contact stick.
    if (frozen_[k].status != ContactStatus::stick) r.t = (r.n + c.pull) * frozen_[k].slope;
    result.impulses[k] = swept(c.normal, r);
    if (!fields_) apply_impulse(c, r - c.impulse, result.velocities);
  }
  result.admissible = admits(result);
  return result;
}

template <int D>
bool LinearSubdomain<D>::admits(const LinearAnswer<D>& answer) const {
  for (std::size_t k = 0; k < frozen_.size(); ++k) {
    GrainContact<D> c = contacts_.contact(k, answer.velocities);
    c.impulse = in_frame(c.normal, answer.impulses[k]);
    const LocalVector<D> stop = stopping_impulse<D>(c, answer.velocities);
    c.impulse = with_delassus(c, [&](const auto& w) { return law_impulse(law_, c, stop, w); });
    if (status_of(law_, c) != frozen_[k].status) return false;
  }
  return true;
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

template std::vector<FrozenContact<2>> frozen_contacts(const GranularDecomposition<2>&,
                                                       const std::vector<ContactStatus>&);
template std::vector<FrozenContact<3>> frozen_contacts(const GranularDecomposition<3>&,
                                                       const std::vector<ContactStatus>&);
template FrozenNetwork frozen_network(const GranularSubdomain<2>&, const std::vector<FrozenContact<2>>&);
template FrozenNetwork frozen_network(const GranularSubdomain<3>&, const std::vector<FrozenContact<3>>&);
template class LinearSubdomain<2>;
template class LinearSubdomain<3>;

}  // namespace nscdd
