// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/provenance.hpp"

#include <nscdd/core/version.hpp>

#include <fmt/format.h>

namespace nscdd::app {

Provenance provenance(const Context& context, const std::vector<Case>& cases) {
  std::string libraries, resolved;
  for (const auto& [name, version] : dependency_versions()) libraries += fmt::format("{} {}\n", name, version);
  for (const Case& one : cases) {
    resolved += fmt::format("# case {}\n{}\n", one.spec.name, to_toml(one.spec));
    if (!one.settled_from.empty()) resolved += one.settled_from + "\n";
  }
  return {{"program", "nscdd " + version()},
          {"libraries", libraries},
          {"command_line", context.command_line},
          {"cases", resolved}};
}

}  // namespace nscdd::app
