// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/friction_problem.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace nscdd::testing {

/// How the matrices of a file are stored; triplets as FCLIB documents them (p rows, i columns), or as CSparse
/// has them (p columns, i rows).
enum class Storage { columns, rows, triplets, csparse_triplets };

/// The datasets of an HDF5 file by their paths ("fclib_local/W/p"), to be changed and written by other means.
struct RawFclib {
  std::map<std::string, std::vector<int>> integers;
  std::map<std::string, std::vector<double>> numbers;

  void remove(const std::string& path);  ///< a dataset, or a group with its members
  void move(const std::string& from, const std::string& to);
  std::string bytes() const;
};

RawFclib raw_local(const LocalFrictionProblem& problem, Storage storage = Storage::columns);
RawFclib raw_global(const GlobalFrictionProblem& problem, Storage storage = Storage::columns);

/// Disks of unequal masses and radii joined in a chain and more, M diagonal with 3 rows per body, contacts
/// with random normals; loads that press and shear; friction 0.3 on average.
GlobalFrictionProblem random_bodies_problem(std::uint64_t seed, Index bodies, Index contacts);

/// The same in space: spheres of unequal masses and radii, M diagonal with 6 rows per body.
GlobalFrictionProblem random_spheres_problem(std::uint64_t seed, Index bodies, Index contacts);

/// A plane problem in space: its contacts have a second tangent that nothing loads, with the couplings of the first.
LocalFrictionProblem in_space(const LocalFrictionProblem& plane);

/// The problem of a packing with rotations: rows x, y, angle of each grain, columns normal and tangent of
/// each contact, inertia of the disks m r^2 / 2, momentum M V^- for f.
GlobalFrictionProblem with_rotations(const Packing& packing, const ContactNetwork& network,
                                     const Vector& arriving_velocity, double friction);

/// A grain between two walls that both move into it: its contacts ask for impulses that cancel, so that they grow.
LocalFrictionProblem squeezed_grain();

bool same_bits(const Vector& a, const Vector& b);
bool same_bits(const SparseMatrix& a, const SparseMatrix& b);
bool same_bits(const LocalFrictionProblem& a, const LocalFrictionProblem& b);
bool same_bits(const GlobalFrictionProblem& a, const GlobalFrictionProblem& b);

}  // namespace nscdd::testing
