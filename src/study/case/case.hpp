// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include <nscdd/core/table.hpp>
#include <nscdd/mechanics/friction_problem.hpp>
#include <nscdd/packing/generator.hpp>
#include <nscdd/study/model.hpp>

#include <map>

namespace nscdd {

/// Sources of the grains of a case other than a generator, named as in the case file.
struct PackingFile {
  std::string path;  ///< [packing] file = "..."
};
struct SettledFrom {
  std::string name;  ///< [packing] settled = "...": the free grains at the end of the simulation of that case
};
struct ContactProblemFile {
  std::string path;  ///< [problem] file = "...": M and H without geometry in place of a packing
};

/// A case file, before any of the files that it names is read.
struct CaseSpec {
  std::string name;    ///< stem of the file; the `case` column of every table
  std::string source;  ///< path of the case file as given; empty for a case without one
  std::string title;
  std::variant<Generator, PackingFile, SettledFrom, ContactProblemFile> packing = Generator{TriangularStrip{}};
  ContactDetection contacts;
  Masses masses;
  Partitioner partition = GridPartitioner{};
  std::vector<PrescribedVelocity> prescribed;  ///< grain numbers from 0; negative ones from the end, -1 the last
  Loads loads;
  std::optional<Dynamics> dynamics;  ///< none for a case that does not move
  /// The line of each key of the case file ("solver.eta", "prescribed[0].grain"), for errors.
  std::map<std::string, Index, std::less<>> lines;
};

/// A case file with the contents of the files that it names (see `resolve`).
struct Case {
  CaseSpec spec;
  Packing packing = {};                ///< of a packing file, or settled (with masses); else empty
  GlobalFrictionProblem problem = {};  ///< of the file of a contact problem; else empty
  Matrix points = {};                  ///< of its contacts, D x contacts, m; empty where the file has none
  /// Of a settled packing: the case file it was settled from, then those which that one was settled from in turn.
  std::string settled_from = {};
  /// Called with every model of this case before it is decomposed, for remarks on its contacts and subdomains.
  Sink<Model> made = {};
};

/// The place of a key for an error: "file:line: key", as far as file and line are known.
std::string where(const CaseSpec& spec, std::string_view key);

/// An error with the file of the case, and the line of its key.
Error located(const CaseSpec& spec, const Error& error);

/// Calls `read` for the value of a key. An Error becomes "file:line: key: ...".
template <class Read>
auto at_key(const CaseSpec& spec, std::string_view key, Read&& read) {
  try {
    return read();
  } catch (const Error& error) {
    throw Error(where(spec, key) + ": " + error.what());
  }
}

/// Sets a parameter of a case, such as "packing.grains" or "solver.tolerance", from text. Throws Error for an unknown
/// key, naming the known ones.
void override_case(CaseSpec& spec, std::string_view key, std::string_view value);

/// The case file that reads back to the case.
std::string to_toml(const CaseSpec& spec);

/// 2 in the plane, 3 in space. None for a contact problem, and for a packing of a file or case before it is resolved.
std::optional<Index> dimension_of(const Case& one);

/// The packing of a case, generated, read or settled, with masses if the case gives them. Throws Error for an invalid
/// packing, invalid masses, and for a contact problem, which has no packing.
Packing packing_of(const Case& one, const Monitor& monitor = {});

/// Throws Error naming the key if a case cannot move, as far as known without its grains: it has no [dynamics], too
/// many subdomains, or a criterion that its solver never meets.
void check_dynamics(const CaseSpec& spec);

/// The simulation of a case at time 0. Throws Error naming the file of the case, as check_dynamics and for invalid
/// grains.
Simulation simulation_of(const Case& one, const Monitor& monitor = {});

/// The model of a case: packing, masses, contacts, M and H, decomposition. A contact problem has its M and H, and a
/// grid partitions it only with the points of its contacts. Throws Error as the functions called. The monitor follows
/// the generator.
Model build(const Case& one, const Monitor& monitor = {});

/// The two halves of it for one of several ranks, which keeps its own subdomains. The first half has all subdomains,
/// but no matrices; several ranks drop the geometry of contacts.
Model cut_up(const Case& one, const Processes& processes, const Monitor& monitor = {});
Model share_of(Model cut, const Processes& processes);

}  // namespace nscdd
