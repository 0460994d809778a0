// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/datbox.hpp"

/// Contacts of a step of LMGC90 between any shapes, and records of a run: /Evolution/ID_k in HDF5, formats 0.1 to 0.3.
namespace nscdd {

/// A contact. The candidate moves away from the antagonist along the normal.
struct DatboxContact {
  std::string kind;                                        ///< of the contactors, such as DKDKx
  Index candidate = 0, antagonist = 0;                     ///< bodies, from 0
  Index candidate_shape = 0, antagonist_shape = 0;         ///< contactors of the body, from 0
  bool within() const { return candidate == antagonist; }  ///< of two shapes of one body, which LMGC90 lets touch
  std::string law;
  Eigen::Vector3d point{0, 0, 0};  ///< m
  Eigen::Matrix3d frame;           ///< n, t and s as columns; s = (0, 0, 1) in the plane
  double gap = 0;                  ///< m
  Eigen::Vector3d force{0, 0, 0};  ///< on the candidate, N, along n, t and s
  Eigen::Vector3d speed{0, 0, 0};  ///< of the candidate relative to the antagonist, m/s, along them
  bool slid = false;               ///< its status is one of sliding
  DatboxPlace place;
};

struct DatboxNetwork {
  Index step = 0;
  double time = 0;  ///< s
  double h = 0;     ///< its time step, s; 0: not in the file
  std::vector<DatboxContact> contacts = {};
};

/// Sets t and s of a contact in the plane. Throws Error for a frame that is not orthonormal to 10^-5.
void complete_contact(DatboxContact& contact, bool space);

struct RecordPlace {
  std::string file;
  std::string record;  ///< such as "ID_3"; empty: the last one
};

/// The record that a path names, as lmgc90.h5:ID_3, or lmgc90.h5 for the last one. Nothing for other paths; without
/// ":ID_k" the file must exist and have a group Evolution.
std::optional<RecordPlace> record_at(const std::string& path);

/// Moves the bodies by the displacements of a record, and sets velocities, axes and the time. Throws Error with file
/// and dataset for a record that does not exist, another number of rows or columns, and invisible bodies.
void read_state(const RecordPlace& place, Datbox& datbox);

/// The contacts of a record, with its time step. Throws Error as read_state, and for bodies that are missing or not
/// rigid, for laws that TACT_BEHAV.DAT does not have, and as complete_contact.
DatboxNetwork read_network(const RecordPlace& place, const Datbox& datbox);

}  // namespace nscdd
