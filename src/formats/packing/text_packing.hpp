// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Whether a text is a packing as YADE and ESyS-Particle exchange it: the first line that is neither blank nor a remark
/// ('#') has two words or more without a comma, and one of them at least is a number. So it is never CSV, whose first
/// line has names; and a first number that is none is named as such.
bool is_text_packing(std::string_view text);

/// A packing of lines "x y radius" or "x y z radius" (m), apart by blanks or tabs. Remarks ('#') and blank lines are
/// left out. Where z is the same for all grains they are disks in one plane, else spheres in space. Throws Error
/// "name:line: ..." for a line with more or fewer numbers than the first or with another word, and for numbers out of
/// bounds as `parse_packing` has them.
Packing parse_text_packing(std::string_view text, const std::string& name);

}  // namespace nscdd
