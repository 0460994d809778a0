// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include <nscdd/core/table.hpp>
#include <nscdd/mechanics/friction_problem.hpp>
#include <nscdd/packing/generator.hpp>
#include <nscdd/study/model.hpp>

#include <map>

namespace nscdd {

/// Where the grains of a case come from if no generator makes them. Files and cases are named as the case file
/// names them.
struct PackingFile {
  std::string path;  ///< [packing] file = "..."
};
struct SettledFrom {
  std::string name;  ///< [packing] settled = "...": a case, whose free grains at the end of its simulation are meant
};
struct ContactProblemFile {
  std::string path;  ///< [problem] file = "...": M and H without geometry in place of a packing
};

/// What a case file says, before any of the files that it names is looked at.
struct CaseSpec {
  std::string name;    ///< stem of the file; the `case` column of every table
  std::string source;  ///< the case file as it was named; empty for a case without one
  std::string title;
  std::variant<Generator, PackingFile, SettledFrom, ContactProblemFile> packing = Generator{TriangularStrip{}};
  ContactDetection contacts;
  Masses masses;
  Partitioner partition = GridPartitioner{};
  /// Grain numbers count from 0; a negative one from the end, -1 being the last grain.
  std::vector<PrescribedVelocity> prescribed;
  Loads loads;
  std::optional<Dynamics> dynamics;  ///< none for a case that is not made to move
  /// The line of each key of the case file ("solver.eta", "prescribed[0].grain"), for errors.
  std::map<std::string, Index, std::less<>> lines;
};

/// A problem to be studied: what its case file says, with what the files named there hold (see `resolve`).
struct Case {
  CaseSpec spec;
  Packing packing = {};                ///< of a packing file, or settled (with masses); else empty
  GlobalFrictionProblem problem = {};  ///< of the file of a contact problem; else empty
  /// Of a settled packing: the case it was settled from as a case file, followed by what that one was settled
  /// from in turn.
  std::string settled_from = {};
  /// Called with every model that is made of this case, before it is decomposed: its contacts may be in doubt
  /// (RoundingDoubt), its subdomains empty.
  Sink<Model> made = {};
};

/// The place of a key for an error: "file:line: key", as far as file and line are known.
std::string where(const CaseSpec& spec, std::string_view key);

/// An error that is met while a case is made ready, with the file of the case, and the line of its key.
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

/// Sets one parameter of a case, such as "packing.grains" or "solver.tolerance", from text. Throws Error for a
/// key that the case does not have, naming those it has.
void override_case(CaseSpec& spec, std::string_view key, std::string_view value);

/// The case as a case file that reads back to it.
std::string to_toml(const CaseSpec& spec);

/// 2 in the plane, 3 in space, as far as it is known without making the packing: a generator knows it, a file or what
/// is settled once the case is resolved. Nothing before, and for a contact problem.
std::optional<Index> dimension_of(const Case& one);

/// The packing of a case, generated, read or settled, with masses where the case says how. Throws Error for a
/// packing or masses that cannot be used, and for a contact problem, which has no packing.
Packing packing_of(const Case& one, const Monitor& monitor = {});

/// Throws Error naming the key if a case cannot be made to move, as far as that can be told without its
/// grains: it has no [dynamics], too many subdomains, or a criterion that its solver never meets.
void check_dynamics(const CaseSpec& spec);

/// A case made ready to move: its packing with masses and boundaries, at time 0. Throws Error naming the file
/// of the case, as check_dynamics and for grains that cannot be used.
Simulation simulation_of(const Case& one, const Monitor& monitor = {});

/// Generates the packing or takes the one there is, sets masses, finds contacts, assembles and decomposes. A
/// contact problem comes assembled and is only decomposed, which cannot be by a regular grid.
/// Throws Error for whatever cannot be used (see the functions called). The monitor follows the generator.
Model build(const Case& one, const Monitor& monitor = {});

/// The two halves of it for one of several processes, which keeps its own subdomains. The first half knows all of them,
/// but none of their matrices; the geometry of contacts is dropped unless the process is alone.
Model cut_up(const Case& one, const Processes& processes, const Monitor& monitor = {});
Model share_of(Model cut, const Processes& processes);

}  // namespace nscdd
