// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/step_contacts.hpp"

namespace nscdd {
namespace {

// Whether the step is too long: the overlap grew on the path of bodies apart before (step 0: within largest_overlap).
bool is_of_step(const DeepOverlap& one, const StepStart& start) {
  const auto& [system, state, interaction, scheme] = start;
  if (one.overlap <= one.before) return false;
  if (state.step == 0) return one.before <= largest_overlap * system.smaller_radius(one.a, one.b);
  const double alert = interaction.on_velocity() ? 0 : alert_distance(system, scheme);
  return -one.before > alert;
}

// Largest ratio of speeds after and before an impact, for a light body that a heavy one throws.
double thrown(const DeepOverlap& one, const StepStart& start) {
  const auto& [system, state, interaction, scheme] = start;
  const double a = system.inverse_mass(system.node_of(one.a)), b = system.inverse_mass(system.node_of(one.b));
  const double restitution = system.pairs.of(one.a, one.b).restitution.value_or(interaction.restitution);
  return std::max(1.0, (1 + restitution) * std::max(a, b) / (a + b));
}

// A step that is short enough for two bodies: it must not move them, or bodies they meet next, further than they may
// overlap. If there are only two bodies, without restitution, the first step may be longer: contacts are foreseen, and
// the time of the largest overlap accepted is known.
double short_enough(const DeepOverlap& one, const StepStart& start) {
  const auto& [system, state, interaction, scheme] = start;
  const double h = scheme.step, small = system.smaller_radius(one.a, one.b);
  const double gravity = std::hypot(scheme.gravity[0], scheme.gravity[1], scheme.gravity[2]);
  const double speed = one.path / one.time + gravity * h / 2;
  const bool two = system.grains() + count(system.walls) == 2;
  if (two && state.step == 0 && !interaction.on_velocity() && std::isfinite(one.reached))
    return std::min(one.reached / (1 - scheme.theta), largest_move / 4 * small / speed);
  return safe_part * largest_overlap * small / (speed * (two ? 1 : thrown(one, start)));
}

double rounded_down(double step) {  // to three digits
  const double unit = std::pow(10, std::floor(std::log10(step)) - 2);
  return unit * std::floor(step / unit);
}

[[noreturn]] void refuse(const StepStart& start, const DeepOverlap& one, double safe) {
  const auto& [system, state, interaction, scheme] = start;
  const std::string from = state.step == 0 ? "since the run began" : "since contacts were found last";
  throw Error("dynamics.step",
              fmt::format("expected at most {:g} s, met {} s, which is too long: {} and {} moved by {:.3g} m relative "
                          "to each other {}, {:.3g} of the smaller radius, and overlap by up to {:.3g} m on the way",
                          safe, scheme.step, body_name(system, one.a), body_name(system, one.b), one.path, from,
                          one.path / system.smaller_radius(one.a, one.b), one.overlap));
}

bool all_finite(const StepStart& start) {
  const auto finite = [](double one) { return std::isfinite(one); };
  const auto motions = step_motions(start);
  const auto poses = poses_at_contacts(start);
  for (Index i = 0; i < start.system.grains(); ++i)
    if (!std::ranges::all_of(centre_of(start.state, at(i)), finite) ||
        !std::ranges::all_of(free_motion(start, poses, motions, i), finite))
      return false;
  return true;
}

}  // namespace

double safe_step(const StepStart& start) {
  if (!all_finite(start)) return 0;
  const auto& [system, state, interaction, scheme] = start;
  TimeStepping shorter = scheme;
  const StepStart tried{system, state, interaction, shorter};
  constexpr double met = largest_overlap / 2;      // a grain may meet another that is as fast
  const bool bounces = interaction.on_velocity();  // then contacts of this step are not foreseen
  constexpr int most_tries = 100;
  for (int k = 0; k < most_tries; ++k) {
    double least = shorter.step;
    const auto motions = step_motions(tried);
    const auto poses = poses_at_contacts(tried);
    for (Index i = 0; i < system.grains(); ++i) {
      const double speed = system.length(velocity_of(free_motion(tried, poses, motions, i)));
      if (shorter.step * speed > largest_move * system.radius[at(i)])
        least = std::min(least, safe_part * (state.step == 0 ? largest_move : met) * system.radius[at(i)] / speed);
    }
    if (least == shorter.step)
      for (const DeepOverlap& one : Passage::too_deep(Path::whole(tried, bounces))) {
        if (!is_of_step(one, tried)) continue;
        const double found = short_enough(one, tried);
        least = std::min(least, found < shorter.step ? found : safe_part * shorter.step);
      }
    if (least == shorter.step) break;
    shorter.step = least;
  }
  return rounded_down(shorter.step);
}

void check_overlaps(const StepStart& start, const std::vector<DeepOverlap>& found) {
  if (found.empty()) return;
  const GranularSystem& system = start.system;
  std::vector<DeepOverlap> deep = Passage::too_deep(Path::whole(start, false));
  if (deep.empty()) deep = found;
  // A boundary that turned back from a known contact did no harm.
  std::erase_if(deep, [&](const DeepOverlap& one) {
    return one.overlap <= largest_overlap * system.smaller_radius(one.a, one.b) && !is_of_step(one, start);
  });
  if (deep.empty()) return;
  std::ranges::sort(deep, {}, body_pair);
  for (const DeepOverlap& one : deep)
    if (!is_of_step(one, start))
      fail("{} and {}: expected an overlap of at most {} of the smaller radius, {:.4g} m, met {:.4g} m{}",
           body_name(system, one.a), body_name(system, one.b), largest_overlap,
           largest_overlap * system.smaller_radius(one.a, one.b), one.overlap,
           one.b < system.grains() ? "" : "; does the wall face its grains?");
  refuse(start, deep.front(), safe_step(start));
}

void check_end_of_step(const StepStart& start, const std::vector<GrainMotion>& velocities) {
  const auto& [system, state, interaction, scheme] = start;
  if (end_is_near(start, velocities)) return;
  GranularState at_end;
  for (const auto values : numbers_of_grains(system.dimension)) at_end.*values = state.*values;
  at_end.poses = state.poses;
  at_end.body_velocities = state.body_velocities;
  at_end.step = state.step;
  at_end.time = state.time;
  const StepStart after{system, at_end, interaction, scheme};
  finish_step(after, at_end, velocities, {});
  std::vector<DeepOverlap> deep = Passage::too_deep(Path::to_end(after));
  std::erase_if(deep, [&](const DeepOverlap& one) { return !is_of_step(one, after); });
  if (deep.empty()) return;
  std::ranges::sort(deep, {}, body_pair);
  double safe = scheme.step;
  for (const DeepOverlap& one : deep) safe = std::min(safe, short_enough(one, after));
  refuse(after, deep.front(), rounded_down(safe));
}

}  // namespace nscdd
