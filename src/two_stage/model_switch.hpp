// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "two_stage/linear_subdomain.hpp"

namespace nscdd {

/// Where a body of a subdomain is, and whether it is kept as it is in a homogenised subdomain.
struct PlacedBody {
  std::array<double, 2> centre{0, 0};  ///< m
  double radius = 0;                   ///< m
  bool kept = false;
};

/// Columns that span M^1/2 times the velocities of a homogenised subdomain, in the rows of its network. Bodies that are
/// kept have three columns each. The others move with the bilinear functions of a mesh of cells[0] x cells[1] equal
/// cells over the box of their centres: x, y and spin (rim / radius) are interpolated between its nodes. Of dependent
/// columns, at nodes near too few bodies, only independent ones are taken: a mesh as fine as the bodies leaves all of
/// them free. `bodies`: in the order of the subdomain; those without rows are left out.
SparseMatrix coarse_velocities(const FrozenNetwork& network, const std::vector<PlacedBody>& bodies,
                               const std::array<Index, 2>& cells);

/// When a subdomain is switched, and what contacts then are.
struct SwitchRules {
  Index after = 100;                    ///< k, iterations for which its statuses stand still
  double flexibility = 0;               ///< alpha, 1/kg, see LinearSubdomain
  std::array<Index, 2> cells{1, 1};     ///< of the mesh of a homogenised subdomain, see coarse_velocities
  std::vector<PlacedBody> bodies = {};  ///< of a subdomain that is to be homogenised; empty for a linear one
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

  /// For subdomain number `subdomain`. `standing`: iterations for which its statuses have stood still already.
  ModelSwitch(const GranularDecomposition<D>& parts, Index subdomain, const ContactLaw& law, const SwitchRules& rules,
              Index standing);

  /// Stage 1 under the interface impulses F.
  SweepSums stage_one(GranularDecomposition<D>& parts, const Sweeps& sweeps, const Vector& f);

  /// The step so far. If the subdomain is switched, the sweeps are tried on a copy of it.
  RememberedModel report(const GranularDecomposition<D>& parts, const Sweeps& sweeps, const Vector& f) const;

 private:
  bool linear_now(const GranularSubdomain<D>& subdomain);
  void watch(const GranularSubdomain<D>& subdomain);

  Index subdomain_;
  ContactLaw law_;
  SwitchRules rules_;
  std::vector<ContactStatus> statuses_;  // of the present impulses
  std::optional<LinearSubdomain<D>> linear_;
  RememberedModel record_;
};

}  // namespace nscdd
