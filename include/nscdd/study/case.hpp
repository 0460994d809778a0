// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/core/monitor.hpp>
#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/ddm/partitioner.hpp>
#include <nscdd/mechanics/friction_problem.hpp>
#include <nscdd/mechanics/reference_problem.hpp>
#include <nscdd/packing/contact_network.hpp>
#include <nscdd/packing/generator.hpp>
#include <nscdd/packing/packing.hpp>
#include <nscdd/simulation/dynamics.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace nscdd {

/// A packing read from a file, with the name it was read under.
struct PackingFile {
  std::string path;
  Packing packing;
};

/// A frictional contact problem read from a file, which takes the place of a packing: M and H without
/// geometry.
struct ContactProblemFile {
  std::string path;
  GlobalFrictionProblem problem;
};

/// The free grains of another case at the end of its simulation.
struct SettledPacking {
  std::string from;      ///< as the case file names that case
  std::string resolved;  ///< that case as a case file, what it is settled from in turn behind it
  Packing packing;       ///< with masses
};

/// Everything that defines a problem to be studied: a case file, resolved.
struct Case {
  std::string name;    ///< stem of the file; the `case` column of every table
  std::string source;  ///< the file as it was named, for errors; empty where there is none
  std::string title;
  std::variant<Generator, PackingFile, SettledPacking, ContactProblemFile> packing =
      Generator{TriangularStrip{}};
  ContactDetection contacts;
  Masses masses;
  Partitioner partition = GridPartitioner{};
  /// Grain numbers count from 0; a negative one from the end, -1 being the last grain.
  std::vector<PrescribedVelocity> prescribed;
  Loads loads;
  std::optional<Dynamics> dynamics;  ///< none for a case that is not made to move
};

/// Sets one parameter of a case from text: "packing.grains", "contacts.tolerance", "masses.density",
/// "partition.grid", "loads.compression", "dynamics.steps", "solver.tolerance", "interaction.friction" and so
/// on. Throws Error for a key that the case does not have, naming those it has.
void override_case(Case& one, std::string_view key, std::string_view value);

/// The case as a case file that reads back to it (a packing file by its path, a settled packing by the name
/// of its case).
std::string to_toml(const Case& one);

/// The packing of a case, generated or as read from its file or settled, with masses where the case says how.
/// Throws Error for a packing or masses that cannot be used, and for a contact problem, which has none.
Packing packing_of(const Case& one, const Monitor& monitor = {});

/// Throws Error naming the key where a case cannot be made to move, as far as that can be told without its
/// grains: no [dynamics], too many subdomains, a criterion that says nothing of its solver.
void check_dynamics(const Case& one);

/// A case made ready to move: its packing with masses and boundaries, at time 0. Throws Error naming the file
/// of the case, as check_dynamics and for grains that cannot be used.
Simulation simulation_of(const Case& one, const Monitor& monitor = {});

/// A case made ready for analysis.
struct Model {
  std::string name;
  Packing packing;         ///< with masses; empty for a contact problem, as is the network
  ContactNetwork network;  ///< contacts with their geometry
  ReferenceProblem problem;
  Partition partition;
  Decomposition parts;

  Index grains() const { return problem.grains(); }
  Index contacts() const { return problem.contacts() / problem.columns_per_contact; }
  bool has_geometry() const { return packing.size() > 0; }
};

/// Throws Error, naming what asks for it, where the model is a contact problem, of which no geometry is
/// known.
void require_geometry(const Model& model, std::string_view what);

/// Generates or takes over the packing, sets masses, finds contacts, assembles and decomposes. A contact
/// problem has all this behind it and is only decomposed, along no regular grid.
/// Throws Error for whatever cannot be used (see the functions called). The monitor follows the generator.
Model build(const Case& one, const Monitor& monitor = {});

}  // namespace nscdd
