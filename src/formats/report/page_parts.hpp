// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>

/// The files of src/formats/report/page/, embedded by cmake/EmbedPage.cmake.
namespace nscdd::page::parts {

extern const std::string_view page, style;
extern const std::span<const std::string_view> program;  ///< in the order of the page

}  // namespace nscdd::page::parts
