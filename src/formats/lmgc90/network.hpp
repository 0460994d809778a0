// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/datbox.hpp"

/// Contacts of a step of LMGC90 between bodies of any shapes.
namespace nscdd {

/// A contact. The candidate moves away from the antagonist along the normal.
struct DatboxContact {
  std::string kind;                                 ///< of the contactors, such as DKDKx
  Index candidate = 0, antagonist = 0;              ///< bodies, from 0
  Index candidate_shape = 0, antagonist_shape = 0;  ///< contactors of the body, from 0
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

}  // namespace nscdd
