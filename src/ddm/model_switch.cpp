// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/model_switch.hpp"

namespace nscdd {
namespace {

std::vector<ContactStatus> statuses_of(const ContactLaw& law, const GranularSubdomain<2>& subdomain) {
  std::vector<ContactStatus> statuses;
  statuses.reserve(subdomain.contacts.size());
  for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
    statuses.push_back(status_of(law, subdomain.contacts.contact(k, subdomain.velocities)));
  return statuses;
}

// Keeps the larger distances between the velocities of a model and those of the law on the copies of shared grains.
void compare(RememberedModel& record, const std::vector<GrainVelocity<2>>& model,
             const std::vector<GrainVelocity<2>>& law, const Surroundings& around) {
  const Vector gluing = around.interface.distribute(around.subdomain, around.impulses);
  double gap = 0, impulse = 0, whole = 0;  // squared
  Index before = -1, copies = 0;
  std::vector<Index> shared;
  for (const Tie& tie : around.interface.ties(around.subdomain)) shared.push_back(tie.grain);
  std::ranges::sort(shared);
  for (const Index grain : shared) {
    if (grain == std::exchange(before, grain)) continue;
    const GrainVelocity<2>&a = model[at(grain)], &b = law[at(grain)];
    const double x = a.x - b.x, y = a.y - b.y, rim = a.rim - b.rim, mass = 1 / b.inverse_mass;
    gap += x * x + y * y + rim * rim;
    ++copies;
    impulse += mass * mass * (x * x + y * y + rim * rim / (rim_mass_ratio<2> * rim_mass_ratio<2>));
    whole += gluing.segment<3>(3 * grain).squaredNorm();
  }
  const auto keep_larger = [](double& kept, double part, double of) {
    if (part > 0) kept = std::max(kept, std::sqrt(part / of));
  };
  keep_larger(record.velocity_distance, gap, static_cast<double>(copies));
  keep_larger(record.impulse_distance, impulse, whole);
}

}  // namespace

ModelSwitch::ModelSwitch(const GranularDecomposition<2>& parts, Index subdomain, const ContactLaw& law,
                         const SwitchRules& rules, Index standing)
    : law_(law),
      rules_(rules),
      statuses_(statuses_of(law, parts.subdomains[at(subdomain)])),
      record_{.standing = standing} {}

bool ModelSwitch::linear_now(const GranularSubdomain<2>& subdomain) {
  if (linear_ || record_.standing < rules_.after) return linear_.has_value();
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

void ModelSwitch::watch(const GranularSubdomain<2>& subdomain) {
  std::vector<ContactStatus> now = statuses_of(law_, subdomain);
  record_.standing = now == statuses_ ? record_.standing + 1 : 0;
  statuses_ = std::move(now);
}

SweepSums ModelSwitch::stage_one(GranularSubdomain<2>& subdomain, const Sweeps& sweeps, const Surroundings& around) {
  if (!linear_now(subdomain)) {
    const SweepSums sums = sweeps(subdomain);
    watch(subdomain);
    return sums;
  }
  LinearAnswer answer = linear_->answer(subdomain);
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

RememberedModel ModelSwitch::report(const GranularSubdomain<2>& subdomain, const Sweeps& sweeps,
                                    const Surroundings& around) const {
  RememberedModel record = record_;
  record.switched = linear_.has_value();
  if (!linear_) return record;
  GranularSubdomain<2> copy = subdomain;
  LinearSubdomain(*linear_).release(copy);
  sweeps(copy);
  compare(record, subdomain.velocities, copy.velocities, around);
  return record;
}

}  // namespace nscdd
