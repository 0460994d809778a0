// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/packing/packing.hpp>

namespace nscdd {

enum class PackingFormat { csv, hdf5 };

/// The format by the ending of a file name: .csv, .h5 or .hdf5; empty for any other.
std::optional<PackingFormat> packing_format(const std::string& path);

/// Whether a text is a packing as YADE and ESyS-Particle exchange it: the first line that is neither blank nor a remark
/// ('#') has at least two words, no comma, and a number. (The first line of CSV has names.)
bool is_text_packing(std::string_view text);

/// Packing from CSV text with columns x, y, radius (m) and optionally z (m) and mass (kg), in any order; or from lines
/// "x y radius" or "x y z radius" (see is_text_packing), below "#format x_y_z_r_clumpId" with the number of a clump or
/// -1 in a fifth column. A column z makes a packing in space; so does z in lines, unless it is equal for all grains.
/// Throws Error "name:line: ..." for a missing, unknown or repeated column, a value that is not a number, not finite
/// or, although required, not positive, a line with another number of values than the first, and a file without grains.
Packing parse_packing(std::string_view text, const std::string& name);

/// Packing from the bytes of an HDF5 file: datasets x, y, radius and optionally z and mass of the group `packing`.
/// Throws Error "name: packing/dataset: ..." for the same reasons, and for datasets of different lengths.
Packing packing_from_hdf5(std::string_view bytes, const std::string& name);

/// Packing from a file: HDF5 by the ending of its name, else text; from a folder DATBOX of LMGC90 the free disks.
Packing read_packing(const std::string& path);

/// CSV text that `parse_packing` reads back bit for bit, in the shortest decimals. Throws Error for clumps.
std::string packing_csv(const Packing& packing);

/// The bytes of a file that reads back bit for bit. The provenance becomes a group, or remarks ('#') at the top of CSV.
std::string packing_bytes(PackingFormat format, const Packing& packing, const Provenance& provenance = {});

}  // namespace nscdd
