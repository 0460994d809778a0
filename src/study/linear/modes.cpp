// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/modes.hpp"

#include "linalg/threads.hpp"
#include "study/tables/study.hpp"

#include <map>

namespace nscdd {
namespace {

// Relative difference up to which components are equal: rounding must not choose the sign of a mode.
constexpr double tie = 1e-6;

// Computes the other members of a mode from F.
void derive(Mode& mode, const Contraction& b) {
  const Vector pf = b.preconditioner.apply(mode.impulses);
  const Decomposition& parts = b.system.decomposition();
  mode.velocities = StageOneAnswers(parts).velocities(b.system.flexibility(), mode.impulses);
  mode.jumps = parts.interface.exchange(mode.velocities);
  const double lambda = (1.0 - mode.eigenvalue) / b.relaxation;
  const Vector r = mode.jumps + lambda * pf;  // - S F + lambda P F
  mode.residual = b.relaxation * std::sqrt(std::max(r.dot(b.preconditioner.solve(r)), 0.0));
  // In the rigid limit the residual of the spectrum contains the error of S.
  if (b.system.flexibility() == 0) mode.residual = std::max(mode.residual, mode.spectrum.residual);
  const Index d = parts.dofs_per_grain();
  for (Index k = 0; k < count(parts.interface.gluing()); ++k)
    mode.shares.push_back(mode.impulses.segment(d * k, d).dot(pf.segment(d * k, d)));
}

// The same of the scheme schwarz, where F is not yet normalised.
void derive_schwarz(Mode& mode, const Contraction& b) {
  const Decomposition& parts = b.system.decomposition();
  Vector& p = mode.impulses;
  const double mu = 1 - (1 - mode.eigenvalue) / b.relaxation;  // of omega = 1
  const auto work = [&](const Vector& others) { return Vector(-others.cwiseProduct(b.preconditioner.apply(p)) / mu); };
  p *= mode_sign(p) / std::sqrt(work(sum_of_others(parts.interface, p)).sum());
  const Vector others = sum_of_others(parts.interface, p), shares = work(others);
  mode.velocities = StageOneAnswers(parts).velocities(b.system.flexibility(), -others);
  mode.jumps = parts.interface.exchange(mode.velocities);
  const auto size = [&](const Vector& x) { return std::sqrt(x.dot(b.preconditioner.apply(x))); };
  mode.residual = std::max(size(b.apply(p) - mode.eigenvalue * p) / size(p), mode.spectrum.residual);
  const Index d = parts.dofs_per_grain();
  for (Index k = 0; k < shares.size() / d; ++k) mode.shares.push_back(shares.segment(d * k, d).sum());
}

// The k-th coordinate of a grain, m; of a body of a contact problem unknown.
double place_of(const Model& model, Index grain, Index k) {
  return model.has_geometry() ? model.packing.centre(grain)[at(k)] : not_a_number;
}

using Velocity = std::array<double, 3>;

Velocity velocity_of(const Mode& mode, const GrainCopy& copy, Index dimension) {
  Velocity velocity{};
  const Vector& v = mode.velocities[at(copy.subdomain)];
  for (Index k = 0; k < dimension; ++k) velocity[at(k)] = v[mode.rows.dofs_per_grain() * copy.grain + k];
  return velocity;
}

}  // namespace

// At the best eta both ends are equal and opposite: rounding must not choose, as in a sweep.
SpectrumSide slowest_side(const SpectralRadius& spectrum) {
  const bool low = std::abs(spectrum.subdominant_min) > std::abs(spectrum.subdominant_max) * (1 + 1e-9);
  return low ? SpectrumSide::low : SpectrumSide::high;
}

double mode_sign(const Vector& f) {
  const double threshold = (1 - tie) * f.cwiseAbs().maxCoeff();
  Index leading = 0;
  while (std::abs(f[leading]) < threshold) ++leading;
  return std::copysign(1.0, f[leading]);
}

Vector normalised(const Vector& f, const InterfaceOperator& preconditioner) {
  return f * (mode_sign(f) / std::sqrt(f.dot(preconditioner.apply(f))));
}

std::vector<Vector> StageOneAnswers::velocities(double epsilon, const Vector& f) {
  std::vector<Vector> velocities(parts_.subdomains.size());
  for_each_in_parallel(count(velocities), [&](Index e) {
    const Subdomain& subdomain = parts_.subdomains[at(e)];
    if (subdomain.inertia.size() == 0) return;
    auto& prepared = prepared_[at(e)];
    if (!prepared) prepared.reset(new Prepared{EnrichedInertiaFamily(subdomain, InterfaceFamily::default_dense_limit)});
    if (prepared->epsilon != epsilon) prepared->inertia.emplace(prepared->family, epsilon);
    prepared->epsilon = epsilon;
    velocities[at(e)] = prepared->inertia->solve(-parts_.interface.distribute(e, f));
  });
  return velocities;
}

Mode mode_of(const Contraction& b, SpectrumSide side, SpectralOptions options, bool certain) {
  // For the dense solver a second eigenvalue costs nothing; it shows whether the first is multiple.
  if (choose_solver(b.rows(), options).solver == SpectralSolver::dense)
    options.eigenvalues = std::max<Index>(options.eigenvalues, 2);
  Mode mode;
  mode.spectrum = spectral_radius(b, options);
  mode.side = side == SpectrumSide::slowest ? slowest_side(mode.spectrum) : side;
  const bool low = mode.side == SpectrumSide::low;
  const Vector& found = low ? mode.spectrum.mode_min : mode.spectrum.mode_max;
  const std::vector<double>& values = low ? mode.spectrum.low : mode.spectrum.high;
  mode.eigenvalue = low ? mode.spectrum.subdominant_min : mode.spectrum.subdominant_max;
  if (values.size() > 1) mode.next = values[1];
  mode.converged = certain && (mode.spectrum.converged || found.size() > 0);
  const bool nilpotent = b.schwarz() && std::abs(b.relaxation - 1 + mode.eigenvalue) <= 1e-14;  // mu = 0
  if (found.size() == 0 || nilpotent) return mode;
  mode.rows = b.system.decomposition().interface;
  mode.impulses = b.schwarz() ? found : normalised(found, b.preconditioner);
  if (b.schwarz())
    derive_schwarz(mode, b);
  else
    derive(mode, b);
  // The other end of the spectrum may not have converged.
  mode.converged = mode.converged && mode.residual <= options.tolerance * std::max(1.0, std::abs(mode.eigenvalue));
  return mode;
}

Mode interface_mode(const Model& model, const ModeParameters& parameters) {
  const Selection selection = select(model, parameters.contacts);
  if (parameters.scheme == DecompositionScheme::schwarz)
    return mode_of(schwarz_contraction(selection.stage_one(model), LinearViscous{parameters.epsilon}), parameters.side,
                   parameters.spectral, selection.certain);
  const InterfaceFamily stage_two(model.parts);
  // With the same contacts P and S are of one family, which shares data.
  const InterfaceFamily stage_one = selection.restricted ? InterfaceFamily(*selection.restricted) : stage_two;
  return mode_of({stage_two.at(parameters.eta), stage_one.at(parameters.epsilon)}, parameters.side, parameters.spectral,
                 selection.certain);
}

std::vector<InterfaceShare> shares_by_interface(const Mode& mode) {
  std::map<std::pair<Index, Index>, InterfaceShare> pairs;
  for (std::size_t k = 0; k < mode.shares.size(); ++k) {
    const Gluing& row = mode.rows.gluing()[k];
    const auto [first, second] = std::minmax(row.first.subdomain, row.second.subdomain);
    InterfaceShare& pair = pairs[{first, second}];
    pair = {first, second, pair.rows + 1, pair.share + mode.shares[k]};
  }
  std::vector<InterfaceShare> all;
  for (const auto& [key, pair] : pairs) all.push_back(pair);
  std::ranges::stable_sort(all, std::ranges::greater(), &InterfaceShare::share);
  return all;
}

double spread(const Mode& mode) {
  const Eigen::Map<const Vector> shares(mode.shares.data(), count(mode.shares));
  return std::pow(shares.lpNorm<1>(), 2) / shares.squaredNorm();
}

ResultColumns<ModeImpulse> mode_impulse_columns(Index dimension) {
  using One = ModeImpulse;
  const auto of = [](Vector Mode::*values) {
    return [=](const One& r, Index k) { return (r.mode.*values)[r.model.parts.dofs_per_grain() * r.number + k]; };
  };
  return joined<One>(
      {{{"case", "", "name of the case", [](const One& r) { return r.model.name; }},
        {"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit",
         [](const One& r) { return r.parameters.epsilon; }},
        {"eta", "1/kg", "flexibility of the network of Stage 2, inf for the generic algorithm",
         [](const One& r) { return r.parameters.eta; }},
        {"end", "", "of the spectrum without unit eigenvalues: low or high", [](const One& r) { return r.mode.side; }},
        {"eigenvalue", "1", "of the contraction operator, to which the mode belongs",
         [](const One& r) { return r.mode.eigenvalue; }},
        {"grain", "1", "number of the shared grain", [](const One& r) { return r.gluing().grain; }},
        {"subdomain_first", "1", "subdomain of the copy that feels the opposite of the impulse",
         [](const One& r) { return r.gluing().first.subdomain; }},
        {"subdomain_second", "1",
         "subdomain of the copy that feels the impulse; -1 with schwarz, whose rows are copies",
         [](const One& r) { return r.gluing().second.subdomain; }}},
       vector_columns<One>(dimension, "{}", "m", "centre; nan of a contact problem",
                           [](const One& r, Index k) { return place_of(r.model, r.gluing().grain, k); }),
       vector_columns<One>(dimension, "impulse_{}", "kg m/s",
                           "interface impulse F of the mode, F^T P F = 1 J; with schwarz the resultant on the copy",
                           of(&Mode::impulses)),
       vector_columns<One>(dimension, "jump_{}", "m/s",
                           "velocity of the first copy minus that of the second; with schwarz of the copy",
                           of(&Mode::jumps)),
       {{"share", "1", "of F^T P F; all shares add up to 1",
         [](const One& r) { return r.mode.shares[at(r.number)]; }}}});
}

void mode_impulses(const Model& model, const ModeParameters& parameters, const Mode& mode,
                   const Sink<ModeImpulse>& sink) {
  if (!mode.found()) return;
  for (Index k = 0; k < count(mode.rows.gluing()); ++k) sink({model, parameters, mode, k});
}

ResultColumns<ModeVelocity> mode_velocity_columns(Index dimension) {
  using One = ModeVelocity;
  return joined<One>(
      {{{"case", "", "name of the case", [](const One& r) { return r.model.name; }},
        {"grain", "1", "number of the grain", &One::grain},
        {"subdomain", "1", "subdomain of this copy", &One::subdomain}},
       vector_columns<One>(dimension, "{}", "m", "centre; nan of a contact problem",
                           [](const One& r, Index k) { return place_of(r.model, r.grain, k); }),
       {{"radius", "m", "radius; nan of a contact problem",
         [](const One& r) { return r.model.has_geometry() ? r.model.packing.radius[at(r.grain)] : not_a_number; }},
        {"multiplicity", "1", "subdomains that share the grain",
         [](const One& r) { return r.model.parts.interface.multiplicity(r.grain); }}},
       vector_columns<One>(dimension, "velocity_{}", "m/s",
                           "velocity of this copy that Stage 1 answers the impulses with",
                           [](const One& r, Index k) { return r.velocity[at(k)]; }),
       {{"jump", "m/s", "largest distance to the velocity of another copy; 0 for a grain of one subdomain",
         &One::jump}}});
}

void mode_velocities(const Model& model, const Mode& mode, const Sink<ModeVelocity>& sink) {
  if (!mode.found()) return;
  for (Index i = 0; i < model.parts.interface.grains(); ++i) {
    const auto copies = model.parts.interface.copies(i);
    for (const GrainCopy& copy : copies) {
      const Velocity v = velocity_of(mode, copy, model.problem.dimension);
      double jump = 0;
      for (const GrainCopy& other : copies) {
        const Velocity w = velocity_of(mode, other, model.problem.dimension);
        jump = std::max(jump, model.problem.dimension == 2 ? std::hypot(v[0] - w[0], v[1] - w[1])
                                                           : std::hypot(v[0] - w[0], v[1] - w[1], v[2] - w[2]));
      }
      sink({model, i, copy.subdomain, v, jump});
    }
  }
}

}  // namespace nscdd
