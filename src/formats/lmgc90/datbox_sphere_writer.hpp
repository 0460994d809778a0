// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/datbox_input.hpp"
#include "simulation/trajectory_step.hpp"

namespace nscdd {

/// Steps of a run of spheres as LMGC90 has them, as DatboxWriter is for disks. Bodies RBDY3 are the free spheres, then
/// the spheres of boundaries, one SPHER each, then walls as planks PLANx. Their frames are the columns alpha, beta and
/// gamma of DOF, which turn with them; gamma of a plank is the normal of its wall. Spins V(4) to V(6) are along these
/// columns, as LMGC90 has them.
class SphereDatboxWriter {
 public:
  /// `first`: the simulation in its first state, which displacements count from. Throws Error for disks, for too many
  /// bodies, and for walls that are cylinders.
  explicit SphereDatboxWriter(const Simulation& first);

  std::string bodies() const;                         ///< BODIES.OUT
  std::string bulk() const;                           ///< BULK_BEHAV.OUT: density and gravity
  std::string dof(const TrajectoryStep& step) const;  ///< DOF.OUT.k
  /// Vloc_Rloc.OUT.k: the contacts of two spheres (SPSPx), then those with a wall (SPPLx). n goes from the antagonist
  /// to the candidate, which is the sphere of the lower number, or the sphere; s is t x n. Impulses over the step h are
  /// forces (N) on the candidate.
  std::string vloc_rloc(const TrajectoryStep& step) const;

  /// Why the files that follow would be those of another case; empty where they are not: laws as in DatboxWriter,
  /// spheres of a boundary that turns, a wall that turns about a point in front of it, or about an axis that turns.
  std::string without_datbox() const;
  std::string tact() const;                                         ///< TACT_BEHAV.DAT
  std::string driven() const;                                       ///< DRV_DOF.DAT
  std::vector<std::pair<std::string, std::string>> tables() const;  ///< its evolutions, by the names of their files

 private:
  /// A wall as a body.
  struct Plank {
    Index body = 0;
    Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< at time 0
    double thickness = 0, length = 0, width = 0;          ///< halves, m; thickness 0: none is possible
    double shift_along = 0, shift_across = 0;             ///< of its middle, from the point of the wall, m
  };
  Index count_bodies() const { return first_.system.disks() + count(planks_); }
  Eigen::Matrix3d frame_of(std::size_t wall, const Pose& pose) const;
  Eigen::Vector3d middle_of(std::size_t wall, const Pose& pose) const;
  std::string contact(const TrajectoryStep& step, const TrajectoryContact& c, Index number, bool wide) const;
  std::vector<DatboxDriven> driven_bodies() const;

  Simulation first_;
  std::vector<Index> body_;  // of every sphere, from 1
  std::vector<Plank> planks_;
  double density_ = 1;  // kg/m^3
  double margin_ = 1;   // m, the largest radius
};

}  // namespace nscdd
