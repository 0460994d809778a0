// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/case_file.hpp"
#include "formats/trajectory.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

namespace nscdd {

void require_fit(const std::string& path, const Simulation& simulation) {
  try {
    check(simulation.system, simulation.state);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
}

Simulation rebuilt_simulation(const std::string& path, const TrajectoryHeader& header, GranularState state) {
  // The grains are those of the trajectory, wherever the case has them from.
  const CaseSpec spec = parse_case(header.case_text, path + ": case");
  if (!spec.dynamics) throw Error(fmt::format("{}: case: expected a section [dynamics], met a case without", path));
  const auto& specs = spec.dynamics->boundaries;
  GranularSystem system = header.system;
  if (system.boundaries.size() != specs.size())
    throw Error(fmt::format("{}: expected the {} boundaries of its case, met {}", path, specs.size(),
                            system.boundaries.size()));
  for (std::size_t k = 0; k < specs.size(); ++k) {
    if (system.boundaries[k].name != specs[k].name)
      throw Error(fmt::format("{}: expected the boundary '{}' of its case, met '{}'", path, specs[k].name,
                              system.boundaries[k].name));
    system.boundaries[k].motion = specs[k].motion;
    system.boundaries[k].orientation = specs[k].orientation;
  }
  Simulation simulation{std::move(system), std::move(state), *spec.dynamics, spec.partition};
  require_fit(path, simulation);
  return simulation;
}

}  // namespace nscdd
