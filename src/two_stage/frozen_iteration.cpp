// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/frozen_iteration.hpp"

#include "linalg/pencil.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

// One subdomain in y: what its contacts and its neighbours add.
struct LocalMaps {
  FrozenNetwork network;
  Vector root;          // of the network, then of V_common of whole copies
  SparseMatrix gluing;  // M^-1/2 A^T; the loads of the other copies on whole ones
  SparseMatrix own;     // M^-1/2 in the rows of its whole copies
};

template <int D>
LocalMaps local_maps(const GranularDecomposition<D>& parts, Index e, const std::vector<FrozenContact<D>>& frozen) {
  constexpr Index unknowns = unknowns_of_grain<D>;
  const GranularSubdomain<D>& subdomain = parts.subdomains[at(e)];
  std::vector<FrozenContact<D>> own;
  for (const Index contact : subdomain.numbers) own.push_back(frozen[at(contact)]);
  LocalMaps maps{frozen_network(subdomain, own), {}, {}, {}};
  const Vector& root = maps.network.root;
  maps.root.resize(root.size() + unknowns * count(subdomain.whole_copies));
  maps.root.head(root.size()) = root;
  SparseEntries gluing, resultants;
  if (parts.copies == CopyMass::shares)
    for (const Tie& tie : parts.interface.ties(e))
      for (Index k = 0; k < unknowns; ++k) {
        const Index row = maps.network.rows[at(tie.grain)].first + k;
        gluing.add(row, unknowns * tie.row + k, tie.sign / root[row]);
      }
  Index common = root.size();
  for (const WholeCopy<D>& copy : subdomain.whole_copies)
    for (Index k = 0; k < unknowns; ++k, ++common) {
      const Index row = maps.network.rows[at(copy.grain)].first + k;
      maps.root[common] = root[row];
      resultants.add(row, unknowns * copy.own + k, 1 / root[row]);
      for (Index other = copy.first; other < copy.last; ++other) {
        gluing.add(common, unknowns * other + k, 1 / root[row]);
        if (other != copy.own) gluing.add(row, unknowns * other + k, 1 / root[row]);
      }
    }
  maps.gluing = gluing.matrix(maps.root.size(), parts.interface_size());
  maps.own = resultants.matrix(root.size(), parts.interface_size());
  return maps;
}

// `across`: turning impulses across directions of sliding, N s; the subdomain's begin at `turned`. Returns their end.
template <int D>
Index sweep(const GranularSubdomain<D>& subdomain, const std::vector<FrozenContact<D>>& frozen,
            std::vector<GrainVelocity<D>>& v, Vector& across, Index turned) {
  for (std::size_t k = 0; k < subdomain.numbers.size(); ++k) {
    const FrozenContact<D>& now = frozen[at(subdomain.numbers[k])];
    if (now.status == ContactStatus::open) continue;
    const GrainContact<D> c = subdomain.contacts.contact(k, v);
    LocalVector<D> change = with_delassus(c, [&](const auto& w) { return -1.0 * w.solve(relative_velocity<D>(c, v)); });
    if (now.status != ContactStatus::stick && c.levers) {  // v_n + W_nn r_n + W_nt r_t = 0, r_t = slope r_n
      const FullDelassus<D> w = lever_delassus(*c.levers, c.inverse_mass_a, c.inverse_mass_b);
      change.n = -relative_velocity<D>(c, v).n / (w.nn + dot(w.nt, now.slope));
      change.t = change.n * now.slope;
    } else if (now.status != ContactStatus::stick) {
      const Tangent<D> stopping = change.t;
      change.t = change.n * now.slope;
      if constexpr (D == 3)
        if (now.turning > 0) {  // r_e <- turning (r_e - v_e / W_tt)
          const TangentVector side = side_of(now);
          double& impulse = across[turned++];
          const double next = now.turning * (impulse + dot(side, stopping));
          change.t = change.t + (next - impulse) * side;
          impulse = next;
        }
    }
    apply_impulse(c, change, v);
  }
  return turned;
}

}  // namespace

