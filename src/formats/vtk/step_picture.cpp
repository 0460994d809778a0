// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/vtk/step_picture.hpp"

#include "core/fail.hpp"
#include "formats/trajectory/trajectory_layout.hpp"

#include <set>

namespace nscdd {
namespace {

using Integers = std::vector<std::int64_t>;

// A step as it is drawn. A contact is on a wall if its second body is no grain.
struct Scene {
  const GranularSystem& system;
  const GranularState& state;
  const std::vector<TrajectoryContact>& contacts;
  std::size_t grains = state.x.size();
  std::size_t feet = at(std::ranges::count_if(contacts, [&](const auto& c) { return on_wall(c); }));

  bool in_space() const { return system.dimension == 3; }
  bool on_wall(const TrajectoryContact& contact) const { return contact.geometry.b >= system.grains(); }
};

void check(const Scene& scene) {
  const auto& [system, state, contacts, n, feet] = scene;
  if (system.radius.size() != n) fail("VTK: expected {} values of radius, met {}", n, system.radius.size());
  if (system.driven_by.size() != n) fail("VTK: expected {} values of driven_by, met {}", n, system.driven_by.size());
  const bool in_space = scene.in_space();  // spins of disks are not drawn
  const auto spin = &GranularState::spin;
  for (const auto& array : layout::state_arrays(system.dimension))
    if (const std::size_t size = (state.*(array.values)).size(); size != n && (in_space || array.values != spin))
      fail("VTK: expected {} values of {}, met {}", n, array.name, size);
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (const auto& [a, b] = std::pair(contacts[k].geometry.a, contacts[k].geometry.b);
        a < 0 || a >= system.grains() || b < 0)
      fail("VTK: contact {}: expected two of {} grains, or a grain and a wall, met {} and {}", k, n, a, b);
}

// The values of grains, followed by `value` for each foot.
template <class Value>
std::vector<Value> with_feet(const Scene& scene, std::vector<Value> values, Value value) {
  values.resize(values.size() + scene.feet, value);
  return values;
}

// The values of grains, followed by what `get` finds in each contact.
template <class Value, class Get>
std::vector<Value> with_contacts(const Scene& scene, std::vector<Value> values, Get get) {
  for (const TrajectoryContact& contact : scene.contacts)
    values.push_back(static_cast<Value>(std::invoke(get, contact)));
  return values;
}

// The subdomains that hold each grain are those of its contacts.
std::vector<std::set<Index>> holders(const Scene& scene) {
  std::vector<std::set<Index>> held(scene.grains);
  for (const TrajectoryContact& contact : scene.contacts) {
    held[at(contact.geometry.a)].insert(contact.subdomain);
    if (!scene.on_wall(contact)) held[at(contact.geometry.b)].insert(contact.subdomain);
  }
  return held;
}

std::vector<double> points_of(const Scene& scene) {
  std::vector<double> points;
  for (std::size_t i = 0; i < scene.grains; ++i)
    points.insert(points.end(), {scene.state.x[i], scene.state.y[i], scene.in_space() ? scene.state.z[i] : 0.0});
  for (const TrajectoryContact& c : scene.contacts)
    if (scene.on_wall(c)) points.insert(points.end(), c.geometry.point.begin(), c.geometry.point.end());
  return points;
}

std::vector<PictureArray> point_arrays_of(const Scene& scene, const Integers& subdomain, const Integers& multiplicity) {
  const GranularState& state = scene.state;
  std::vector<double> velocity;
  for (std::size_t i = 0; i < scene.grains; ++i)
    velocity.insert(velocity.end(),
                    {state.velocity_x[i], state.velocity_y[i], scene.in_space() ? state.velocity_z[i] : 0.0});
  velocity.resize(3 * (scene.grains + scene.feet), 0.0);
  constexpr std::int64_t none = -1, no_subdomain = 0;
  const auto& driven_by = scene.system.driven_by;
  std::vector<PictureArray> arrays{{"radius", with_feet(scene, scene.system.radius, 0.0)},
                                   {"id", with_feet(scene, counted(scene.grains, 0, 1), none)},
                                   {"boundary", with_feet(scene, Integers(driven_by.begin(), driven_by.end()), none)},
                                   {"subdomain", with_feet(scene, subdomain, none)},
                                   {"multiplicity", with_feet(scene, multiplicity, no_subdomain)}};
  if (scene.in_space()) {
    std::vector<double> turn, spin;
    for (std::size_t i = 0; i < scene.grains; ++i) {
      turn.insert(turn.end(), {state.turn_w[i], state.turn_x[i], state.turn_y[i], state.turn_z[i]});
      spin.insert(spin.end(), {state.spin_x[i], state.spin_y[i], state.spin[i]});
    }
    turn.resize(4 * (scene.grains + scene.feet), 0.0);
    spin.resize(3 * (scene.grains + scene.feet), 0.0);
    arrays.push_back({"turn", std::move(turn), 4});
    arrays.push_back({"spin", std::move(spin), 3});
  } else {
    arrays.push_back({"angle", with_feet(scene, state.angle, 0.0)});
  }
  arrays.push_back({"velocity", std::move(velocity), 3});
  return arrays;
}

// Of each contact what its subdomain was in this step; -1 for grains.
void add_models(const Scene& scene, std::vector<PictureArray>& arrays) {
  const auto of = [&](auto RememberedModel::*value) {
    return [&scene, value](const TrajectoryContact& c) { return scene.state.models[at(c.subdomain)].*value; };
  };
  const Integers none(scene.grains, -1);
  const std::vector<double> unknown(scene.grains, -1.0);
  arrays.push_back({"switched", with_contacts(scene, none, of(&RememberedModel::switched))});
  arrays.push_back({"switched_iterations", with_contacts(scene, none, of(&RememberedModel::switched_iterations))});
  arrays.push_back({"switch_backs", with_contacts(scene, none, of(&RememberedModel::switch_backs))});
  arrays.push_back({"velocity_distance", with_contacts(scene, unknown, of(&RememberedModel::velocity_distance))});
  arrays.push_back({"impulse_distance", with_contacts(scene, unknown, of(&RememberedModel::impulse_distance))});
}

std::vector<PictureArray> cell_arrays_of(const Scene& scene, const Integers& subdomain) {
  const std::size_t n = scene.grains;
  const std::vector<double> zero(n);
  std::vector<PictureArray> arrays{
      {"kind", with_contacts(scene, Integers(n, 0), [](const auto&) { return 1; })},
      {"subdomain", with_contacts(scene, subdomain, &TrajectoryContact::subdomain)},
      {"impulse_n", with_contacts(scene, zero, [](const auto& c) { return c.impulse.n; })},
      {"impulse_t",
       with_contacts(scene, zero, [&](const auto& c) { return scene.in_space() ? c.tangential() : c.impulse.t; })},
      {"status", with_contacts(scene, Integers(n, -1), &TrajectoryContact::status)},
      {"gap", with_contacts(scene, zero, [](const auto& c) { return c.geometry.gap; })}};
  if (!scene.state.models.empty()) add_models(scene, arrays);
  return arrays;
}

Integers lines_of(const Scene& scene) {
  Integers ends;
  auto foot = static_cast<std::int64_t>(scene.grains);
  for (const TrajectoryContact& c : scene.contacts)
    ends.insert(ends.end(), {c.geometry.a, scene.on_wall(c) ? foot++ : c.geometry.b});
  return ends;
}

}  // namespace

Integers counted(std::size_t n, std::int64_t first, std::int64_t step) {
  Integers result(n);
  for (std::size_t i = 0; i < n; ++i) result[i] = first + step * static_cast<std::int64_t>(i);
  return result;
}

StepPicture picture_of(const GranularSystem& system, const TrajectoryStep& step) {
  const Scene scene{system, step.state, step.contacts};
  check(scene);
  Integers subdomain, multiplicity;
  for (const std::set<Index>& held : holders(scene)) {
    subdomain.push_back(held.empty() ? -1 : *held.begin());
    multiplicity.push_back(count(held));
  }
  return {.time = step.state.time,
          .points = points_of(scene),
          .vertices = counted(scene.grains, 0, 1),
          .lines = lines_of(scene),
          .point_arrays = point_arrays_of(scene, subdomain, multiplicity),
          .cell_arrays = cell_arrays_of(scene, subdomain)};
}

}  // namespace nscdd
