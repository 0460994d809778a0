// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/network.hpp"

/// Forces and statuses at the contacts of LMGC90's last step, from which a run starts as LMGC90 does.
namespace nscdd {

/// The nonzero forces of a network on the grains of `datbox_packing` with DatboxGrains::all and the walls of
/// `boundaries_of_datbox`, in N in place of N s, ascending by (a, b). Throws Error with file and line for a contact
/// whose shapes are not those of its bodies.
std::vector<RememberedImpulse> contact_forces_of(const Datbox& datbox, const DatboxNetwork& network);

/// Those of Vloc_Rloc.INI of a folder that `holds_datbox`, or of a record; none without contacts there.
std::vector<RememberedImpulse> read_contact_forces(const std::string& path);

}  // namespace nscdd
