// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"

/// What a DATBOX that is written has beside bodies and their state, in the plane and in space: laws and motions.
namespace nscdd {

/// Why LMGC90 has no law like these; empty where it has one.
std::string without_datbox_law(const Interaction& interaction);

/// The laws of grains and of boundaries.
std::string datbox_law_texts(const Interaction& interaction);

/// That grains, contactors of the kind `grain`, see contactors of another kind. `body`: RBDY2 or RBDY3.
std::string datbox_sight(const char* body, const char* grain, const char* law, const char* contactor,
                         const char* colour, double alert);

/// Who is driven: the number of the body, and the velocities of its degrees of freedom at the times of a motion.
struct DatboxDriven {
  Index body = 0;
  std::vector<double> time;                   ///< s, ascending; empty at rest
  std::vector<std::vector<double>> velocity;  ///< of each degree of freedom, as many as times, or one
};

/// DRV_DOF.DAT: by formula where a velocity is constant, else by a table (evolution).
std::string datbox_driven_text(const char* body, const char* node, const std::vector<DatboxDriven>& driven);

/// These tables, by the names of their files. Behind its last row LMGC90 goes on in a straight line, so that the last
/// two rows have one velocity.
std::vector<std::pair<std::string, std::string>> datbox_tables(const std::vector<DatboxDriven>& driven);

}  // namespace nscdd
