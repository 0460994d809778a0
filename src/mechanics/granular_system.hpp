// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/boundary.hpp"
#include "mechanics/contact_law.hpp"
#include <nscdd/core/fields.hpp>
#include <nscdd/core/types.hpp>
#include <nscdd/packing/packing.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace nscdd {

/// Disks and walls, and what drives them. The grains of a packing come first, then the disks of boundaries.
struct GranularSystem {
  std::vector<double> radius;    ///< m
  std::vector<double> mass;      ///< kg; that of a driven disk has no effect
  std::vector<Index> driven_by;  ///< boundary that moves a disk, -1 for a free one
  std::vector<Wall> walls;
  std::vector<Boundary> boundaries;

  Index disks() const { return count(radius); }
  Index free_disks() const { return std::count(driven_by.begin(), driven_by.end(), Index{-1}); }
  bool free(Index disk) const { return driven_by[at(disk)] < 0; }
};

/// Impulse that a contact carried, with its ends: disks by their number, wall w as disks() + w; a < b.
struct RememberedImpulse {
  Index a = 0, b = 0;
  LocalVector impulse;  ///< N s
};

/// Interface impulse that held the copy of a grain in a subdomain, (A_E^T F_Gamma) of that copy, N s.
struct RememberedGluing {
  Index grain = 0, subdomain = 0;
  double x = 0, y = 0, rim = 0;
};

/// Subdomain that a contact was given at the last decomposition.
struct RememberedSubdomain {
  Index a = 0, b = 0, subdomain = 0;
};

/// Everything that changes in a run. A run that goes on from it repeats every bit.
struct GranularState {
  Index step = 0;                               ///< steps done
  double time = 0;                              ///< s
  std::vector<double> x, y, angle;              ///< of every disk, m and rad
  std::vector<double> velocity_x, velocity_y;   ///< m/s
  std::vector<double> spin;                     ///< rad/s
  std::vector<Pose> poses;                      ///< of every boundary
  std::vector<RememberedImpulse> impulses;      ///< of the last step, ascending by (a, b)
  std::vector<RememberedGluing> gluing;         ///< of the last step, ascending by (grain, subdomain)
  std::vector<RememberedSubdomain> subdomains;  ///< of the contacts of the last step, ascending by (a, b)
  Index decomposed_at = -1;                     ///< step whose contacts were partitioned afresh last
  double eta = 0;                               ///< best flexibility found at that step, 1/kg; 0 if none was asked for
};

/// The state at time 0: grains are at rest at their places in the packing, boundaries at their centres.
GranularState initial_state(const GranularSystem& system, std::vector<double> x, std::vector<double> y);

/// "disk 3", "disk 130 of boundary 'left'", or "the wall of boundary 'right'" for body disks() + its number.
std::string body_name(const GranularSystem& system, Index body);

/// Throws Error naming the disk or boundary if sizes differ, if a disk is driven by a boundary that does not
/// exist, or if no disk is free.
void check(const GranularSystem& system, const GranularState& state);

/// How bodies touch.
struct Interaction {
  Choice<LawName> law;  ///< Coulomb's by default
  double friction = 0.3, boundary_friction = -1;
  double restitution = 0, tangential_restitution = 0;
  double cohesion = 0;  ///< N
  double epsilon = 0;   ///< 1/kg

  double friction_at_boundaries() const { return boundary_friction < 0 ? friction : boundary_friction; }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("law", self.law, Field{.description = "contact law"});
    visit("friction", self.friction,
          Field{.description = "Coulomb's coefficient between grains", .minimum = 0, .maximum = 100});
    visit("boundary_friction", self.boundary_friction,
          Field{.description = "Coulomb's coefficient at boundaries; -1: as between grains",
                .minimum = 0,
                .maximum = 100,
                .also = -1});
    visit("restitution", self.restitution,
          Field{.description = "Newton's coefficient of normal restitution", .minimum = 0, .maximum = 1});
    visit("tangential_restitution", self.tangential_restitution,
          Field{.description = "coefficient of tangential restitution", .minimum = 0, .maximum = 1});
    visit("cohesion", self.cohesion,
          Field{.description = "largest pulling force of a contact that touches, law cohesive",
                .unit = "N",
                .minimum = 0,
                .maximum = 1e100});
    visit("epsilon", self.epsilon,
          Field{.description = "flexibility of law linear_viscous", .unit = "1/kg", .minimum = 0});
  }
};

/// The law with its parameters; `h`: time step, s (a cohesive force acts through its impulse).
ContactLaw contact_law(const Interaction& interaction, double h);

}  // namespace nscdd
