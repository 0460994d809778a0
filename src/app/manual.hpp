// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"

#include <string>
#include <vector>

namespace nscdd::app {

/// What `nscdd` prints alone: what the program is for, where to begin, and its verbs.
std::string short_guide(const std::vector<DescribedVerb>& verbs);

/// What `nscdd VERB --help` prints, at most 100 columns wide: a line per option, then remarks and examples.
/// Of the help of an option it shows the part before the first "; "; the manual page has it all.
std::string help_screen(const DescribedVerb& verb);

/// Manual pages in troff, section 1: of the program, and of one verb ("nscdd-VERB").
std::string manual_page(const std::vector<DescribedVerb>& verbs);
std::string manual_page(const DescribedVerb& verb);

/// A completion for bash: verbs, options, the words an option admits, known cases and studies, files.
std::string bash_completion(const std::vector<DescribedVerb>& verbs);

}  // namespace nscdd::app
