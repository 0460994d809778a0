// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/passage.hpp"

namespace nscdd {
namespace {

// Whether bodies came together on their way, rather than that they overlapped before or that contacts did not hold.
bool is_of_step(const DeepOverlap& one, const GranularSystem& system, const GranularState& state,
                const Interaction& interaction, const TimeStepping& scheme) {
  if (one.overlap <= one.before) return false;
  if (state.step == 0) return one.before <= largest_overlap * smaller_radius(system, one.a, one.b);
  const double alert = interaction.restitution > 0 ? 0 : scheme.alert * std::ranges::min(system.radius);
  return -one.before > alert;
}

// Largest ratio of speeds after and before an impact, for a light body that a heavy one throws.
double thrown(const DeepOverlap& one, const GranularSystem& system, const Interaction& interaction) {
  const auto inverse_mass = [&](Index body) {
    return body < system.grains() && system.free(body) ? 1 / system.mass[at(body)] : 0;
  };
  const double a = inverse_mass(one.a), b = inverse_mass(one.b);
  return std::max(1.0, (1 + interaction.restitution) * std::max(a, b) / (a + b));
}

// A step that is short enough for two bodies. Contacts are found wherever bodies are then, so that a step must not move
// them, or what they meet next, further than they may overlap. Of two bodies alone more is known in the first step,
// unless they bounce: contacts that are not reached yet are foreseen, and it is known when bodies overlap too far.
double short_enough(const DeepOverlap& one, const GranularSystem& system, const GranularState& state,
                    const Interaction& interaction, const TimeStepping& scheme) {
  const double h = scheme.step, small = smaller_radius(system, one.a, one.b);
  const double gravity = std::hypot(scheme.gravity[0], scheme.gravity[1], scheme.gravity[2]);
  const double speed = one.path / one.time + gravity * h / 2;
  const bool two = system.grains() + count(system.walls) == 2;
  if (two && state.step == 0 && interaction.restitution == 0 && std::isfinite(one.reached))
    return std::min(one.reached / (1 - scheme.theta), largest_move / 4 * small / speed);
  return safe_part * largest_overlap * small / (speed * (two ? 1 : thrown(one, system, interaction)));
}

// To three digits, downwards.
double rounded_down(double step) {
  const double unit = std::pow(10, std::floor(std::log10(step)) - 2);
  return unit * std::floor(step / unit);
}

[[noreturn]] void refuse(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme,
                         const DeepOverlap& one, double safe) {
  const std::string from = state.step == 0 ? "since the run began" : "since contacts were found last";
  throw Error("dynamics.step",
              fmt::format("expected at most {:g} s, met {} s, which is too long: {} and {} moved by {:.3g} m relative "
                          "to each other {}, {:.3g} of the smaller radius, and overlap by up to {:.3g} m on the way",
                          safe, scheme.step, body_name(system, one.a), body_name(system, one.b), one.path, from,
                          one.path / smaller_radius(system, one.a, one.b), one.overlap));
}

void sort(std::vector<DeepOverlap>& deep) {
  std::ranges::sort(deep, {}, [](const DeepOverlap& one) { return std::pair(one.a, one.b); });
}

template <int D>
bool all_finite(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  const auto finite = [](double one) { return std::isfinite(one); };
  const auto motions = step_motions(system, state, scheme);
  for (Index i = 0; i < system.grains(); ++i)
    if (!std::ranges::all_of(centre_of<D>(state, at(i)), finite) ||
        !is_finite(free_velocity<D>(system, state, scheme, motions, i)))
      return false;
  return true;
}

}  // namespace

template <int D>
double safe_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                 const TimeStepping& scheme) {
  if (!all_finite<D>(system, state, scheme)) return 0;
  TimeStepping shorter = scheme;
  // A grain that was thrown in the run so far met another that came at it as fast: half of what they may overlap each.
  constexpr double met = largest_overlap / 2;
  const bool bounces = interaction.restitution > 0;  // then contacts of this step are not foreseen
  constexpr int most_tries = 100;
  for (int k = 0; k < most_tries; ++k) {
    double least = shorter.step;
    const auto motions = step_motions(system, state, shorter);
    for (Index i = 0; i < system.grains(); ++i) {
      const double speed = speed_of<D>(free_velocity<D>(system, state, shorter, motions, i));
      if (shorter.step * speed > largest_move * system.radius[at(i)])
        least = std::min(least, safe_part * (state.step == 0 ? largest_move : met) * system.radius[at(i)] / speed);
    }
    if (least == shorter.step)
      for (const DeepOverlap& one : Passage<D>::too_deep(system, Path<D>::whole(system, state, shorter, bounces))) {
        if (!is_of_step(one, system, state, interaction, shorter)) continue;
        const double found = short_enough(one, system, state, interaction, shorter);
        least = std::min(least, found < shorter.step ? found : safe_part * shorter.step);
      }
    if (least == shorter.step) break;
    shorter.step = least;
  }
  return rounded_down(shorter.step);
}

