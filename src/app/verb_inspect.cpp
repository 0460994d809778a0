// SPDX-License-Identifier: GPL-3.0-or-later
#include "case_options.hpp"
#include "verbs.hpp"
#include <nscdd/study/inspection.hpp>

#include <fmt/format.h>

#include <memory>

namespace nscdd::app {
namespace {

void print_degrees(const std::string& name, const NetworkDegrees& network) {
  fmt::print("{:<12}{:>9}{:>11}{:>8}{:>14}{:>17}\n", name, network.grains, network.contacts, network.rank,
             network.rigid_modes, network.hyperstaticity);
}

int run(const CaseOptions& options) {
  const Model model = build(options.resolve());
  const Inspection found = inspect(model);
  fmt::print("case                 {}\n", model.name);
  fmt::print("grains               {}\n", model.packing.size());
  fmt::print("  touching nothing   {}\n", found.isolated_grains);
  fmt::print("contacts             {}\n", model.network.size());
  fmt::print("coordination number  {:.6g}\n", found.coordination_number);
  fmt::print("connected pieces     {}\n", found.components);
  fmt::print("subdomains           {} ({} without a contact)\n", model.partition.subdomains,
             found.empty_subdomains);
  fmt::print("interface unknowns   {}{}\n", found.interface_dofs,
             found.interface_dofs == 0 ? " (empty interface)" : "");
  for (const auto& [multiplicity, grains] : found.interface_grains)
    fmt::print("  grains shared by {:<3} {}\n", multiplicity, grains);
  fmt::print("unit eigenvalues of B_0  {} (self-stresses across the interface)\n\n", found.unit_multiplicity);
  fmt::print("{:<12}{:>9}{:>11}{:>8}{:>14}{:>17}\n", "subdomain", "grains", "contacts", "rank W",
             "rigid modes", "hyperstaticity");
  for (std::size_t e = 0; e < found.subdomains.size(); ++e)
    print_degrees(fmt::format("{}", e), found.subdomains[e]);
  print_degrees("whole", found.whole);
  return 0;
}

}  // namespace

std::function<int()> declare_inspect(CLI::App& command, const Context&) {
  auto options = std::make_shared<CaseOptions>();
  options->declare(command);
  command.footer(
      "Examples:\n"
      "  nscdd inspect disks12\n"
      "  nscdd inspect mine.csv --subdomains 3x2");
  return [options] { return run(*options); };
}

}  // namespace nscdd::app
