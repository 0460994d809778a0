// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include "formats/lmgc90/datbox.hpp"

namespace nscdd {

/// Throws Error that begins with file and line.
template <class... Arguments>
[[noreturn]] void refuse(const DatboxPlace& place, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fail("{}:{}: {}", place.file, place.line, fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// By what law bodies of a DATBOX touch, and from how far they see each other.
struct DatboxContactLaw {
  Interaction interaction;
  double alert = 0;  ///< m, the largest one
};

/// Throws Error where the laws differ in more than the friction at what is driven, are none of IQS_CLB and RST_CLB, or
/// not all free disks see each other and whatever is driven.
DatboxContactLaw contact_law_of(const Datbox& datbox);

}  // namespace nscdd
