// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "two_stage/linear_subdomain.hpp"

namespace nscdd {

/// A body of a subdomain, and whether it keeps its own unknowns in a homogenised subdomain.
struct PlacedBody {
  std::array<double, 2> centre{0, 0};  ///< m
  double radius = 0;                   ///< m
  bool kept = false;
};

/// Columns that span M^1/2 times the velocities of a homogenised subdomain, in the rows of its network. Bodies that are
/// kept have three columns each. The others move with bilinear functions on a mesh of cells[0] x cells[1] equal cells
/// over the box of their centres: x, y and spin (rim / radius) are interpolated between its nodes. Of dependent
/// columns, at nodes near too few bodies, only independent ones are taken: a mesh as fine as the bodies leaves them all
/// free. `bodies`: in the order of the subdomain; those without rows are left out.
SparseMatrix coarse_velocities(const FrozenNetwork& network, const std::vector<PlacedBody>& bodies,
                               const std::array<Index, 2>& cells);

/// When a subdomain is switched, and to what.
struct SwitchRules {
  Index after = 100;                    ///< k: iterations for which its statuses stand still
  double flexibility = 0;               ///< alpha, 1/kg, see LinearSubdomain
  std::array<Index, 2> cells{1, 1};     ///< of the mesh of a homogenised subdomain, see coarse_velocities
  std::vector<PlacedBody> bodies = {};  ///< of a subdomain to homogenise; empty for a linear one
};

/// Stage 1 of one subdomain that may be switched. Sweeps solve the contact law until the statuses have stood still for
/// k iterations. From then on it is a LinearSubdomain, whose answer is checked in every iteration: it stands if the
/// law, at its impulses and velocities, gives every contact its frozen status. If the check fails, sweeps do that
/// iteration, and the statuses must stand still anew.
///
/// The error of the linear model is measured against sweeps from the same state, when it is given up and at the end of
/// a step: the root mean square of dV over the copies of shared grains, m/s, and |M dV| / |A_E^T F|.
///
/// In space a subdomain is switched only while no contact slides with friction, because that is not linear.
template <int D>
class ModelSwitch {
 public:
  using Sweeps = std::function<SweepSums(GranularSubdomain<D>&)>;

  /// For subdomain number `subdomain`. `standing`: iterations for which its statuses have stood still already.
  ModelSwitch(const GranularDecomposition<D>& parts, Index subdomain, const ContactLaw& law, const SwitchRules& rules,
              Index standing);

  SweepSums stage_one(GranularDecomposition<D>& parts, const Sweeps& sweeps, const Vector& f);

  /// The step so far. If the subdomain is switched, sweeps on a copy of it measure the error.
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
