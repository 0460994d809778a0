// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/network.hpp"

/// Records of a run of LMGC90: groups /Evolution/ID_k of its HDF5 file, formats 0.1 to 0.3.
namespace nscdd {

struct RecordPlace {
  std::string file;
  std::string record;  ///< such as "ID_3"; empty: the last one
};

/// The record that a path names, as lmgc90.h5:ID_3, or lmgc90.h5 for the last one. Nothing for other paths; without
/// ":ID_k" the file must exist and have a group Evolution.
std::optional<RecordPlace> record_at(const std::string& path);

/// Moves the bodies by the displacements of a record, and sets velocities, axes and the time. Throws Error with file
/// and dataset for a record that does not exist, another number of rows or columns, and for bodies that are not
/// visible.
void read_state(const RecordPlace& place, Datbox& datbox);

/// The contacts of a record, with its time step. Throws Error as read_state, and for bodies that are missing or not
/// rigid, for laws that TACT_BEHAV.DAT does not have, and as complete_contact.
DatboxNetwork read_network(const RecordPlace& place, const Datbox& datbox);

}  // namespace nscdd
