// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/network.hpp"

/// Forces and statuses at the contacts of LMGC90's last step, from which a run starts as LMGC90 does.
namespace nscdd {

/// The nonzero forces of a network on the grains of `datbox_packing` with DatboxGrains::all and the walls of
/// `boundaries_of_datbox`. As in LMGC90, contacts of bodies or contactors that BODIES.DAT does not have are left out.
ContactForces contact_forces_of(const Datbox& datbox, const DatboxNetwork& network);

/// Those of Vloc_Rloc.INI of a folder that `holds_datbox`, or of a record, which may have none. Throws Error as
/// read_vloc_rloc, and for a folder without contacts.
ContactForces read_contact_forces(const std::string& path);

}  // namespace nscdd
