// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "formats/lmgc90/datbox_writer.hpp"

namespace nscdd {
namespace {

// Whether all are equal.
bool is_constant(const std::vector<double>& values) {
  return std::ranges::all_of(values, [&](double value) { return value == values.front(); });
}

// Whether DRV_DOF.DAT can express this velocity: [CT + AMP cos(OMEGA t + PHI)] min(1, RAMPI + RAMP t), or a table.
bool has_formula(const std::vector<double>& values, const std::vector<std::array<double, 5>>& oscillations) {
  if (oscillations.empty()) return true;
  const auto& [amplitude, omega, phase, ramp, growth] = oscillations.front();
  return oscillations.size() == 1 && is_constant(values) && (values.front() == 0 || ramp == 1);
}

std::string table_name(const char* kind, Index body, std::size_t dof) {
  return fmt::format("{}_{}_{}.dat", std::string_view(kind) == "force" ? "force" : "velocity", body, dof + 1);
}

// LMGC90 extrapolates tables linearly, so their ends have two rows of one velocity.
std::string table_text(const std::vector<double>& time, const std::vector<double>& values) {
  std::string text;
  const auto add = [&](double t, double value) { text += fmt::format("{:.17g} {:.17g}\n", t, value); };
  const double reach = 1 + time.back() - time.front();  // s, of the constant ends
  add(time.front() - reach, values.front());
  for (std::size_t k = 0; k < values.size(); ++k) add(time[k], values[k]);
  add(time.back() + reach, values.back());
  return text;
}

std::string law_text(const char* name, const Dynamics& dynamics, bool at_boundary) {
  const Interaction& interaction = dynamics.interaction;
  const bool frictionless = to_string(interaction.law) == Frictionless::name;
  const double friction = frictionless ? 0 : interaction.friction_of(at_boundary, true),
               at_rest = frictionless ? 0 : interaction.friction_of(at_boundary, false);
  const bool two = at_rest != friction;
  const std::string frictions =
      two ? datbox_named({{"dfrc=", friction}, {"sfrc=", at_rest}}) : datbox_named({{"fric=", friction}});
  if (to_string(interaction.law) == Cohesive::name)
    return fmt::format("$behav  lawty\n {}  {:30}{}\n{:38}{}\n{:38}{}\n\n", name, "IQS_WET_DS_CLB",
                       datbox_named({{"cohn=", interaction.cohesion}, {"coht=", 0}}), "",
                       datbox_named({{"Weth=", interaction.cohesion_range}}), "",
                       datbox_named({{"dfrc=", friction}, {"sfrc=", at_rest}}));
  const bool removes_overlaps = dynamics.time.penetration_correction == 1 && dynamics.time.maximum_push_speed >= 1e9;
  if (interaction.on_velocity())
    return fmt::format(
        "$behav  lawty\n {}  {:30}{}\n{:38}{}\n\n", name, two ? "RST_DS_CLB" : "RST_CLB",
        datbox_named({{"rstn=", interaction.restitution}, {"rstt=", interaction.tangential_restitution}}), "",
        frictions);
  return fmt::format("$behav  lawty\n {}  {:30}{}\n\n", name,
                     (removes_overlaps ? std::string("GAP_SGR") : "IQS") + (two ? "_DS_CLB" : "_CLB"), frictions);
}

// Why LMGC90 has no such law; empty if it has one.
std::string without_law(const Interaction& interaction) {
  const auto law = to_string(interaction.law);
  if (law == Cohesive::name && (interaction.on_velocity() || interaction.cohesion_range < 0))
    return "interaction.law: expected cohesive with the condition on the gap and a cohesion_range, as IQS_WET_DS_CLB";
  if (law == LinearViscous::name) return "interaction.law: expected a law that opens, met linear_viscous";
  if (!interaction.on_velocity() && interaction.tangential_restitution != 0)
    return "interaction.tangential_restitution: expected 0 with the condition on the gap, as IQS_CLB has it";
  return {};
}

bool turns_about_one_axis(const Motion& motion) {
  std::vector<Eigen::Vector3d> spins;
  for (const RigidVelocity& v : motion.velocity) spins.push_back(spin_vector(v));
  for (const Oscillation& one : motion.oscillations) spins.push_back(spin_vector(one.amplitude));
  const Eigen::Vector3d first = *std::ranges::max_element(spins, {}, [](const auto& spin) { return spin.norm(); });
  return std::ranges::none_of(spins,
                              [&](const auto& spin) { return first.cross(spin).norm() > 1e-12 * first.squaredNorm(); });
}

// The gap of a sphere and a plank of one body.
double gap_between(const DatboxContactor& sphere, const DatboxContactor& plank) {
  const Eigen::Vector3d from = (plank.frame.transpose() * (sphere.shift - plank.shift)).cwiseAbs();
  const double along = std::max(from[0] - plank.length, 0.0), across = std::max(from[1] - plank.width, 0.0);
  return std::hypot(along, across, from[2]) - plank.thickness - sphere.radius;
}

}  // namespace

std::string datbox_number(double value) {
  std::string text = fmt::format("{:.6e}", std::abs(value));  // 1.234567e+00
  const int exponent = value == 0 ? 0 : std::stoi(text.substr(text.find('e') + 1)) + 1;
  const std::string digits = text.substr(0, 1) + text.substr(2, 6);
  return fmt::format("{}0.{}{}{}{:02d}", std::signbit(value) && value != 0 ? '-' : ' ', digits,
                     std::abs(exponent) < 100 ? "D" : "", exponent < 0 ? '-' : '+', std::abs(exponent));
}

std::string datbox_named(DatboxNumbers values) {
  std::string text;
  for (const auto& [name, value] : values) text += fmt::format("  {:5}{}", name, datbox_number(value));
  return text;
}

// LMGC90 takes the centre of the contactors, weighted by volume, moments along the axes of a body, and as the inertia
// of a single contactor that of a full sphere, box or cylinder.
std::string DatboxWriter::without_free(const Body& body) const {
  const FreeBody* free = free_body(body);
  if (!space_ || free == nullptr) return {};
  if (turns(free->load)) return "expected no torque on a body in space: torques are not written";
  if (body.wall() >= 0 && !free->free(BodyDirection::spin)) return {};
  constexpr double tolerance = 1e-5;  // of numbers with seven digits, in the fifth power
  const Node node = node_of(body, first_.state);
  const Pose& pose = first_.state.poses[at(body.boundary)];
  DatboxBody read{.contactors = contactors_of(body, node)};
  const bool single = read.contactors.size() == 1;
  for (DatboxContactor& one : read.contactors) weigh(one, space_);
  const double alert = first_.dynamics.time.alert * *std::ranges::min_element(first_.system.radius);
  for (const DatboxContactor& plank : read.contactors)
    for (const DatboxContactor& sphere : plank.wall.empty() ? std::span<DatboxContactor>() : std::span(read.contactors))
      if (sphere.wall.empty() && gap_between(sphere, plank) < alert)
        return "expected its spheres farther than the alert distance from its planks: LMGC90 would have contacts there";
  const std::string kind = read.contactors[0].wall;
  complete(read, 3);
  const Eigen::Vector3d middle = node.place + node.frame * read.position;
  if ((middle - Eigen::Vector3d(pose.x, pose.y, pose.z)).norm() > tolerance * (margin_ + middle.norm()))
    return fmt::format("expected its centre to be {}", body.wall() < 0 ? "that of its shapes, weighted by volume"
                                                                       : "the middle of its plank or cylinder");
  if (!single || !free->free(BodyDirection::spin)) return {};
  const Eigen::Vector3d expected = density_ * read.inertia;
  const Eigen::Matrix3d excess = inertia_in(*free, body, node.frame) - Eigen::Matrix3d(expected.asDiagonal());
  if (excess.cwiseAbs().maxCoeff() <= tolerance * expected.maxCoeff()) return {};
  return fmt::format("expected the inertia of a full {} with the density of grains, {}, {} and {} kg m^2",
                     kind.empty()      ? "sphere"
                     : kind == "PLANx" ? "box"
                                       : "cylinder",
                     expected[0], expected[1], expected[2]);
}

std::string DatboxWriter::without_datbox() const {
  if (const std::string reason = without_law(first_.dynamics.interaction); !reason.empty()) return reason;
  if (!first_.dynamics.pairs.empty()) return "pair: expected no rules for pairs of colours, which are not written";
  const GranularSystem& system = first_.system;
  for (std::size_t i = 0; space_ && i < system.radius.size(); ++i)
    if (const double mass = density_ * datbox_volume(system.radius[i]);
        system.driven_by[i] < 0 && std::abs(system.mass[i] - mass) > 1e-5 * mass)
      return "masses: expected free spheres of one density, with which LMGC90 computes their inertia";
  for (const Driven& one : driven_bodies())
    for (std::size_t dof = 0; dof < one.velocity.size(); ++dof)
      if (!one.velocity[dof].empty() && !has_formula(one.velocity[dof], one.oscillations[dof]))
        return fmt::format(
            "boundary '{}': expected along each degree of freedom a table, or one oscillation and a constant velocity, "
            "which is 0 if the oscillation has a ramp",
            first_.system.boundaries[at(bodies_[at(one.body - 1)].boundary)].name);
  for (const Body& body : bodies_) {
    if (body.boundary < 0) continue;
    const Boundary& boundary = first_.system.boundaries[at(body.boundary)];
    if (const std::string reason = without_free(body); !reason.empty())
      return fmt::format("boundary '{}': {}", boundary.name, reason);
    const bool has_middle = body.wall() >= 0 && first_.system.walls[at(body.wall())].radius != 0;
    const bool spins = boundary.body && boundary.body->free(BodyDirection::spin);
    if (!turns(boundary.motion) && !(has_middle && spins)) continue;
    const char* expected = nullptr;
    const Pose& pose = first_.state.poses[at(body.boundary)];
    const Eigen::Vector3d centre(pose.x, pose.y, pose.z);
    if (has_middle && (node_of(body, first_.state).place - centre).norm() > 1e-7 * margin_)
      expected = "a plank or cylinder that turns about its middle";
    else if (body.wall() >= 0 && !(planks_[at(body.wall())].thickness > 0))
      expected = "a wall that turns about a point on it or behind it, as a plank does";
    else if (body.wall() < 0 && space_)
      expected = "a boundary of spheres, or of several shapes, that does not turn";
    else if (body.wall() < 0 && boundary.orientation == Orientation::fixed)
      expected = "disks that turn with their boundary, as a rigid body does";
    else if (space_ && !turns_about_one_axis(boundary.motion))  // spins are along axes that turn with the plank
      expected = "a wall that turns about one axis";
    if (expected != nullptr) return fmt::format("boundary '{}': expected {}", boundary.name, expected);
  }
  return {};
}

std::string DatboxWriter::tact() const {
  const std::string alert = datbox_number(
      std::max(alert_distance(first_.system, first_.dynamics.time), first_.dynamics.interaction.cohesion_range));
  const char* grain = space_ ? "SPHER" : "DISKx";
  std::string text = "! File TACT_BEHAV\n\n" + law_text(datbox_law_of_grains, first_.dynamics, false) +
                     law_text(datbox_law_of_boundaries, first_.dynamics, true);
  // Contactors `grain` of a colour see those of another kind and colour.
  const auto add = [&](std::string_view own_colour, std::string_view contactor, std::string_view colour) {
    const bool both_free = own_colour == datbox_grains && colour == datbox_grains;
    text += fmt::format(
        "$seety\n cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert\n {}  {}  {}  {}  {}  {}  {}      {}\n\n",
        kind(), grain, own_colour, both_free ? datbox_law_of_grains : datbox_law_of_boundaries, kind(), contactor,
        colour, alert);
  };
  add(datbox_grains, grain, datbox_grains);
  add(datbox_grains, grain, datbox_boundaries);
  const std::vector<WallKind> walls = wall_kinds();
  for (const auto& [wall, contact] : walls) add(datbox_grains, wall, datbox_boundaries);
  if (first_.system.free_bodies.empty()) return text;
  for (const auto& [wall, contact] : walls)
    for (const char* colour : {datbox_grains, datbox_half_free})  // of walls that boundaries and others may touch
      for (const char* own_colour : {datbox_grains, datbox_half_free, datbox_boundaries}) add(own_colour, wall, colour);
  for (const char* own_colour : {datbox_grains, datbox_half_free, datbox_boundaries})
    add(own_colour, grain, datbox_half_free);
  for (const auto& [wall, contact] : walls) add(datbox_half_free, wall, datbox_boundaries);
  return text;
}

std::vector<DatboxWriter::Driven> DatboxWriter::driven_bodies() const {
  std::vector<Driven> all;
  for (Index number = 1; number <= count(bodies_); ++number) {
    const Body& body = bodies_[at(number - 1)];
    if (body.boundary < 0) continue;
    const Boundary& boundary = first_.system.boundaries[at(body.boundary)];
    Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
    if (body.wall() >= 0) frame = node_of(body, first_.state).frame;
    const auto numbers = [&](const RigidVelocity& v) {
      const Eigen::Vector3d spin = frame.transpose() * spin_vector(v);
      return space_ ? std::vector<double>{v.x, v.y, v.z, spin[0], spin[1], spin[2]}
                    : std::vector<double>{v.x, v.y, v.spin};
    };
    const auto add = [&](const char* kind, const Motion& motion, bool free) {
      Driven one{number, kind, motion.time, std::vector<std::vector<double>>(space_ ? 6 : 3)};
      one.oscillations.resize(one.velocity.size());
      for (std::size_t k = 0; k < one.velocity.size(); ++k) {
        if (free != (boundary.body && boundary.body->directions[space_ || k < 2 ? k : 5])) continue;
        if (free && space_ && k > 2) continue;  // no torque, see without_free
        for (const RigidVelocity& v : motion.velocity.empty() ? std::vector<RigidVelocity>{{}} : motion.velocity)
          one.velocity[k].push_back(numbers(v)[k]);
        for (const auto& [amplitude, omega, phase, ramp, growth] : motion.oscillations)
          if (const double size = numbers(amplitude)[k]; size != 0)
            one.oscillations[k].push_back({size, omega, phase, ramp, growth});
      }
      all.push_back(std::move(one));
    };
    add("vlocy", boundary.motion, false);
    if (boundary.body) add("force", boundary.body->load, true);
  }
  return all;
}

std::vector<std::pair<std::string, std::string>> DatboxWriter::driven() const {
  std::vector<std::pair<std::string, std::string>> tables;
  std::string text = "! File DRV_DOF\n\n";
  Index last = 0;
  for (const Driven& one : driven_bodies()) {  // velocities of a body come before its forces
    if (std::exchange(last, one.body) != one.body)
      text += fmt::format(
          "{}$bdyty\n {}  {:7}\n$nodty\n {}      1\n"
          "$dofty  numbr [CT......+......AMP..*..cos.(..OMEGA.*.time.+.PHI..)]...*...[RAMPI.....+.....RAMP.*.time]\n",
          text.ends_with("\n\n") ? "" : "$$$$$$\n\n", kind(), one.body, space_ ? "NO6xx" : "NO3xx");
    for (std::size_t dof = 0; dof < one.velocity.size(); ++dof) {
      const std::vector<double>& values = one.velocity[dof];
      if (values.empty()) continue;
      text += fmt::format(" {}  {:5}", one.kind, dof + 1);
      if (!one.oscillations[dof].empty()) {
        text += " " + datbox_number(values.front());
        for (const double value : one.oscillations[dof].front()) text += " " + datbox_number(value);
      } else if (is_constant(values)) {
        for (const double value : {values.front(), 0.0, 0.0, 0.0, 1.0, 0.0}) text += " " + datbox_number(value);
      } else {
        tables.emplace_back(table_name(one.kind, one.body, dof), table_text(one.time, values));
        text += " evolution " + tables.back().first;
      }
      text += "\n";
    }
  }
  tables.insert(tables.begin(), {"DRV_DOF.DAT", text + (last == 0 ? "" : "$$$$$$\n\n")});
  return tables;
}

}  // namespace nscdd
