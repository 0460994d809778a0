// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "two_stage/coarse_mesh.hpp"
#include "two_stage/linear_subdomain.hpp"

namespace nscdd {

/// When a subdomain is switched, and what contacts then are.
struct SwitchRules {
  Index after = 100;                    ///< k, iterations for which its statuses stand still
  double flexibility = 0;               ///< alpha, 1/kg, see LinearSubdomain
  std::array<Index, 2> cells{1, 1};     ///< of the mesh of a homogenised subdomain, see coarse_velocities
  std::vector<PlacedBody> bodies = {};  ///< of a subdomain that is to be homogenised; empty for a linear one
};

/// A subdomain among the others: A_E, and the interface impulses F.
struct Surroundings {
  const Interface& interface;
  Index subdomain;
  const Vector& impulses;
};

/// Stage 1 of one subdomain that may be switched. It obeys the contact law, by sweeps, until its statuses have stood
/// still for k iterations. From then on it is a LinearSubdomain, whose answer is judged in every iteration: it stands
/// if the law, at the impulses and velocities of the answer, gives every contact the status at which it was frozen. At
/// the first answer that fails, that very iteration is done by sweeps instead, and the statuses must stand still anew.
///
/// The error of the linear model is measured when it is given up and at the end of a step, against sweeps from the same
/// state: the root mean square of dV over the copies of shared grains, m/s, and |M dV| / |A_E^T F|, the same in
/// impulses.
///
/// In space a subdomain in which a contact slides with friction is not linear, as the impulse turns with the velocity:
/// it is switched only while none does. Without friction all that keep their statuses are.
template <int D>
class ModelSwitch {
 public:
  using Sweeps = std::function<SweepSums(GranularSubdomain<D>&)>;

  /// `standing`: iterations for which the statuses of the present impulses have stood still already.
  ModelSwitch(const GranularDecomposition<D>& parts, Index subdomain, const ContactLaw& law, const SwitchRules& rules,
              Index standing);

  SweepSums stage_one(GranularSubdomain<D>& subdomain, const Sweeps& sweeps, const Surroundings& around);

  /// The step so far. If the subdomain is switched, the sweeps are tried on a copy of it.
  RememberedModel report(const GranularSubdomain<D>& subdomain, const Sweeps& sweeps, const Surroundings& around) const;

 private:
  bool linear_now(const GranularSubdomain<D>& subdomain);
  void watch(const GranularSubdomain<D>& subdomain);

  ContactLaw law_;
  SwitchRules rules_;
  std::vector<ContactStatus> statuses_;  // of the present impulses
  std::optional<LinearSubdomain<D>> linear_;
  RememberedModel record_;
};

}  // namespace nscdd
