// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/model_switch.hpp"

namespace nscdd {
namespace {

template <int D>
std::vector<ContactStatus> statuses_of(const ContactLaw& law, const GranularSubdomain<D>& subdomain) {
  std::vector<ContactStatus> statuses;
  statuses.reserve(subdomain.contacts.size());
  for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
    statuses.push_back(status_of(law, subdomain.contacts.contact(k, subdomain.velocities)));
  return statuses;
}

// Whether impulses turn with the velocities: those of contacts that slide with friction in space.
template <int D>
bool turns(const GranularSubdomain<D>& subdomain, const std::vector<ContactStatus>& statuses) {
  for (std::size_t k = 0; D == 3 && k < statuses.size(); ++k)
    if (slides(statuses[k]) && subdomain.contacts.contact(k, subdomain.velocities).friction > 0) return true;
  return false;
}

// Keeps the larger distances between the velocities of a model and those of the law on the copies of shared grains.
template <int D>
void compare(RememberedModel& record, const std::vector<GrainVelocity<D>>& model,
             const std::vector<GrainVelocity<D>>& law, const Surroundings& around) {
  constexpr Index size = unknowns_of_grain<D>;
  const Vector gluing = around.interface.distribute(around.subdomain, around.impulses);
  double gap = 0, impulse = 0, whole = 0, momenta = 0;  // squared
  Index before = -1, copies = 0;
  std::vector<Index> shared;
  for (const Tie& tie : around.interface.ties(around.subdomain)) shared.push_back(tie.grain);
  std::ranges::sort(shared);
  for (const Index grain : shared) {
    if (grain == std::exchange(before, grain)) continue;
    const GrainUnknowns<D> a = unknowns(model[at(grain)]), b = unknowns(law[at(grain)]);
    const double mass = 1 / law[at(grain)].inverse_mass;
    double apart = 0, pushed = 0;
    for (Index k = 0; k < size; ++k) {
      const double change = a[at(k)] - b[at(k)];
      apart += change * change;
      pushed += k < D ? change * change : change * change / (rim_mass_ratio<D> * rim_mass_ratio<D>);
    }
    gap += apart;
    ++copies;
    impulse += mass * mass * pushed;
    momenta += mass * mass * (squared_velocity(law[at(grain)]) + squared_rim(law[at(grain)]));
    whole += gluing.segment<size>(size * grain).squaredNorm();
  }
  const auto keep_larger = [](double& kept, double part, double of) {
    if (part > 0) kept = std::max(kept, std::sqrt(part / of));
  };
  keep_larger(record.velocity_distance, gap, static_cast<double>(copies));
  keep_larger(record.impulse_distance, impulse, std::max(whole, ImpulseScale::squared_rounding * momenta));
}

}  // namespace

template <int D>
ModelSwitch<D>::ModelSwitch(const GranularDecomposition<D>& parts, Index subdomain, const ContactLaw& law,
                            const SwitchRules& rules, Index standing)
    : law_(law),
      rules_(rules),
      statuses_(statuses_of(law, parts.subdomains[at(subdomain)])),
      record_{.standing = standing} {}

template <int D>
bool ModelSwitch<D>::linear_now(const GranularSubdomain<D>& subdomain) {
  if (linear_ || record_.standing < rules_.after) return linear_.has_value();
  if (turns(subdomain, statuses_)) return false;
  if (rules_.bodies.empty())
    linear_.emplace(subdomain, law_, statuses_, rules_.flexibility);
  else
    linear_.emplace(subdomain, law_, statuses_, rules_.flexibility, [&](const FrozenNetwork& network) {
      return coarse_velocities(network, rules_.bodies, rules_.cells);
    });
  if (linear_->regular()) return true;
  linear_.reset();
  record_.standing = 0;
  return false;
}

template <int D>
void ModelSwitch<D>::watch(const GranularSubdomain<D>& subdomain) {
  std::vector<ContactStatus> now = statuses_of(law_, subdomain);
  record_.standing = now == statuses_ ? record_.standing + 1 : 0;
  statuses_ = std::move(now);
}

template <int D>
SweepSums ModelSwitch<D>::stage_one(GranularSubdomain<D>& subdomain, const Sweeps& sweeps, const Surroundings& around) {
  if (!linear_now(subdomain)) {
    const SweepSums sums = sweeps(subdomain);
    watch(subdomain);
    return sums;
  }
  LinearAnswer<D> answer = linear_->answer(subdomain);
  if (answer.admissible) {
    ++record_.standing;
    ++record_.switched_iterations;
    return linear_->take(std::move(answer), subdomain);
  }
  linear_->release(subdomain);
  linear_.reset();
  ++record_.switch_backs;
  const SweepSums sums = sweeps(subdomain);
  compare(record_, answer.velocities, subdomain.velocities, around);
  watch(subdomain);
  record_.standing = 0;
  return sums;
}

template <int D>
RememberedModel ModelSwitch<D>::report(const GranularSubdomain<D>& subdomain, const Sweeps& sweeps,
                                       const Surroundings& around) const {
  RememberedModel record = record_;
  record.switched = linear_.has_value();
  if (!linear_) return record;
  GranularSubdomain<D> copy = subdomain;
  LinearSubdomain<D>(*linear_).release(copy);
  sweeps(copy);
  compare(record, subdomain.velocities, copy.velocities, around);
  return record;
}

template class ModelSwitch<2>;
template class ModelSwitch<3>;

}  // namespace nscdd