template <int D>
FrozenIteration<D>::FrozenIteration(GranularDecomposition<D> parts, std::vector<FrozenContact<D>> frozen, Index sweeps,
                                    std::optional<InterfaceOperator> enriched, double relaxation)
    : parts_(std::move(parts)),
      resting_(parts_),
      frozen_(std::move(frozen)),
      sweeps_(sweeps),
      enriched_(std::move(enriched)),
      relaxation_(relaxation) {
  for (GranularSubdomain<D>& subdomain : resting_.subdomains) {
    subdomain.contacts = {};
    for (GrainVelocity<D>& v : subdomain.velocities) v = {.inverse_mass = v.inverse_mass};
    for (WholeCopy<D>& copy : subdomain.whole_copies) copy.common = {.inverse_mass = copy.common.inverse_mass};
  }
  SparseEntries impulses, gluing;
  Index size = 0, columns = 0;
  std::vector<double> root;
  std::vector<Index> turning;  // columns
  for (Index e = 0; e < count(parts_.subdomains); ++e) {
    const LocalMaps maps = local_maps(parts_, e, frozen_);
    const FrozenNetwork& network = maps.network;
    impulses.add_block(network.impulses, size, columns);
    gluing.add_block(maps.gluing, size, 0);
    for (const Index column : network.turning) turning.push_back(columns + column);
    columns += network.impulses.cols();
    size += maps.root.size();
    root.insert(root.end(), maps.root.begin(), maps.root.end());
  }
  Index row = size;
  for (const GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k) {
      const FrozenContact<D>& now = frozen_[at(subdomain.numbers[k])];
      if (!(now.turning > 0)) continue;
      root.push_back(1 / std::sqrt(subdomain.contact(k).inverse_w().inverse_t));
      impulses.add(row, turning[at(row - size)], std::sqrt(now.turning) * root.back());
      ++row;
    }
  root_ = Vector::Map(root.data(), row);
  impulses.add_block(gluing.matrix(row, parts_.interface_size()), 0, columns);
  range_ = std::make_shared<RangeProjector>(impulses.matrix(row, columns + parts_.interface_size()));
}

template <int D>
Vector FrozenIteration<D>::apply(const Vector& y, Index iterations) const {
  GranularDecomposition<D> work = resting_;
  const Vector velocities = y.cwiseQuotient(root_);
  Index k = 0;
  const auto set = [&](GrainVelocity<D>& v) {
    if (v.inverse_mass == 0) return;
    GrainUnknowns<D> own;
    for (double& one : own) one = velocities[k++];
    v = with_unknowns(own, v.inverse_mass);
  };
  for (GranularSubdomain<D>& subdomain : work.subdomains) {
    std::ranges::for_each(subdomain.velocities, set);
    std::ranges::for_each(subdomain.whole_copies, set, &WholeCopy<D>::common);
  }
  Vector across = velocities.tail(rows() - k);
  for (Index i = 0; i < iterations; ++i) iterate(work, across);
  Vector image(rows());
  image << work.free_velocities(), across;
  return project(image.cwiseProduct(root_));
}

template <int D>
void FrozenIteration<D>::iterate(GranularDecomposition<D>& work, Vector& across) const {
  Index turned = 0;
  for (std::size_t e = 0; e < work.subdomains.size(); ++e) {
    const Index first = turned;
    for (Index n = 0; n < sweeps_; ++n)
      turned = sweep(parts_.subdomains[e], frozen_, work.subdomains[e].velocities, across, first);
  }
  if (work.interface_size() == 0) return;
  const Vector jumps = work.interface_jumps();
  work.apply_interface_impulses(relaxation_ *
                                (enriched_ ? enriched_->solve(jumps) : work.generic_interface_solve(jumps)));
}

template <int D>
Matrix frozen_contraction(const GranularDecomposition<D>& parts, const std::vector<FrozenContact<D>>& frozen,
                          const std::optional<InterfaceOperator>& enriched, double relaxation) {
  const OneBlasThread serial_blas;
  Matrix system = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (Index e = 0; e < count(parts.subdomains); ++e) {
    const LocalMaps maps = local_maps(parts, e, frozen);
    const FrozenNetwork& network = maps.network;
    const Matrix a = Matrix(maps.gluing).topRows(network.root.size());
    const bool whole = parts.copies == CopyMass::whole;
    Matrix kept = whole ? Matrix(-maps.own) : a;  // M^-1/2 times the jumps, with signs
    if (network.impulses.cols() > 0) {
      Matrix w(network.resting.transpose() * network.impulses);
      w.diagonal() += network.flexibility;
      const double threshold = std::numeric_limits<double>::epsilon() * static_cast<double>(w.rows());
      kept -= network.impulses * minimum_norm_map(w, threshold)(network.resting.transpose() * a);
    }
    system += whole ? Matrix(-(maps.own.transpose() * kept)) : Matrix(a.transpose() * kept);
  }
  Matrix b = Matrix::Identity(system.rows(), system.cols());
  for (Index k = 0; k < system.cols(); ++k) {
    const Vector column = system.col(k);
    b.col(k) -= relaxation * (enriched ? enriched->solve(column) : parts.generic_interface_solve(column));
  }
  return b;
}

template class FrozenIteration<2>;
template class FrozenIteration<3>;
template Matrix frozen_contraction(const GranularDecomposition<2>&, const std::vector<FrozenContact<2>>&,
                                   const std::optional<InterfaceOperator>&, double);
template Matrix frozen_contraction(const GranularDecomposition<3>&, const std::vector<FrozenContact<3>>&,
                                   const std::optional<InterfaceOperator>&, double);

}  // namespace nscdd
