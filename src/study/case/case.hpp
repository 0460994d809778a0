// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/case_spec.hpp"
#include <nscdd/core/table.hpp>
#include <nscdd/mechanics/friction_problem.hpp>
#include <nscdd/study/model.hpp>

namespace nscdd {

/// A case file with the contents of the files that it names (see `resolve`).
struct Case {
  CaseSpec spec;
  Packing packing = {};                ///< of a packing file, or settled (with masses); else empty
  ContactForces start = {};            ///< of PackingFile::forces
  GlobalFrictionProblem problem = {};  ///< of the file of a contact problem; else empty
  Matrix points = {};                  ///< of its contacts, D x contacts, m; empty where the file has none
  /// Of a settled packing: the case file it was settled from, then those which that one was settled from in turn.
  std::string settled_from = {};
  Sink<std::string> remark = {};  ///< takes remarks for a user on models of this case and on work with them
  Sink<Model> made = {};          ///< takes every model of this case before it is decomposed
};

/// A fingerprint of the bits of its forces.
std::string fingerprint_of_forces(const Case& one);

/// The name and the case file of `spec`. A fingerprint of the content in `one` follows each file name, without folders.
std::string text_with_contents(const Case& one, CaseSpec spec);

/// 2 in the plane, 3 in space. None for a contact problem, and for a packing of a file or case before it is resolved.
std::optional<Index> dimension_of(const Case& one);

/// The packing of a case, generated, read or settled, with masses if the case gives them. Throws Error for an invalid
/// packing, invalid masses, and for a contact problem, which has no packing.
Packing packing_of(const Case& one, const Monitor& monitor = {});

/// The simulation of a case at time 0. Throws Error naming the case file, as check_dynamics and for invalid grains.
Simulation simulation_of(const Case& one, const Monitor& monitor = {});

/// The model of a case: packing, masses, contacts, M and H, decomposition. A contact problem has its M and H, and a
/// grid partitions it only with the points of its contacts. Throws Error as its parts. `monitor`: of the generator.
Model build(const Case& one, const Monitor& monitor = {});

/// The two halves of it for one of several ranks, which keeps its own subdomains. The first half has all subdomains,
/// but no matrices; several ranks drop the geometry of contacts.
Model cut_up(const Case& one, const Processes& processes, const Monitor& monitor = {});
Model share_of(Model cut, const Processes& processes);

}  // namespace nscdd
