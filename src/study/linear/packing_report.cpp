// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/packing_report.hpp"

#include "study/linear/sweep_points.hpp"

namespace nscdd {
namespace {

// Units of work done, over all grids.
struct Progress {
  const Monitor& monitor;
  Index done = 0, total = 0;
  bool stopped = false;

  bool advance() {
    stopped = stopped || !report(monitor, ++done, total);
    return !stopped;
  }
};

// `number` places among `size`, evenly spread with both ends; a single place is the first or the last.
std::vector<Index> spread_places(Index size, Index number, bool last) {
  if (number == 1) return {last ? size - 1 : 0};
  std::vector<Index> places;
  for (Index i = 0; i < number; ++i) places.push_back(i * (size - 1) / (number - 1));
  return places;
}

// Velocities of every copy without its spins, by grain and subdomain, relative to the largest speed.
std::vector<float> relative_velocities(const Interface& interface, const std::vector<Vector>& velocities, Index dofs,
                                       Index dimension) {
  double largest = 0;
  for (const Vector& v : velocities)
    for (Index k = 0; k + dofs <= v.size(); k += dofs) largest = std::max(largest, v.segment(k, dimension).norm());
  std::vector<float> all;
  for (Index grain = 0; grain < interface.grains(); ++grain)
    for (const GrainCopy& copy : interface.copies(grain))
      for (Index k = 0; k < dimension; ++k) {
        const double v = velocities[at(copy.subdomain)][dofs * copy.grain + k];
        all.push_back(static_cast<float>(largest > 0 ? v / largest : 0));
      }
  return all;
}

// Adds the slowest mode at a point of the grid, if there is one.
void keep_mode(RadiusGrid& grid, Index row, Index column, const SweepResult& result, const Decomposition& stage_one,
               Index dimension, StageOneAnswers& answers) {
  const SpectralRadius& radius = result.radius;
  const SpectrumSide side = slowest_side(radius);
  const bool low = side == SpectrumSide::low;
  const Vector& f = low ? radius.mode_min : radius.mode_max;
  if (f.size() == 0 || f.isZero(0) || !radius.converged) return;
  const bool of_copies = stage_one.interface.gluing().front().second.subdomain < 0;  // f are resultants of schwarz
  const Vector load = of_copies ? Vector(-sum_of_others(stage_one.interface, f)) : f;
  const auto velocities = answers.velocities(result.point.epsilon, mode_sign(f) * load);
  grid.modes.push_back({row, column, side, low ? radius.subdominant_min : radius.subdominant_max,
                        relative_velocities(stage_one.interface, velocities, stage_one.dofs_per_grain(), dimension)});
}

void fill(RadiusGrid& grid, const Model& model, const PackingReportParameters& parameters, const ModePlaces& places,
          Progress& progress) {
  const Selection selection = select(model, grid.contacts, grid.choice);
  const Decomposition stage_one =
      parameters.sweep.schwarz() ? whole_masses(selection.stage_one(model)) : selection.stage_one(model);
  StageOneAnswers answers(stage_one);
  SweepParameters asked = parameters.sweep;
  asked.contacts = grid.contacts;
  grid.modes_asked = count(places.rows) * count(places.columns);
  const auto take = [&](const SweepResult& result) {
    const Index row = count(grid.points) / count(asked.eta), column = count(grid.points) % count(asked.eta);
    grid.points.push_back(result);
    SpectralRadius& radius = grid.points.back().radius;
    radius.mode_min = radius.mode_max = {};
    if (places.hold(row, column)) keep_mode(grid, row, column, result, stage_one, model.problem.dimension, answers);
  };
  const Monitor on = [&](Index, Index) { return progress.advance(); };
  sweep(model, selection, asked, take, on);
  if (!parameters.optima || progress.stopped) return;
  asked.spectral.certify = false;  // as in a table of optima
  optima(
      model, selection, asked, [&](const OptimumResult& found) { grid.best.push_back(found); }, on);
}

bool has_active_contacts(const Model& model) {
  return model.problem.columns_per_contact == 1 && !model.problem.arriving_velocity.isZero(0);
}

}  // namespace

bool ModePlaces::hold(Index row, Index column) const {
  return std::ranges::binary_search(rows, row) && std::ranges::binary_search(columns, column);
}

ModePlaces mode_places(Index rows, Index columns, Index most) {
  Index first = rows, second = columns;
  for (Index stride = 2; first * second > std::max<Index>(most, 1); ++stride) {
    first = std::max<Index>(1, rows / stride);
    second = std::max<Index>(1, columns / stride);
  }
  return {spread_places(rows, first, false), spread_places(columns, second, true)};
}

std::vector<ContactSet> contact_sets_of(const Model& model) {
  std::vector<ContactSet> sets{ContactSet::all};
  if (has_active_contacts(model)) sets.push_back(ContactSet::active);
  return sets;
}

std::optional<PackingReport> report_packing(const Model& model, const PackingReportParameters& parameters,
                                            const Monitor& monitor) {
  const SweepParameters& sweep = parameters.sweep;
  PackingReport report;
  report.scale = flexibility_scale(model);
  report.scheme = sweep.scheme;
  report.inspection = inspect(model, model.has_geometry() ? 0 : ranks_up_to_by_default);
  for (const double epsilon : sweep.epsilon)
    report.epsilon.push_back(at_scale({.epsilon = epsilon}, sweep, report.scale).epsilon);
  for (const double eta : sweep.eta) report.eta.push_back(at_scale({.eta = eta}, sweep, report.scale).eta);
  for (const ContactSet contacts : parameters.contact_sets) {
    RadiusGrid& grid = report.grids.emplace_back();
    grid.contacts = contacts;
    grid.choice = choose_contacts(model, contacts);
    if (contacts == ContactSet::active) report.impulses = grid.choice.impulses;
  }
  if (report.impulses.size() == 0 && has_active_contacts(model))
    report.impulses = choose_contacts(model, ContactSet::active).impulses;
  Index copies = 0;
  for (Index grain = 0; grain < model.grains(); ++grain) copies += model.parts.interface.multiplicity(grain);
  const Index sets = count(report.grids), velocities = model.problem.dimension * std::max<Index>(1, copies);
  const ModePlaces places =
      mode_places(count(sweep.epsilon), count(sweep.eta), parameters.mode_velocities / (velocities * sets));
  const Index spectra = point_count(sweep), optima = parameters.optima ? count(sweep.epsilon) : 0;
  Progress progress{monitor, 0, sets * (spectra + optima)};
  for (RadiusGrid& grid : report.grids) {
    fill(grid, model, parameters, places, progress);
    if (progress.stopped) return std::nullopt;
  }
  return report;
}

}  // namespace nscdd
