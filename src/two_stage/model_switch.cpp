// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/model_switch.hpp"

#include "linalg/pencil.hpp"
#include "linalg/sparse_entries.hpp"

#include <set>

namespace nscdd {
namespace {

// Values of the bilinear functions of the mesh at the bodies.
Matrix bilinear(const std::vector<PlacedBody>& bodies, const std::vector<Index>& moved,
                const std::array<Index, 2>& cells) {
  Eigen::Matrix2Xd centres(2, count(moved));
  for (Index row = 0; row < count(moved); ++row)
    centres.col(row) = Eigen::Vector2d::Map(bodies[at(moved[at(row)])].centre.data());
  const Eigen::Vector2d low = centres.rowwise().minCoeff(), extent = centres.rowwise().maxCoeff() - low;
  Matrix values = Matrix::Zero(count(moved), (cells[0] + 1) * (cells[1] + 1));
  for (Index row = 0; row < count(moved); ++row) {
    std::array<Index, 2> cell{};
    std::array<double, 2> place{};
    for (Index k = 0; k < 2; ++k) {
      const double s = extent[k] > 0 ? (centres(k, row) - low[k]) / extent[k] : 0.0;
      const double scaled = s * static_cast<double>(cells[at(k)]);
      cell[at(k)] = std::min(cells[at(k)] - 1, static_cast<Index>(scaled));
      place[at(k)] = scaled - static_cast<double>(cell[at(k)]);
    }
    for (const Index right : {0, 1})
      for (const Index up : {0, 1})
        values(row, (cell[1] + up) * (cells[0] + 1) + cell[0] + right) =
            (right == 1 ? place[0] : 1 - place[0]) * (up == 1 ? place[1] : 1 - place[1]);
  }
  return values;
}

// Whether impulses turn with the velocities, as in space if contacts slide with friction.
template <int D>
bool turns(const GranularSubdomain<D>& subdomain, const std::vector<ContactStatus>& statuses) {
  for (std::size_t k = 0; D == 3 && k < statuses.size(); ++k)
    if (slides(statuses[k]) && subdomain.contact(k).friction > 0) return true;
  return false;
}

// Keeps the largest distances between the velocities of a model and of the law on the copies of shared grains.
template <int D>
void compare(RememberedModel& record, const std::vector<GrainVelocity<D>>& model,
             const std::vector<GrainVelocity<D>>& law, const Interface& interface, Index subdomain, const Vector& f) {
  constexpr Index size = unknowns_of_grain<D>;
  const Vector gluing = interface.distribute(subdomain, f);
  double gap = 0, impulse = 0, whole = 0, momenta = 0;  // squared
  std::set<Index> shared;
  for (const Tie& tie : interface.ties(subdomain)) shared.insert(tie.grain);
  for (const Index grain : shared) {
    const GrainUnknowns<D> a = unknowns(model[at(grain)]), b = unknowns(law[at(grain)]);
    const double mass = 1 / law[at(grain)].inverse_mass;
    double apart = 0, pushed = 0;
    for (Index k = 0; k < size; ++k) {
      const double change = a[at(k)] - b[at(k)];
      apart += change * change;
      pushed += k < D ? change * change : change * change / (rim_mass_ratio<D> * rim_mass_ratio<D>);
    }
    gap += apart;
    impulse += mass * mass * pushed;
    momenta += mass * mass * (squared_velocity(law[at(grain)]) + squared_rim(law[at(grain)]));
    whole += gluing.segment<size>(size * grain).squaredNorm();
  }
  const auto keep_larger = [](double& kept, double part, double of) {
    if (part > 0) kept = std::max(kept, std::sqrt(part / of));
  };
  keep_larger(record.velocity_distance, gap, static_cast<double>(shared.size()));
  keep_larger(record.impulse_distance, impulse, std::max(whole, ImpulseScale::squared_rounding * momenta));
}

}  // namespace

SparseMatrix coarse_velocities(const FrozenNetwork& network, const std::vector<PlacedBody>& bodies,
                               const std::array<Index, 2>& cells) {
  SparseEntries entries;
  Index columns = 0;
  std::vector<Index> moved;
  for (Index i = 0; i < count(bodies); ++i) {
    const Index first = network.rows[at(i)].first;
    if (first < 0) continue;
    if (!bodies[at(i)].kept) {
      moved.push_back(i);
      continue;
    }
    for (Index k = 0; k < 3; ++k) entries.add(first + k, columns++, network.root[first + k]);
  }
  if (!moved.empty()) {
    const Matrix values = bilinear(bodies, moved, cells);
    Vector radius(count(moved));
    for (Index row = 0; row < count(moved); ++row) radius[row] = bodies[at(moved[at(row)])].radius;
    const Matrix translation = orthonormal_basis(values), rotation = orthonormal_basis(radius.asDiagonal() * values);
    for (Index k = 0; k < 3; ++k) {
      const Matrix& basis = k < 2 ? translation : rotation;
      for (Index column = 0; column < basis.cols(); ++column, ++columns)
        for (Index row = 0; row < count(moved); ++row) {
          const Index place = network.rows[at(moved[at(row)])].first + k;
          entries.add(place, columns, network.root[place] * basis(row, column));
        }
    }
  }
  return entries.matrix(network.root.size(), columns);
}

template <int D>
ModelSwitch<D>::ModelSwitch(const GranularDecomposition<D>& parts, Index subdomain, const ContactLaw& law,
                            const SwitchRules& rules, Index standing)
    : subdomain_(subdomain),
      law_(law),
      rules_(rules),
      statuses_(parts.subdomains[at(subdomain)].statuses(law)),
      record_{.standing = standing} {}

template <int D>
bool ModelSwitch<D>::linear_now(const GranularSubdomain<D>& subdomain) {
  if (linear_ || record_.standing < rules_.after) return linear_.has_value();
  if (turns(subdomain, statuses_)) return false;
  typename LinearSubdomain<D>::Fields fields;
  if (!rules_.bodies.empty())
    fields = [&](const FrozenNetwork& network) { return coarse_velocities(network, rules_.bodies, rules_.cells); };
  linear_.emplace(subdomain, law_, statuses_, rules_.flexibility, fields);
  if (linear_->regular()) return true;
  linear_.reset();
  record_.standing = 0;
  return false;
}

template <int D>
void ModelSwitch<D>::watch(const GranularSubdomain<D>& subdomain) {
  std::vector<ContactStatus> now = subdomain.statuses(law_);
  record_.standing = now == statuses_ ? record_.standing + 1 : 0;
  statuses_ = std::move(now);
}

template <int D>
SweepSums ModelSwitch<D>::stage_one(GranularDecomposition<D>& parts, const Sweeps& sweeps, const Vector& f) {
  GranularSubdomain<D>& subdomain = parts.subdomains[at(subdomain_)];
  if (!linear_now(subdomain)) {
    const SweepSums sums = sweeps(subdomain);
    watch(subdomain);
    return sums;
  }
  LinearAnswer<D> answer = linear_->answer(subdomain);
  if (answer.admissible) {
    ++record_.standing;
    ++record_.switched_iterations;
    return linear_->take(std::move(answer), subdomain);
  }
  linear_->release(subdomain);
  linear_.reset();
  ++record_.switch_backs;
  const SweepSums sums = sweeps(subdomain);
  compare(record_, answer.velocities, subdomain.velocities, parts.interface, subdomain_, f);
  watch(subdomain);
  record_.standing = 0;
  return sums;
}

template <int D>
RememberedModel ModelSwitch<D>::report(const GranularDecomposition<D>& parts, const Sweeps& sweeps,
                                       const Vector& f) const {
  RememberedModel record = record_;
  record.switched = linear_.has_value();
  if (!linear_) return record;
  GranularSubdomain<D> copy = parts.subdomains[at(subdomain_)];
  LinearSubdomain<D>(*linear_).release(copy);
  sweeps(copy);
  compare(record, parts.subdomains[at(subdomain_)].velocities, copy.velocities, parts.interface, subdomain_, f);
  return record;
}

template class ModelSwitch<2>;
template class ModelSwitch<3>;

}  // namespace nscdd
