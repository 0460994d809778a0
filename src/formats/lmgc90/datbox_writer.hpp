// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/datbox_body.hpp"
#include "simulation/simulation.hpp"
#include "simulation/trajectory_step.hpp"

#include <numbers>

namespace nscdd {

inline Eigen::Vector3d datbox_vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// Steps of a run in the formats of LMGC90: its output folder OUTBOX, and the DATBOX that starts from the first step.
/// docs/formats.md describes bodies, contacts and axes.
class DatboxWriter {
 public:
  /// `first`: in its first state, the origin of displacements. Throws Error for too many bodies and full disk walls.
  explicit DatboxWriter(const Simulation& first);

  std::string bodies() const;  ///< BODIES.OUT
  std::string bulk() const;    ///< BULK_BEHAV.OUT: the density for the radii of BODIES.OUT, and gravity
  /// DOF.OUT.k: displacements and velocities at the end of the step.
  std::string dof(const TrajectoryStep& step) const;
  /// Vloc_Rloc.OUT.k: the contacts of the step, first those of two grains, then those with walls.
  std::string vloc_rloc(const TrajectoryStep& step) const;

  /// Why no DATBOX can describe this case; empty if one can. Reasons: a law that LMGC90 lacks, disks that do not turn
  /// with their boundary, spheres that do, a wall that turns about a point in front of it or about several axes, and a
  /// plank or cylinder that turns about another point than its middle.
  std::string without_datbox() const;
  std::string tact() const;  ///< TACT_BEHAV.DAT: a law between grains, one at boundaries, and who sees whom
  /// Names and texts of DRV_DOF.DAT, of driven and loaded bodies, and of the tables that it names.
  std::vector<std::pair<std::string, std::string>> driven() const;

 private:
  struct Body {
    Index boundary = -1;                // that drives it; -1: free
    std::vector<std::size_t> grains{};  // its contactors: these, then walls
    std::vector<std::size_t> walls{};

    // The wall that it is; -1: none, or several shapes.
    Index wall() const { return grains.empty() && walls.size() == 1 ? static_cast<Index>(walls[0]) : -1; }
  };
  // The number of a body and of a contactor in it, both from 1.
  struct Place {
    Index body = 0, contactor = 1;
  };
  // The names of a contactor and of its contacts with grains.
  struct WallKind {
    std::string_view contactor, contact;
  };
  // A wall as a body, m. A cylinder has half its length, and a node that is shifted along its axis.
  struct Plank {
    Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  // at time 0, in space
    double thickness = 0, length = 0, width = 0;          // halves; thickness 0: no plank is possible
    double shift_along = 0, shift_across = 0;             // of its middle, from the point of the wall
  };
  struct Node {
    Eigen::Vector3d place;
    Eigen::Matrix3d frame;
    double angle = 0;  // of the axes, rad, in the plane
  };
  // A driven body with times (s) and velocities, or forces, of its degrees of freedom that have some; at rest no times.
  struct Driven {
    Index body = 0;
    const char* kind = "vlocy";
    std::vector<double> time;
    std::vector<std::vector<double>> velocity;
    std::vector<std::vector<std::array<double, 5>>> oscillations{};  // AMP, OMEGA, PHI, RAMPI and RAMP of each
  };

  void number_bodies();
  WallKind wall_kind(std::size_t wall) const;
  std::vector<WallKind> wall_kinds() const;  // that there are
  void lay_plank(std::size_t wall, double beyond);
  static Eigen::Vector3d centre(const GranularState& state, std::size_t grain) {
    return datbox_vector(centre_of(state, grain));
  }
  Node plank_node(std::size_t wall, const Pose& pose) const;
  Node node_of(const Body& body, const GranularState& state) const;
  std::vector<DatboxContactor> contactors_of(const Body& body, const Node& node) const;
  std::string contactor_lines(const Body& body, const Node& node) const;
  const char* colour_of(const Body& body) const;
  const FreeBody* free_body(const Body& body) const;  // null: none of its directions is free
  /// Of a body in space in its first state, along the axes of a frame, kg m^2.
  Eigen::Matrix3d inertia_in(const FreeBody& free, const Body& body, const Eigen::Matrix3d& frame) const;
  std::string without_free(const Body& body) const;  // why a free body in space cannot be written; or empty
  std::string node_text(const char* names, const Eigen::Vector3d& place, double angle) const;
  std::string disk_contact(const TrajectoryStep& step, const TrajectoryContact& c, WallKind kind, Index number) const;
  std::string sphere_contact(const TrajectoryStep& step, const TrajectoryContact& c, WallKind kind, Index number,
                             bool wide) const;
  std::vector<Driven> driven_bodies() const;
  const char* kind() const { return space_ ? "RBDY3" : "RBDY2"; }

  Simulation first_;
  bool space_;
  std::vector<Body> bodies_;
  std::vector<Place> places_;  // of the grains, then of the walls
  std::vector<Plank> planks_;  // of the walls
  double density_ = 1;         // kg/m^2, in space kg/m^3
  double margin_ = 0;          // m, the largest radius
};

/// A number as D14.7 of Fortran: 0.1234567D+01, after its sign or a blank.
std::string datbox_number(double value);

/// Numbers with names of five letters, such as "byrd=", each after two blanks.
using DatboxNumbers = std::initializer_list<std::pair<std::string_view, double>>;
std::string datbox_named(DatboxNumbers values);
/// The same as a line, after 27 columns.
std::string datbox_line(DatboxNumbers values);

inline double datbox_volume(double radius) { return 4.0 / 3 * std::numbers::pi * radius * radius * radius; }

/// Such a line of three numbers with numbered names such as "coo{}=".
std::string datbox_three(const char* names, const Eigen::Vector3d& values, int first = 1);

/// The head of a file of a step, and the line that ends a head or a list.
std::string datbox_head(const char* title, Index step, double time);
inline constexpr const char* datbox_ruler =
    "!-----------------------------------------------------------------------\n";

/// Colours of grains and other bodies that are free, of boundaries, and of those that are free along some directions;
/// and laws of the first, and of all others.
inline constexpr const char *datbox_grains = "GRAIN", *datbox_boundaries = "BOUND", *datbox_half_free = "HALFx";
inline constexpr const char *datbox_law_of_grains = "CLB_G", *datbox_law_of_boundaries = "CLB_B";

inline Eigen::Vector3d spin_vector(const RigidVelocity& v) { return {v.spin_x, v.spin_y, v.spin}; }

}  // namespace nscdd
