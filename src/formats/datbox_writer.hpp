// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/trajectory.hpp"

/// Steps of a run as LMGC90 writes them into its folder OUTBOX. Bodies are the free disks (one disk DISKx each), then
/// the boundaries: disks as one body of disks DISKb, a wall as a plank JONCx. Numbers have seven digits (D14.7).
namespace nscdd {

class DatboxWriter {
 public:
  /// `first`: the simulation in its first state, which displacements count from.
  explicit DatboxWriter(const Simulation& first);

  std::string bodies() const;  ///< BODIES.OUT
  std::string bulk() const;    ///< BULK_BEHAV.OUT: the density that goes with the radii of BODIES.OUT, and gravity
  /// DOF.OUT.k: displacements and velocities at the end of the step. A boundary has its velocity at that time.
  std::string dof(const TrajectoryStep& step) const;
  /// Vloc_Rloc.OUT.k: the contacts that led to the end of the step. n goes from the antagonist to the candidate, which
  /// is the disk of the lower number, or the disk at a wall, and t is n turned by -90 degrees. Impulses over the step h
  /// are forces (N), on the candidate. Velocities of the contact are those at the end of the step.
  std::string vloc_rloc(const TrajectoryStep& step) const;

 private:
  /// The body, from 1, and its contactor, from 1, that a disk or wall belongs to.
  struct Place {
    Index body = 0, contactor = 1;
  };
  Index body_of_boundary(Index boundary) const { return first_.system.free_disks() + boundary + 1; }
  std::array<double, 3> position(Index boundary, const Pose& pose) const;
  std::string contact(const TrajectoryStep& step, const TrajectoryContact& c, Index number) const;

  Simulation first_;
  std::vector<Place> places_;          // of the disks, then of the walls
  std::vector<Index> wall_of_;         // of each boundary, -1 for one of disks
  double density_ = 1;                 // kg/m^2
  double length_ = 1, thickness_ = 1;  // m, of planks
};

}  // namespace nscdd
