// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/datbox_input.hpp"
#include "simulation/trajectory_step.hpp"

namespace nscdd {

/// Whether something driven by the motion turns at any time.
bool turns(const Motion& motion);

/// Steps of a run as LMGC90 has them: what it writes into its folder OUTBOX, and as DATBOX what it would begin with
/// from the first of them. Bodies are the free disks (one disk DISKx each), then the boundaries: disks as one body of
/// disks DISKb, a wall as a plank JONCx. Numbers have seven digits (D14.7).
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

  /// Why the files that follow would be those of another case; empty where they are not: a law that LMGC90 does not
  /// have by the names read here, disks of a boundary that turns while they do not, a wall that turns about a point
  /// in front of it.
  std::string without_datbox() const;
  std::string tact() const;  ///< TACT_BEHAV.DAT: one law between grains, one at boundaries, and who sees whom
  /// DRV_DOF.DAT: velocities of the boundaries by formula where they are constant, else by a table (evolution).
  std::string driven() const;
  /// These tables, by the names of their files. Behind its last row LMGC90 goes on in a straight line, so that the last
  /// two rows have one velocity.
  std::vector<std::pair<std::string, std::string>> tables() const;

 private:
  /// The body, from 1, and its contactor, from 1, that a disk or wall belongs to.
  struct Place {
    Index body = 0, contactor = 1;
  };
  void lay_planks(double size);
  std::vector<DatboxDriven> driven_bodies() const;
  Index body_of_boundary(Index boundary) const { return first_.system.free_disks() + boundary + 1; }
  std::array<double, 3> position(Index boundary, const Pose& pose) const;
  std::string contact(const TrajectoryStep& step, const TrajectoryContact& c, Index number) const;

  Simulation first_;
  std::vector<Place> places_;   // of the disks, then of the walls
  std::vector<Index> wall_of_;  // of each boundary, -1 for one of disks
  // Of each boundary, m: half the thickness and length of its plank, and how far its middle lies along the wall from
  // the point of the wall.
  std::vector<double> thickness_, half_length_, shift_;
  double density_ = 1;  // kg/m^2
  double margin_ = 1;   // m, the largest radius
};

}  // namespace nscdd
