// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/record.hpp"
#include <nscdd/formats/fclib.hpp>

/// Contact networks of LMGC90, files Vloc_Rloc.INI and Vloc_Rloc.OUT.K of a step, between bodies of any shapes.
namespace nscdd {

/// Reads the contacts of these bodies, and of others, if BODIES.DAT has changed since. Names such as "rln/H" say what a
/// number is: their order depends on the kind. Throws Error with file and line for bodies that are not rigid, a contact
/// without one of its numbers or of one body, and a frame that is not orthonormal to 10^-5.
DatboxNetwork parse_vloc_rloc(std::string_view text, const std::string& name, const Datbox& datbox);

/// The contact problem of the step after the state of `datbox`, with the points of its contacts, and with LMGC90's
/// forces times h as a guess. h is that of the network, else its time / step number, else the default of cases. M is
/// diagonal, with three rows per body, in space six, spins along its own axes; bodies that are driven in all degrees of
/// freedom have none. Throws Error for other bodies than those of `datbox`, for other laws than those of DatboxLaw, a
/// mass that is not positive, a point beyond the reach of its body (an image in a periodic cell), and for no contacts
/// at all; `name` is that of the file.
FclibFile contact_problem_of(const Datbox& datbox, const DatboxNetwork& network, const std::string& name);

/// Reads such a file, a record (record.hpp), or Vloc_Rloc.INI of a folder that `holds_datbox`. DOF.INI, or DOF.OUT.K of
/// that step, in the folder of the file has the state; the folder of datbox_beside has all else. Throws Error as the
/// functions called, and for a state of another time.
FclibFile read_vloc_rloc(const std::string& path);

/// The nonzero forces and the statuses at the contacts of LMGC90's last step, from which a run starts as LMGC90 does:
/// in Vloc_Rloc.INI of a folder that `holds_datbox`, or in a record, which may have none. Grains are those of
/// `datbox_packing` with DatboxGrains::all, walls those of `boundaries_of_datbox`. As in LMGC90, contacts of bodies or
/// contactors that BODIES.DAT has not are left out. Throws Error as read_vloc_rloc, and without contacts.
ContactForces read_contact_forces(const std::string& path);

/// Vloc_Rloc.INI of a folder that `holds_datbox` if it has contacts, else empty.
std::string vloc_rloc_of_datbox(const std::string& path);

bool has_vloc_rloc_name(const std::string& path);

/// The name of a case: that of the folder (of a record), or of the one that a folder DATBOX or OUTBOX lies in.
std::string datbox_name(const std::string& folder);

}  // namespace nscdd