template <int D>
void check_overlaps(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                    const TimeStepping& scheme, const std::vector<DeepOverlap>& found) {
  if (found.empty()) return;
  // Now it is worth following all pairs.
  std::vector<DeepOverlap> deep = Passage<D>::too_deep(system, Path<D>::whole(system, state, scheme, false));
  if (deep.empty()) deep = found;
  // A boundary that turned back from a contact that was known has done no harm.
  std::erase_if(deep, [&](const DeepOverlap& one) {
    return one.overlap <= largest_overlap * smaller_radius(system, one.a, one.b) &&
           !is_of_step(one, system, state, interaction, scheme);
  });
  if (deep.empty()) return;
  sort(deep);
  for (const DeepOverlap& one : deep)
    if (!is_of_step(one, system, state, interaction, scheme))
      fail("{} and {}: expected an overlap of at most {} of the smaller radius, met {} m", body_name(system, one.a),
           body_name(system, one.b), largest_overlap, one.overlap);
  refuse(system, state, scheme, deep.front(), safe_step<D>(system, state, interaction, scheme));
}

template <int D>
void check_end_of_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                       const TimeStepping& scheme, const std::vector<GrainUnknowns<D>>& velocities) {
  if (Path<D>::is_short(system, state, scheme, velocities)) return;
  GranularState after;
  for (const auto values : numbers_of_grains(D)) after.*values = state.*values;
  after.poses = state.poses;
  after.step = state.step;
  finish_step<D>(system, after, scheme, velocities, {});
  std::vector<DeepOverlap> deep = Passage<D>::too_deep(system, Path<D>::to_end(system, after, scheme));
  std::erase_if(deep, [&](const DeepOverlap& one) { return !is_of_step(one, system, after, interaction, scheme); });
  if (deep.empty()) return;
  sort(deep);
  double safe = scheme.step;
  for (const DeepOverlap& one : deep) safe = std::min(safe, short_enough(one, system, after, interaction, scheme));
  refuse(system, after, scheme, deep.front(), rounded_down(safe));
}

template double safe_step<2>(const GranularSystem&, const GranularState&, const Interaction&, const TimeStepping&);
template double safe_step<3>(const GranularSystem&, const GranularState&, const Interaction&, const TimeStepping&);
template void check_overlaps<2>(const GranularSystem&, const GranularState&, const Interaction&, const TimeStepping&,
                                const std::vector<DeepOverlap>&);
template void check_overlaps<3>(const GranularSystem&, const GranularState&, const Interaction&, const TimeStepping&,
                                const std::vector<DeepOverlap>&);
template void check_end_of_step<2>(const GranularSystem&, const GranularState&, const Interaction&, const TimeStepping&,
                                   const std::vector<GrainUnknowns<2>>&);
template void check_end_of_step<3>(const GranularSystem&, const GranularState&, const Interaction&, const TimeStepping&,
                                   const std::vector<GrainUnknowns<3>>&);

}  // namespace nscdd
