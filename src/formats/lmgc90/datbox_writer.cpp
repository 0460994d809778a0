// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_writer.hpp"

#include "core/fail.hpp"

#include <numbers>

namespace nscdd {
namespace {

std::string sizes_of(const DatboxContactor& one) {
  if (one.wall == "PLANx") return datbox_named({{"axe1=", one.length}, {"axe2=", one.width}, {"axe3=", one.thickness}});
  if (one.wall == "JONCx") return datbox_named({{"ax1 =", one.length}, {"ax2 =", one.thickness}});
  return (one.cylinder() ? datbox_named({{"High=", one.length}}) : "") + datbox_named({{"byrd=", one.radius}});
}

std::string frame_lines(const DatboxContactor& one) {
  return fmt::format("{:29}localframe\n", "") + datbox_three("alp{}=", one.frame.col(0)) +
         datbox_three("bet{}=", one.frame.col(1)) + datbox_three("gam{}=", one.frame.col(2)) +
         datbox_three("coo{}=", one.shift);
}

}  // namespace

std::string datbox_line(DatboxNumbers values) { return fmt::format("{:27}{}\n", "", datbox_named(values)); }

std::string datbox_three(const char* names, const Vector3& values, int first) {
  const auto name = [&](int k) { return fmt::format(fmt::runtime(names), first + k); };
  return datbox_line({{name(0), values[0]}, {name(1), values[1]}, {name(2), values[2]}});
}

std::string datbox_head(const char* title, Index step, double time) {
  return fmt::format("\n! {}\n\n$steps{:9}{:14}time={}\n\n{}", title, step, "", datbox_number(time), datbox_ruler);
}

DatboxWriter::DatboxWriter(const Simulation& first)
    : first_(first), space_(first.system.dimension == 3), planks_(first.system.walls.size()) {
  const GranularSystem& system = first_.system;
  for (const Boundary& boundary : system.boundaries)
    if (boundary.source)
      fail("LMGC90: boundary '{}': expected bodies that are there from the beginning, met a source of grains",
           boundary.name);
  number_bodies();
  for (const Wall& wall : system.walls)
    if (!space_ && wall.round() && wall.radius < 0)
      fail(
          "LMGC90: boundary '{}': expected a cylinder in the plane with grains inside, met one with grains outside, "
          "which is a driven grain there",
          system.boundaries[at(wall.boundary)].name);
  double mass = 0, size = 0;
  Vector3 low = Vector3::Constant(infinity), high = -low;
  for (std::size_t i = 0; i < system.radius.size(); ++i) {
    margin_ = std::max(margin_, system.radius[i]);
    low = low.cwiseMin(centre(first_.state, i));
    high = high.cwiseMax(centre(first_.state, i));
    if (system.driven_by[i] >= 0) continue;
    mass += system.mass[i];
    size += space_ ? datbox_volume(system.radius[i]) : std::numbers::pi * system.radius[i] * system.radius[i];
  }
  if (size > 0) density_ = mass / size;  // else there are clumps only, which have masses of their own
  const double extent = space_ ? (high - low).norm() : high.head<2>().maxCoeff() - low.head<2>().minCoeff();
  for (std::size_t w = 0; w < planks_.size(); ++w) lay_plank(w, extent + margin_);
}

std::string DatboxWriter::bodies() const {
  const GranularSystem& system = first_.system;
  std::string text = "! File BODIES\n\n";
  for (Index number = 1; number <= count(bodies_); ++number) {
    const Body& body = bodies_[at(number - 1)];
    const Node node = node_of(body, first_.state);
    const FreeBody* free = free_body(body);
    const bool grain = free == nullptr && (space_ ? body.wall() < 0 : body.boundary < 0);  // of others radii are unused
    const double radius = grain ? system.radius[body.grains[0]] : margin_;
    const double size = body.boundary < 0 ? system.mass[body.grains[0]] / density_ : datbox_volume(radius);
    text += fmt::format("$bdyty\n {}{:{}}\n$blmty\n PLAIN      1  behav  {}", kind(), number, space_ ? 9 : 7,
                        datbox_grains);
    if (space_) {
      const double volume = free != nullptr ? free->mass / density_ : size;
      const double average = grain || free != nullptr ? std::cbrt(0.75 * volume / std::numbers::pi) : margin_;
      Vector3 inertia = Vector3::Constant(grain || free != nullptr ? 0.4 * radius * radius * volume : 0);
      if (free != nullptr && free->free(BodyDirection::spin))
        inertia = inertia_in(*free, body, node.frame).diagonal() / density_;
      text += datbox_named({{"avrd=", average}}) + "\n" + datbox_three("I{}  =", inertia);
    } else {
      const double mass = free != nullptr ? free->mass : grain ? system.mass[body.grains[0]] : 0;
      const double average = mass > 0 ? std::sqrt(mass / (density_ * std::numbers::pi)) : margin_;
      const double gyration = free != nullptr && free->inertia[2] > 0 ? std::sqrt(free->inertia[2] / free->mass)
                              : grain                                 ? radius / std::numbers::sqrt2
                                                                      : margin_;
      text += datbox_named({{"avrd=", average}, {"gyrd=", gyration}}) + "\n";
    }
    text += node_text("coo{}=", node.place, node.angle);
    text += "$tacty\n" + contactor_lines(body, node) + "$$$$$$\n\n";
  }
  return text;
}

// A place and an angle; in space a place and three angles 0. The first three numbers are on the line of the node.
std::string DatboxWriter::node_text(const char* names, const Vector3& place, double angle) const {
  const Vector3 first(place[0], place[1], space_ ? place[2] : angle);
  return fmt::format("$nodty\n {}      1", space_ ? "NO6xx" : "NO3xx") + datbox_three(names, first).substr(13) +
         (space_ ? datbox_three(names, Vector3::Zero(), 4) : "");
}

const char* DatboxWriter::colour_of(const Body& body) const {
  const GranularSystem& system = first_.system;
  const Index one = static_cast<Index>(body.grains.empty() ? at(system.grains()) + body.walls[0] : body.grains[0]);
  return !system.is_boundary(one) ? datbox_grains : system.moves(one) ? datbox_half_free : datbox_boundaries;
}

std::vector<DatboxContactor> DatboxWriter::contactors_of(const Body& body, const Node& node) const {
  const Matrix3 into =
      Eigen::AngleAxisd(-node.angle, Vector3::UnitZ()) * node.frame.transpose();  // the axes of the body
  std::vector<DatboxContactor> all;
  for (const std::size_t i : body.grains)
    all.push_back({.radius = first_.system.radius[i], .shift = into * (centre(first_.state, i) - node.place)});
  for (const std::size_t w : body.walls) {
    const auto& [frame, thickness, length, width, along, across] = planks_[w];
    const Wall& wall = first_.system.walls[w];
    DatboxContactor& one = all.emplace_back(DatboxContactor{.wall = std::string(wall_kind(w).contactor),
                                                            .radius = wall.round() ? std::abs(wall.radius) : 0,
                                                            .length = length,
                                                            .thickness = thickness,
                                                            .width = width,
                                                            .frame = node.frame});
    if (body.wall() >= 0) continue;  // its own frame becomes that of the body
    const Node own = plank_node(w, first_.state.poses[at(body.boundary)]);
    one.shift = into * (own.place - node.place);
    one.frame = into * own.frame;
  }
  return all;
}

std::string DatboxWriter::contactor_lines(const Body& body, const Node& node) const {
  const bool cluster = space_ ? free_body(body) != nullptr : body.boundary >= 0;
  const std::string grain = space_ ? (cluster ? "SPHEb" : "SPHER") : cluster ? "DISKb" : "DISKx";
  std::string text;
  Index number = 0;
  for (const DatboxContactor& one : contactors_of(body, node)) {
    const bool wall = !one.wall.empty();
    text += fmt::format(" {}  {:5}  color  {}{}\n", wall ? one.wall : grain, ++number, colour_of(body), sizes_of(one));
    if (wall && space_ && one.wall != "DNLYC") text += frame_lines(one);  // the axes of DNLYC are those of DOF
    if (wall || !cluster) continue;
    text +=
        space_ ? datbox_three("coo{}=", one.shift) : datbox_line({{"coo1=", one.shift[0]}, {"coo2=", one.shift[1]}});
  }
  return text;
}

std::string DatboxWriter::bulk() const {
  const auto gravity = gravity_of(first_.dynamics.time, space_ ? 3 : 2);
  return fmt::format("! File BEHAVIOUR\n\n$gravy\n{:17}{}\n\n$behav  lawty\n {}  {:30}{}\n", "",
                     datbox_named({{"grv1=", gravity[0]}, {"grv2=", gravity[1]}, {"grv3=", gravity[2]}}), datbox_grains,
                     "RIGID", datbox_named({{"Umas=", density_}}));
}

std::string DatboxWriter::dof(const TrajectoryStep& step) const {
  const GranularSystem& system = first_.system;
  const GranularState& state = step.state;
  std::vector<RigidVelocity> motions = boundary_velocities(system, state, state.time);
  for (std::size_t k = 0; state.step == 0 && k < motions.size(); ++k)
    motions[k] = system.boundaries[k].motion.initial.value_or(motions[k]);
  std::string text = datbox_head("DOF", state.step, state.time);
  for (Index number = 1; number <= count(bodies_); ++number) {
    const Body& body = bodies_[at(number - 1)];
    const auto b = static_cast<std::size_t>(body.boundary);
    const Node now = node_of(body, state);
    const Matrix3& frame = now.frame;
    const Vector3 moved = now.place - node_of(body, first_.state).place;
    Vector3 velocity, spin = Vector3::Zero();
    double turned = 0;  // in the plane
    if (body.boundary < 0) {
      const std::size_t i = body.grains[0];
      velocity << state.velocity_x[i], state.velocity_y[i], space_ ? state.velocity_z[i] : 0;
      spin << (space_ ? state.spin_x[i] : 0), (space_ ? state.spin_y[i] : 0), state.spin[i];
      if (!space_) turned = state.angle[i];
    } else {
      velocity =
          datbox_vector(velocity_of_point(motions[b], state.poses[b], {now.place[0], now.place[1], now.place[2]}));
      if (!space_ || body.wall() >= 0 || system.boundaries[b].orientation == Orientation::turning)
        spin = spin_vector(motions[b]);
      turned = state.poses[b].angle - first_.state.poses[b].angle;
    }
    text += fmt::format("$bdyty\n {}  {:7}\n", kind(), number) + node_text("X({})=", moved, turned) +
            datbox_three("V({})=", space_ ? velocity : Vector3(velocity[0], velocity[1], spin[2]));
    if (space_)
      text += datbox_three("V({})=", frame.transpose() * spin, 4) + datbox_three("a({})=", frame.col(0)) +
              datbox_three("b({})=", frame.col(1)) + datbox_three("g({})=", frame.col(2));
    text += "$$$$$$\n\n";
  }
  return text + datbox_ruler;
}

}  // namespace nscdd
