// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>

/// Numbers as LMGC90 writes them.
namespace nscdd {

/// D14.7 of Fortran: 0.1234567D+01, with its sign or a blank before it.
std::string datbox_number(double value);

/// Numbers with their names of five letters, such as "byrd=", each behind two blanks.
std::string datbox_named(std::initializer_list<std::pair<const char*, double>> values);

/// Colours and laws of what is written: those of free grains and of boundaries.
inline constexpr const char *datbox_grains = "GRAIN", *datbox_boundaries = "BOUND";
inline constexpr const char *datbox_law_of_grains = "CLB_G", *datbox_law_of_boundaries = "CLB_B";

}  // namespace nscdd
