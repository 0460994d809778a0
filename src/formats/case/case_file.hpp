// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/case.hpp"
#include "study/tables/study.hpp"

namespace nscdd {

class StrictTable;

/// A case from the text of its file. Strict: an unknown key, a wrong type, a missing section or a value out of bounds
/// throws Error "file:line: key: expected ..., met ...". So does a value without effect, except in the case of a
/// trajectory, where the program wrote defaults, perhaps of an earlier version.
CaseSpec parse_case(std::string_view text, const std::string& file, bool of_trajectory = false);

CaseSpec read_case(const std::string& path);

/// A [[boundary]] of a case file. Throws Error "file:line: key: expected ..., met ..." for anything else, for numbers
/// some of which are for the plane and others for space, and as check(BoundarySpec).
BoundarySpec read_boundary(StrictTable section);

/// Reads the sections [[colour]] and [[pair]]. With `effects_wanted` rules without effect are refused.
void read_pairs(StrictTable& root, Dynamics& dynamics, bool effects_wanted);

/// Reads a spin: one number in the plane, three in space. Returns that dimension, 0 without the key.
Index read_spin(StrictTable& section, std::string_view key, std::array<double, 3>& spin);

/// The case of a file or folder: a case file (.toml), a packing, a contact problem, or a folder DATBOX of LMGC90, whose
/// laws and boundaries are read only if `moving`. A packing moves with all defaults and without boundaries. Throws
/// Error for another ending, and as the readers of these files.
CaseSpec spec_of_file(const std::string& path, bool moving = false);

/// Adds the clumps of its packing to the boundaries of a case that moves, see add_clumps. Throws Error as it.
void add_clumps(Case& one);

/// The case with its packing, bodies of its clumps, or contact problem. Names of files are relative to the folder of
/// the case file. Throws Error "file:line: packing.file: ..." for an unusable file and a packing to be settled.
Case resolve(CaseSpec spec);

/// Reads the case that a study names ("disks4", or a path).
using CaseFinder = std::function<CaseSpec(const std::string& name)>;

/// A study from the text of its file; strict as parse_case. Its cases are not resolved, because settling takes long.
Study parse_study(std::string_view text, const std::string& file, const CaseFinder& find);

}  // namespace nscdd
