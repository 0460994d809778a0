// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/dynamics.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

namespace nscdd {
namespace {

std::string motion_lines(const Motion& motion) {
  std::string text;
  if (motion.centre != std::array<double, 2>{0, 0}) text += fmt::format("centre = {}\n", field_text(motion.centre));
  if (motion.velocity.empty()) return text;
  const auto numbers = [](const RigidVelocity& v) {
    return fmt::format("{}, {}, {}", field_text(v.x), field_text(v.y), field_text(v.spin));
  };
  if (motion.velocity.size() == 1 && motion.time.front() == 0) {
    const RigidVelocity& v = motion.velocity.front();
    return text + fmt::format("velocity = [{}, {}]\nspin = {}\n", field_text(v.x), field_text(v.y), field_text(v.spin));
  }
  text += "motion = [";
  for (std::size_t k = 0; k < motion.velocity.size(); ++k)
    text += fmt::format("{}[{}, {}]", k == 0 ? "" : ", ", field_text(motion.time[k]), numbers(motion.velocity[k]));
  return text + "]\n";
}

// A parameter without effect is written with its default, so that equal runs have equal texts.
template <class Parameters>
std::string effective_lines(const Dynamics& dynamics, std::string_view section, const Parameters& parameters) {
  const std::vector<FieldDescription> now = describe_fields(parameters), by_default = describe_fields(Parameters{});
  std::string lines;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const bool effective = has_effect(dynamics, fmt::format("{}.{}", section, now[k].key));
    lines += fmt::format("{} = {}\n", now[k].key, effective ? now[k].value : by_default[k].value);
  }
  return lines;
}

std::string boundary_lines(const BoundarySpec& spec) {
  std::string text = fmt::format("name = {}\nshape = \"{}\"\n", field_text(spec.name), to_string(spec.shape));
  if (spec.shape == BoundaryShape::grains) {
    text += fmt::format("first = {}\nlast = {}\n", spec.first, spec.last);
  } else {
    text += fmt::format("from = {}\nto = {}\n", field_text(spec.from), field_text(spec.to));
    if (spec.shape == BoundaryShape::disks)
      text += fmt::format("radius = {}\nspacing = {}\n", field_text(spec.radius), field_text(spec.spacing));
  }
  if (spec.orientation != Orientation::turning)
    text += fmt::format("orientation = \"{}\"\n", to_string(spec.orientation));
  return text + motion_lines(spec.motion);
}

}  // namespace

std::string to_toml(const Dynamics& dynamics) {
  std::string text = "\n[interaction]\n" + effective_lines(dynamics, "interaction", dynamics.interaction);
  text += "\n[dynamics]\n" + effective_lines(dynamics, "dynamics", dynamics.time);
  text += "\n[solver]\n" + effective_lines(dynamics, "solver", dynamics.solver);
  for (const BoundarySpec& spec : dynamics.boundaries) text += "\n[[boundary]]\n" + boundary_lines(spec);
  return text;
}

}  // namespace nscdd
