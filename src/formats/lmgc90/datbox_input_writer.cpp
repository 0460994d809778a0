// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "formats/lmgc90/datbox_input.hpp"
#include "formats/lmgc90/datbox_text.hpp"
#include "formats/lmgc90/datbox_writer.hpp"

namespace nscdd {
namespace {

bool is_constant(const std::vector<double>& values) {
  return std::ranges::all_of(values, [&](double value) { return value == values.front(); });
}

std::string table_name(Index body, std::size_t dof) { return fmt::format("velocity_{}_{}.dat", body, dof + 1); }

std::string law_text(const char* name, const Interaction& interaction, double friction) {
  if (interaction.restitution > 0)
    return fmt::format(
        "$behav  lawty\n {}  {:30}{}\n{:38}{}\n\n", name, "RST_CLB",
        datbox_named({{"rstn=", interaction.restitution}, {"rstt=", interaction.tangential_restitution}}), "",
        datbox_named({{"fric=", friction}}));
  return fmt::format("$behav  lawty\n {}  {:30}{}\n\n", name, "IQS_CLB", datbox_named({{"fric=", friction}}));
}

}  // namespace

std::string datbox_number(double value) {
  std::string text = fmt::format("{:.6e}", std::abs(value));  // 1.234567e+00
  const int exponent = value == 0 ? 0 : std::stoi(text.substr(text.find('e') + 1)) + 1;
  const std::string digits = text.substr(0, 1) + text.substr(2, 6);
  return fmt::format("{}0.{}{}{}{:02d}", std::signbit(value) && value != 0 ? '-' : ' ', digits,
                     std::abs(exponent) < 100 ? "D" : "", exponent < 0 ? '-' : '+', std::abs(exponent));
}

std::string datbox_named(std::initializer_list<std::pair<const char*, double>> values) {
  std::string text;
  for (const auto& [name, value] : values) text += fmt::format("  {:5}{}", name, datbox_number(value));
  return text;
}

std::string without_datbox_law(const Interaction& interaction) {
  if (const auto law = to_string(interaction.law); law != Coulomb::name && law != Frictionless::name)
    return fmt::format("interaction.law: expected coulomb or frictionless, met {}", law);
  if (interaction.restitution == 0 && interaction.tangential_restitution != 0)
    return "interaction.tangential_restitution: expected 0 without normal restitution, as IQS_CLB has it";
  return {};
}

std::string datbox_law_texts(const Interaction& interaction) {
  const bool frictionless = to_string(interaction.law) == Frictionless::name;
  return law_text(datbox_law_of_grains, interaction, frictionless ? 0 : interaction.friction) +
         law_text(datbox_law_of_boundaries, interaction, frictionless ? 0 : interaction.friction_at_boundaries());
}

std::string datbox_sight(const char* body, const char* grain, const char* law, const char* contactor,
                         const char* colour, double alert) {
  return fmt::format(
      "$seety\n cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert\n {}  {}  {}  {}  {}  {}  {}      {}\n\n",
      body, grain, datbox_grains, law, body, contactor, colour, datbox_number(alert));
}

std::string datbox_driven_text(const char* body, const char* node, const std::vector<DatboxDriven>& driven) {
  std::string text = "! File DRV_DOF\n\n";
  for (const DatboxDriven& one : driven) {
    text += fmt::format(
        "$bdyty\n {}  {:7}\n$nodty\n {}      1\n"
        "$dofty  numbr [CT......+......AMP..*..cos.(..OMEGA.*.time.+.PHI..)]...*...[RAMPI.....+.....RAMP.*.time]\n",
        body, one.body, node);
    for (std::size_t dof = 0; dof < one.velocity.size(); ++dof) {
      const std::vector<double>& values = one.velocity[dof];
      text += fmt::format(" vlocy  {:5}", dof + 1);
      if (is_constant(values))
        for (const double value : {values.front(), 0.0, 0.0, 0.0, 1.0, 0.0}) text += " " + datbox_number(value);
      else
        text += " evolution " + table_name(one.body, dof);
      text += "\n";
    }
    text += "$$$$$$\n\n";
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> datbox_tables(const std::vector<DatboxDriven>& driven) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const DatboxDriven& one : driven)
    for (std::size_t dof = 0; dof < one.velocity.size(); ++dof) {
      const std::vector<double>& values = one.velocity[dof];
      if (is_constant(values)) continue;
      std::string text;
      const auto add = [&](double time, double value) { text += fmt::format("{:.17g} {:.17g}\n", time, value); };
      const double reach = 1 + one.time.back() - one.time.front();  // s, of the constant ends
      add(one.time.front() - reach, values.front());
      for (std::size_t k = 0; k < values.size(); ++k) add(one.time[k], values[k]);
      add(one.time.back() + reach, values.back());
      all.emplace_back(table_name(one.body, dof), text);
    }
  return all;
}

std::string DatboxWriter::without_datbox() const {
  if (const std::string reason = without_datbox_law(first_.dynamics.interaction); !reason.empty()) return reason;
  for (std::size_t b = 0; b < first_.system.boundaries.size(); ++b) {
    const Boundary& boundary = first_.system.boundaries[b];
    if (!turns(boundary.motion)) continue;
    if (wall_of_[b] >= 0 && !(thickness_[b] > 0))
      return fmt::format("boundary '{}': expected a wall that turns about a point on it or behind it, as a plank does",
                         boundary.name);
    if (wall_of_[b] < 0 && boundary.orientation == Orientation::fixed)
      return fmt::format("boundary '{}': expected disks that turn with their boundary, as a rigid body does",
                         boundary.name);
  }
  return {};
}

std::string DatboxWriter::tact() const {
  const double alert = first_.dynamics.time.alert * *std::ranges::min_element(first_.system.radius);
  std::string text = "! File TACT_BEHAV\n\n" + datbox_law_texts(first_.dynamics.interaction);
  text += datbox_sight("RBDY2", "DISKx", datbox_law_of_grains, "DISKx", datbox_grains, alert);
  text += datbox_sight("RBDY2", "DISKx", datbox_law_of_boundaries, "DISKx", datbox_boundaries, alert);
  return text + datbox_sight("RBDY2", "DISKx", datbox_law_of_boundaries, "JONCx", datbox_boundaries, alert);
}

std::vector<DatboxDriven> DatboxWriter::driven_bodies() const {
  std::vector<DatboxDriven> all;
  for (std::size_t b = 0; b < first_.system.boundaries.size(); ++b) {
    const Motion& motion = first_.system.boundaries[b].motion;
    DatboxDriven one{body_of_boundary(static_cast<Index>(b)), motion.time, {{}, {}, {}}};
    for (const RigidVelocity& v : motion.velocity.empty() ? std::vector<RigidVelocity>{{}} : motion.velocity) {
      one.velocity[0].push_back(v.x);
      one.velocity[1].push_back(v.y);
      one.velocity[2].push_back(v.spin);
    }
    all.push_back(std::move(one));
  }
  return all;
}

std::string DatboxWriter::driven() const { return datbox_driven_text("RBDY2", "NO3xx", driven_bodies()); }

std::vector<std::pair<std::string, std::string>> DatboxWriter::tables() const { return datbox_tables(driven_bodies()); }

}  // namespace nscdd
