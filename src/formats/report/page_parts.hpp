// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>

/// The files of src/formats/report/page/, which cmake/EmbedPage.cmake puts into the library.
namespace nscdd::page::parts {

extern const std::string_view page, style;
extern const std::span<const std::string_view> program;  ///< one behind the other

}  // namespace nscdd::page::parts
