// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// How a packing is kept in a file.
enum class PackingFormat { csv, hdf5 };

/// The format by the ending of a file name: .csv, .h5 or .hdf5; empty for any other.
std::optional<PackingFormat> packing_format(const std::string& path);

/// Whether a text is a packing as YADE and ESyS-Particle exchange it: the first line that is neither blank nor a remark
/// ('#') has two words or more without a comma, and one of them at least is a number. So it is never CSV, whose first
/// line has names; and a first number that is none is named as such.
bool is_text_packing(std::string_view text);

/// Packing from CSV text with columns x, y, radius (m) and optionally z (m) and mass (kg), in any order; or from text
/// whose first line that is neither blank nor a remark has numbers alone: lines "x y radius" or "x y z radius", as YADE
/// and ESyS-Particle exchange them. A column z makes a packing in space; so does z in text, unless it is the same for
/// all grains, which are disks in one plane then. Throws Error "name:line: ..." for a missing, unknown or repeated
/// column, a value that is not a number, not finite, or not positive although it must be, a line of text with more or
/// fewer numbers than the first, and for a file without grains.
Packing parse_packing(std::string_view text, const std::string& name);

/// Packing from the bytes of an HDF5 file: datasets x, y, radius and optionally z and mass of the group `packing`.
/// Throws Error "name: packing/dataset: ..." for the same reasons, and for datasets of different lengths.
Packing packing_from_hdf5(std::string_view bytes, const std::string& name);

/// Either of them from a file, by the ending of its name. Any other ending stands for text, CSV or not. Of a folder
/// DATBOX of LMGC90 it reads the free disks with their masses, see docs/formats.md.
Packing read_packing(const std::string& path);

/// A packing as CSV text that `parse_packing` reads back bit for bit: the shortest decimals that do so.
std::string packing_csv(const Packing& packing);

/// The bytes of a file that reads back bit for bit: as `packing_csv`, or the numbers themselves. The provenance goes
/// into the group of that name, or into remarks ('#') at the top of CSV.
std::string packing_bytes(PackingFormat format, const Packing& packing, const Provenance& provenance = {});

}  // namespace nscdd
