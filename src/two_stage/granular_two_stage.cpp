// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/granular_two_stage.hpp"

#include "linalg/threads.hpp"
#include "mechanics/contact_blocks.hpp"

namespace nscdd {
namespace {

// The larger of both; NaN remains, because it must not pass for converged.
double at_least(double floor, double value) { return value < floor ? floor : value; }

// F over the mass of a copy in each row of the gluing, m/s.
template <int D>
Vector speeds_of_interface_impulses(const GranularDecomposition<D>& parts, const Vector& f) {
  Vector speeds = Vector::Zero(f.size());
  for (Index row = 0; row < count(parts.copy_mass); ++row)
    if (const double mass = parts.copy_mass[at(row)]; mass > 0)
      for (Index k = unknowns_of_grain<D> * row; k < unknowns_of_grain<D> * (row + 1); ++k) speeds[k] = f[k] / mass;
  return speeds;
}

double ratio(double change, double whole) { return change == 0 ? 0.0 : std::sqrt(change / whole); }

}  // namespace

ContactResidual added_up(const std::vector<ContactResidual>& of_subdomains, const Processes& processes) {
  constexpr Index sums = 11, maxima = 2;
  const auto numbers_of = [](auto& r) {  // the maxima last
    return std::tie(r.natural_map, r.impulses, r.violation, r.work, r.scale_work, r.scale_velocity, r.squared_work,
                    r.active, r.stick, r.slide, r.loaded, r.largest_violation, r.largest_squared_work);
  };
  Eigen::MatrixXd numbers(sums + maxima, count(of_subdomains));
  for (Index e = 0; e < numbers.cols(); ++e) {
    const auto set = [&](auto... number) { numbers.col(e) = Eigen::Vector<double, sums + maxima>(double(number)...); };
    std::apply(set, numbers_of(of_subdomains[at(e)]));
  }
  const Vector sum = processes.sum_of_parts(std::move(numbers), maxima);
  ContactResidual result;
  auto take = [next = sum.begin()](auto&... number) mutable {
    ((number = static_cast<std::remove_reference_t<decltype(number)>>(*next++)), ...);
  };
  std::apply(take, numbers_of(result));
  return result;
}

template <int D>
GranularTwoStage<D>::GranularTwoStage(GranularDecomposition<D> parts, const ContactLaw& law, const StepSolver& solver,
                                      std::optional<InterfaceOperator> enriched)
    : parts_(std::move(parts)),
      law_(law),
      solver_(solver),
      enriched_(std::move(enriched)),
      impulse_floor_squared_(ImpulseScale::squared_rounding * parts_.scale.momenta) {
  if (enriched_ && !enriched_->decomposition().interface.same_rows(parts_.interface))
    throw Error("enriched Stage 2: expected an operator with the gluing of this step, met one with another");
}

template <int D>
void GranularTwoStage<D>::start(const std::vector<RememberedGluing>& gluing) {
  for (GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      if (const LocalVector<D> r = subdomain.contacts.impulse(k); carries(r))
        apply_impulse(subdomain.contact(k), r, subdomain.velocities);
  if (parts_.copies == CopyMass::whole) return exchange_resultants();
  if (gluing.empty()) return;
  constexpr Index size = unknowns_of_grain<D>;
  // Along the chain of a grain, F of a row is that of the row before plus the impulse on the copy between.
  Vector f = Vector::Zero(parts_.interface_size());
  auto old = gluing.begin();
  parts_.interface.for_glued_grains([&](Index grain, Index first, Index last) {
    while (old != gluing.end() && old->grain < grain) ++old;
    const auto end = std::find_if(old, gluing.end(), [&](const auto& one) { return one.grain != grain; });
    const bool shared_alike = std::ranges::equal(std::span(old, end), parts_.interface.copies(grain), {},
                                                 &RememberedGluing::subdomain, &GrainCopy::subdomain);
    for (Index row = first; row < last && shared_alike; ++row)
      for (Index k = 0; k < size; ++k) {
        f[size * row + k] = old[row - first].impulse[at(k)];
        if (row > first) f[size * row + k] += f[size * (row - 1) + k];
      }
  });
  correct(f);
}

template <int D>
Vector GranularTwoStage<D>::state() const {
  Vector z(D * parts_.contacts + parts_.interface_size());
  for (const GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      set_component<D>(z, subdomain.numbers[k], subdomain.contacts.impulse(k));
  z.tail(parts_.interface_size()) = interface_impulses_;
  return z;
}

template <int D>
void GranularTwoStage<D>::restart(const Vector& z) {
  for (GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k) {
      const LocalVector<D> before = subdomain.contacts.impulse(k), r = component<D>(z, subdomain.numbers[k]);
      subdomain.contacts.set_impulse(k, r);
      apply_impulse(subdomain.contact(k), r - before, subdomain.velocities);
    }
  correct(z.tail(parts_.interface_size()) - interface_impulses_);
  direction_.resize(0);
}

template <int D>
std::vector<ContactStatus> GranularTwoStage<D>::statuses() const {
  std::vector<ContactStatus> result(at(parts_.contacts), ContactStatus::open);
  for (const GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      result[at(subdomain.numbers[k])] = status_of(law_, subdomain.contact(k));
  return result;
}

// n_GS sweeps; the change is that of all together.
template <int D>
SweepSums GranularTwoStage<D>::sweeps(GranularSubdomain<D>& subdomain) const {
  if (subdomain.contacts.size() == 0) return {};  // of another rank
  const bool compare = solver_.gauss_seidel_sweeps > 1;
  std::vector<SweptVector<D>> before;
  if (compare) before = subdomain.contacts.impulses;
  SweepSums sums;
  for (Index k = 0; k < solver_.gauss_seidel_sweeps; ++k)
    sums = gauss_seidel_sweep(law_, subdomain.contacts, subdomain.velocities, solver_.contact_relaxation);
  if (!compare) return sums;
  const auto& now = subdomain.contacts.impulses;
  sums.change = std::inner_product(now.begin(), now.end(), before.begin(), 0.0, std::plus<>{},
                                   [](SweptVector<D> r, SweptVector<D> old) { return squared(r - old); });
  return sums;
}

template <int D>
void GranularTwoStage<D>::switch_models(const GranularSystem& system, const GranularState& state, double scale) {
  const auto before = solver_.warm_start ? state.models : std::vector<RememberedModel>{};
  if (!before.empty() && before.size() != parts_.subdomains.size())
    throw Error("models: expected one per subdomain of this step, met another number");
  if (D == 3 && solver_.model == SwitchedModel::homogenised)
    throw Error("solver.switch: expected none or linear with spheres in space, met homogenised");
  if (!system.free_bodies.empty() && solver_.model == SwitchedModel::homogenised)
    throw Error("solver.switch: expected none or linear with bodies that move along free directions, met homogenised");
  for (Index e = 0; e < count(parts_.subdomains); ++e) {
    SwitchRules rules{solver_.switch_after,
                      solver_.switch_flexibility.at_scale(scale),
                      {solver_.switch_cells[0], solver_.switch_cells[1]}};
    if (solver_.model == SwitchedModel::homogenised)
      for (const Index i : parts_.subdomains[at(e)].bodies) {
        PlacedBody& body = rules.bodies.emplace_back();
        body.kept = parts_.interface.multiplicity(i) > 1;
        if (i >= system.grains()) continue;  // the body of a wall
        body.centre = {state.x[at(i)], state.y[at(i)]};
        body.radius = system.radius[at(i)];
      }
    switches_.emplace_back(parts_, e, law_, rules, before.empty() ? 0 : before[at(e)].standing);
  }
}

template <int D>
std::vector<SweepSums> GranularTwoStage<D>::stage_one() {
  std::vector<SweepSums> sums(parts_.subdomains.size());
  const auto discrete = [&](GranularSubdomain<D>& subdomain) { return sweeps(subdomain); };
  for_each_in_parallel(count(parts_.subdomains), [&](Index e) {
    sums[at(e)] = switches_.empty() ? sweeps(parts_.subdomains[at(e)])
                                    : switches_[at(e)].stage_one(parts_, discrete, interface_impulses_);
  });
  sweeps_ += solver_.gauss_seidel_sweeps;
  return sums;
}

template <int D>
void GranularTwoStage<D>::correct(const Vector& change) {
  interface_impulses_ += change;
  parts_.apply_interface_impulses(change);
}

// A step of conjugate gradients (Polak-Ribiere) on jumps g_0 - S F. A trial Stage 1 gives the curvature d.S d.
template <int D>
Vector GranularTwoStage<D>::conjugate_step(const Vector& g, std::vector<SweepSums>& sums) {
  const Vector z = preconditioned(g);
  double beta = 0;
  if (direction_.size() == g.size()) {
    const double before = dot(last_jumps_, last_preconditioned_);
    // With an inexact Stage 1 jumps may grow: then beta = 0.
    if (before > 0 && dot(g, z) < before) beta = std::max(0.0, dot(g - last_jumps_, z) / before);
  }
  Vector d = z;
  if (beta > 0) d += beta * direction_;
  if (dot(d, g) <= 0) d = z;
  correct(d);
  sums = stage_one();
  const double curvature = dot(d, g - parts_.interface_jumps());
  // If statuses change, the curvature may vanish; the plain step is safe.
  const double length = curvature > 0 ? std::clamp(dot(d, g) / curvature, 0.1, 10.0) : 1.0;
  correct((length - 1) * d);
  direction_ = d;
  last_jumps_ = g;
  last_preconditioned_ = z;
  return length * d;
}

template <int D>
void GranularTwoStage<D>::iterate() {
  ++iteration_;
  std::vector<SweepSums> sums = stage_one();
  const Index subdomains = count(parts_.subdomains);
  Eigen::MatrixXd terms = Eigen::MatrixXd::Zero(quantities, subdomains);
  if (parts_.interface_size() > 0) {
    const Vector pushed = speeds_of_interface_impulses(parts_, interface_impulses_);
    const Vector g = enriched_now() ? parts_.all_interface_jumps() : parts_.interface_jumps();
    for_each_in_parallel(subdomains, [&](Index e) {
      terms(jumps, e) = parts_.squared_jumps(e, g);
      // Velocities of resting copies are the rounding of M_E^-1 A_E^T F.
      terms(speeds, e) = std::max(parts_.glued_speed_squared(e),
                                  ImpulseScale::squared_rounding * parts_.part_of_dot(e, pushed, pushed));
    });
    if (solver_.enrichment != Enrichment::semi_implicit || !enriched_ || iteration_ == 1) {
      Vector change;
      // Of the generic and enriched algorithms; the key means nothing to Schwarz's method.
      if (has_part(solver_.algorithm, StepPart::stage_two) &&
          solver_.interface_method == InterfaceMethod::conjugate_gradient) {
        change = conjugate_step(g, sums);
      } else {
        change = solver_.interface_relaxation * preconditioned(g);
        correct(change);
      }
      const Vector second = change - last_change_;
      for_each_in_parallel(subdomains, [&](Index e) {
        terms(interface_changes, e) = parts_.part_of_dot(e, change, change);
        terms(second_changes, e) = parts_.part_of_dot(e, second, second);
        terms(interface_squares, e) = parts_.part_of_dot(e, interface_impulses_, interface_impulses_);
      });
      last_change_ = std::move(change);
    }
  }
  for (Index e = 0; e < subdomains; ++e) {
    terms(changes, e) = sums[at(e)].change;
    terms(impulses, e) = sums[at(e)].impulses;
  }
  last_terms_ = std::move(terms);
}

template <int D>
IterationRecord GranularTwoStage<D>::record() const {
  const Vector sum = parts_.interface.processes().sum_of_parts(last_terms_);
  const double interface = at_least(impulse_floor_squared_, sum[interface_squares]);
  // Copies may come to rest, or start in an impact: the larger speed is the scale.
  return {.iteration = iteration_,
          .sweeps = sweeps_,
          .zeta = ratio(sum[changes], at_least(impulse_floor_squared_, sum[impulses])),
          .interface_change = ratio(sum[interface_changes], interface),
          .interface_second_change = ratio(sum[second_changes], interface),
          .gluing = ratio(sum[jumps], at_least(free_speed_squared_, sum[speeds])),
          .impulses = sum[impulses]};
}

template <int D>
double GranularTwoStage<D>::normal_change() const {
  Eigen::MatrixXd terms = Eigen::MatrixXd::Zero(2, count(parts_.subdomains));
  for_each_in_parallel(terms.cols(), [&](Index e) {
    const std::vector<SweptVector<D>>& now = parts_.subdomains[at(e)].contacts.impulses;
    const std::vector<SweptVector<D>>& before = remembered_.at(at(e));
    for (std::size_t k = 0; k < now.size(); ++k) {
      terms(0, e) += std::abs(now[k].n - before.at(k).n);
      terms(1, e) += std::abs(now[k].n);
    }
  });
  const Vector sum = parts_.interface.processes().sum_of_parts(std::move(terms));
  return sum[0] == 0 ? 0.0 : sum[0] / std::max(sum[1], std::sqrt(impulse_floor_squared_));
}

template <int D>
ContactResidual GranularTwoStage<D>::residual() const {
  std::vector<ContactResidual> residuals(parts_.subdomains.size());
  for_each_in_parallel(count(parts_.subdomains), [&](Index e) {
    residuals[at(e)] = contact_residual(law_, parts_.subdomains[at(e)].contacts, parts_.subdomains[at(e)].velocities);
  });
  ContactResidual sum = added_up(residuals, parts_.interface.processes());
  sum.scale = parts_.scale;
  return sum;
}

template <int D>
std::vector<RememberedModel> GranularTwoStage<D>::models() const {
  std::vector<RememberedModel> result(switches_.size());
  const auto discrete = [&](GranularSubdomain<D>& subdomain) { return sweeps(subdomain); };
  for (Index e = 0; e < count(switches_); ++e)
    result[at(e)] = switches_[at(e)].report(parts_, discrete, interface_impulses_);
  return result;
}

template class GranularTwoStage<2>;
template class GranularTwoStage<3>;

}  // namespace nscdd
