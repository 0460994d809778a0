// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// A load on a whole packing: every grain arrives with the velocity of a homogeneous deformation about the mass centre,
///     V^-_i = D (x_i - x_c),   D = [ -compression_x  shear ; shear  -compression_y ],  1/s,
/// in space with a third row and column (0, 0, -compression_z): shear stays in the planes z = const. The net momentum
/// is 0. Symmetric D is general: without walls rotations and uniform velocities or accelerations change no gap.
struct Loads {
  Components<double> compression;  ///< along x and y, in space along z too
  double shear = 0;

  bool compress() const { return !(compression[0] == 0 && compression[1] == 0 && compression[2] == 0); }
  bool none() const { return !compress() && shear == 0; }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("compression", self.compression,
          Field{.description = "rates of compression along x and y, in space z too, of the arriving velocities",
                .unit = "1/s"});
    visit("shear", self.shear, Field{.description = "rate of shear of the arriving velocities", .unit = "1/s"});
  }
};

/// Throws Error naming a rate that is not finite, or loads.compression unless it is 0 or has a rate for each direction.
void require_fit(const Loads& loads, Index dimension);

/// Velocity with which a grain arrives, imposed on it as an impact (V^-, m/s); its mass stays free.
struct PrescribedVelocity {
  Index grain = 0;
  Components<double> velocity = {};
  std::array<double, 3> spin{};  ///< rad/s, in the plane only about z; for cases that move, the linear study has none
};

/// The dynamics of one step in velocities V and contact impulses r ([ADI12] eqs. (1), (3)):
///     M V = M V^- + H r,   v = H^T V.
/// Higher layers know no geometry but M and H, and the centres, by which they find grains that move as one.
struct ReferenceProblem {
  Index dimension = 2;            ///< of the bodies: 2 in the plane, 3 in space
  Index dofs_per_grain = 2;       ///< d: translations of a frictionless grain, 2 or 3; with its rotations 3 or 6
  Index columns_per_contact = 1;  ///< k: 1 normal only; with friction normal and tangents side by side, 2 or 3
  Vector inertia;                 ///< diagonal of M, d n entries, kg
  SparseMatrix h;                 ///< H, d n x k c: column of contact (a, b) is -n on a, +n on b (zeros stored)
  Vector arriving_velocity;       ///< V^-, d n entries, m/s
  Matrix centres = {};            ///< of the grains, dimension x n, m; empty where only M and H are known

  Index grains() const { return inertia.size() / dofs_per_grain; }
  Index contacts() const { return h.cols(); }  ///< links of the linear study: columns of H
};

/// M and H of a packing with masses and its contacts. r > 0 is compression, v > 0 separation. Grains arrive with the
/// velocities of `loads`, those in `prescribed` with their own. Throws Error if masses are missing, the network is of
/// another packing, a prescribed grain does not exist, or velocities or loads are not finite or of another dimension.
ReferenceProblem assemble(const Packing& packing, const ContactNetwork& network,
                          const std::vector<PrescribedVelocity>& prescribed = {}, const Loads& loads = {});

/// Throws Error, with advice, if no grain has an arriving velocity: all impulses would be zero.
void require_arriving_velocity(const ReferenceProblem& problem);

/// Grains that a contact acts on, ascending, read off the pattern of H.
std::vector<Index> grains_of_contact(const ReferenceProblem& problem, Index contact);

/// Scale of flexibilities: mean over contacts of W_nn = h_n^T M^-1 h_n, h_n normal columns of H, 1/kg; 0 without any.
double mean_normal_delassus(const ReferenceProblem& problem);

/// M^-1/2 H: its Gram matrix is the Delassus operator W = H^T M^-1 H, its rank that of W.
SparseMatrix scaled_connectivity(const Vector& inertia, const SparseMatrix& h);

}  // namespace nscdd
