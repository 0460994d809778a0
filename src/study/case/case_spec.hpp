// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include <nscdd/packing/generator.hpp>

#include <map>

namespace nscdd {

/// Sources of the grains of a case other than a generator, named as in the case file.
struct PackingFile {
  std::string path;         ///< [packing] file = "..."
  std::string forces = {};  ///< [packing] forces = "...": contact forces from which the first step starts; empty: none
};
struct SettledFrom {
  std::string name;  ///< [packing] settled = "...": the free grains at the end of the simulation of that case
};
struct ContactProblemFile {
  std::string path;  ///< [problem] file = "...": M and H without geometry in place of a packing
};

/// Contact forces of LMGC90. Bodies: `grains` grains, then `walls` walls.
struct ContactForces {
  Index dimension = 2, grains = 0, walls = 0;
  std::vector<RememberedImpulse> forces = {};  ///< in N, ascending by (a, b)
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
  /// "file:line" of each key ("solver.eta", "prescribed[0].grain"), for errors; empty if its value is of no file.
  std::map<std::string, std::string, std::less<>> places;
  /// On what a folder of LMGC90 does not state, or states in vain, by the parameter that states it instead.
  std::map<std::string, std::string> remarks = {};
};

/// The place of a key for an error: "file:line: key", as far as file and line are known.
std::string where(const CaseSpec& spec, std::string_view key);

/// An error with the file of the case, and the line of its key.
Error located(const CaseSpec& spec, const Error& error);

/// Calls `read` for the value of a key. An Error becomes "file:line: key: ...".
auto at_key(const CaseSpec& spec, std::string_view key, auto&& read) {
  try {
    return read();
  } catch (const Error& error) {
    throw Error(where(spec, key) + ": " + error.what());
  }
}

/// Sets a parameter of a case, such as "packing.grains", from text. Throws Error for an unknown key, naming all.
void override_case(CaseSpec& spec, std::string_view key, std::string_view value);

/// The case file that reads back to the case.
std::string to_toml(const CaseSpec& spec);

/// Throws Error naming the key if a case cannot move, as far as known without its grains: it has no [dynamics], too
/// many subdomains, or a criterion that its solver never meets.
void check_dynamics(const CaseSpec& spec);

/// Throws Error naming `where` if a parameter such as "solver.eta" has no effect on a case that moves: it belongs to
/// the linear study alone, cuts a step that is not cut, or has none in `require_effect` of Dynamics.
void require_effect(const CaseSpec& spec, std::string_view key, std::string_view where);

}  // namespace nscdd
