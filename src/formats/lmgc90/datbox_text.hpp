// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

/// Numbers and headings as LMGC90 writes them.
namespace nscdd {

/// D14.7 of Fortran: 0.1234567D+01, with its sign or a blank before it.
std::string datbox_number(double value);

/// Numbers with their names of five letters, such as "byrd=", each behind two blanks.
std::string datbox_named(std::initializer_list<std::pair<const char*, double>> values);

inline Eigen::Vector3d datbox_vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// A line of three numbers behind 27 columns, with names such as coo1, coo2, coo3.
std::string datbox_three(const std::array<const char*, 3>& names, const Eigen::Vector3d& values);
inline constexpr std::array<const char*, 3> datbox_coordinates{"coo1=", "coo2=", "coo3="};

/// The head of a file about the end of a step, and the line that closes a head or a list.
std::string datbox_head(const char* title, Index step, double time);
inline constexpr const char* datbox_ruler =
    "!-----------------------------------------------------------------------\n";

/// Colours and laws of what is written: those of free grains and of boundaries.
inline constexpr const char *datbox_grains = "GRAIN", *datbox_boundaries = "BOUND";
inline constexpr const char *datbox_law_of_grains = "CLB_G", *datbox_law_of_boundaries = "CLB_B";

}  // namespace nscdd
