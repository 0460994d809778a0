// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/processes.hpp>

namespace nscdd {

/// The copy of a grain that a subdomain holds.
struct GrainCopy {
  Index subdomain = 0;
  Index grain = 0;  ///< local number
};

/// d rows of the gluing condition, V_first - V_second = 0. Rows of a grain form a tree of its copies. In an interface
/// of copies the row is of `first`, and the subdomain of `second` is -1.
struct Gluing {
  Index grain = 0;  ///< global number
  GrainCopy first, second;
};

/// A d x d block of A_E: `sign` (1 for the first copy of a row, -1 for the second) times I; `grain` is a local number.
struct Tie {
  Index row = 0, grain = 0;
  double sign = 1;
};

/// How q - 1 equalities tie the q copies of a shared grain. Every choice has full rank and gives the same spectra.
enum class GluingShape {
  chain,  ///< each copy to the next
  star,   ///< each copy to the first
};

/// Where subdomains meet ([ADI12] section 2): the copies of each grain, the rows that glue the copies of a shared one,
/// and exchanges between subdomains. A grain has d unknowns, 2 or 3 in the plane. Vectors of the interface have
/// n_Gamma = d x rows entries, those of row block k from d k on. Rows ascend by grain, copies by subdomain.
///
/// If ranks share the subdomains, each has all rows, but the ties of its own subdomains only. `exchange` sums over all
/// ranks; its result is the same on each. `exchange_with_neighbours` sums over neighbours only; its result is right in
/// the rows of grains of which this rank has a copy.
class Interface {
 public:
  Interface() = default;

  /// `held`: global numbers of the grains of each subdomain, in its order; `grains`: the number of all grains; `tied`:
  /// one flag per grain whether its copies are glued (driven ones are not), empty for all.
  Interface(Index dofs_per_grain, Index grains, const std::vector<std::span<const Index>>& held,
            const std::vector<char>& tied = {}, GluingShape shape = GluingShape::chain);

  Interface of_process(const std::vector<Index>& process_of_subdomain, Processes processes) const;
  /// The interface with a row for each copy of a glued grain in place of the gluing. Gluing::second is no copy, and
  /// `exchange` gives the velocities of the copies. Nothing that solves for interface impulses applies to it.
  Interface of_copies() const;
  const Processes& processes() const { return processes_; }
  /// Prepares messages between ranks that have copies of the same grains; copies of this object share them.
  void meet_neighbours();
  /// A function that sums entries of an array over the ranks that have copies of the same grain. `entries(row, k)`:
  /// begin and end of the entries of the k-th glued grain of which this rank has a copy; `row` is its first row.
  using Entries = std::pair<Index, Index>;
  std::function<void(std::span<double>)> between_neighbours(const std::function<Entries(Index, Index)>& entries) const;
  Index process_of(Index subdomain) const { return process_of_.empty() ? 0 : process_of_[at(subdomain)]; }

  Index size() const { return dofs_ * count(gluing_); }  ///< n_Gamma
  Index dofs_per_grain() const { return dofs_; }         ///< d
  Index grains() const { return count(start_) - 1; }
  GluingShape shape() const { return shape_; }
  const std::vector<Gluing>& gluing() const { return gluing_; }

  /// Copies of a grain, none if it touches nothing. For grains of other ranks see shared_interface.
  std::span<const GrainCopy> copies(Index grain) const {
    return {copies_.data() + start_[at(grain)], at(multiplicity(grain))};
  }
  /// Number of copies of a grain; split evenly, each has 1/number of its mass.
  Index multiplicity(Index grain) const { return start_[at(grain + 1)] - start_[at(grain)]; }
  /// Calls work(grain, first, last) for each glued grain and its rows [first, last).
  void for_glued_grains(auto&& work) const {
    for (Index first = 0, last = 0; first < count(gluing_); first = last) {
      while (last < count(gluing_) && gluing_[at(last)].grain == gluing_[at(first)].grain) ++last;
      work(gluing_[at(first)].grain, first, last);
    }
  }

  const std::vector<Tie>& ties(Index subdomain) const { return ties_[at(subdomain)]; }  ///< rows ascending
  SparseMatrix matrix(Index subdomain) const;  ///< A_E, n_Gamma x d n_E, signed boolean

  /// Whether both glue the same grains of the same subdomains. Local numbers may differ.
  bool same_rows(const Interface& other) const;

  /// The jumps sum_E A_E V_E. `velocity(e, i)[k]`: unknown k of local grain i of subdomain e. Called in parallel.
  template <class Velocity>
  Vector exchange(const Velocity& velocity) const {
    Vector jumps = own_jumps(velocity);
    processes_.add_up({jumps.data(), at(jumps.size())});
    return jumps;
  }
  /// The same in rows of grains of which this rank has a copy, else 0. Requires `meet_neighbours`.
  template <class Velocity>
  Vector exchange_with_neighbours(const Velocity& velocity) const {
    Vector jumps = own_jumps(velocity);
    if (between_neighbours_) between_neighbours_({jumps.data(), at(jumps.size())});
    return jumps;
  }
  /// The same for velocities V_E, d n_E entries each.
  Vector exchange(const std::vector<Vector>& velocities) const;

  /// A_E^T F: interface impulses F as impulses on the grains of a subdomain, d n_E.
  Vector distribute(Index subdomain, const Vector& f) const;

  /// Part of f^T g from rows whose first copy is in a subdomain. The parts of all subdomains add up to f^T g.
  double part_of_dot(Index subdomain, const Vector& f, const Vector& g) const;

  /// Velocities o_E of the copies with the jumps g, sum_E A_E o_E = g. The first copy of each grain is at rest.
  std::vector<Vector> copies_apart(const Vector& g) const;
  /// Interface impulses F with A_E^T F = `impulses` of every subdomain, which must balance on each grain.
  Vector collect(std::vector<Vector> impulses) const;

  /// X_inf^-1 g,  X_inf = sum_E A_E M_E^-1 A_E^T,  in closed form grain by grain: with copies at o_j that have the
  /// jumps g, each of inertia M/q, a chain has F_k = (M/q) sum_{j <= k} (o_j - mean o). `inertia(row, k)`: of unknown k
  /// of the copies that a row ties, equal for all copies of a grain.
  template <class Inertia>
  Vector solve_generic(const Inertia& inertia, const Vector& g) const {
    Vector f(g.size());
    for_blocks_of_rows([&](Index begin, Index end) {
      for (Index first = begin, last = begin; first < end; first = last) {
        while (last < end && gluing_[at(last)].grain == gluing_[at(first)].grain) ++last;
        for (Index k = 0; k < dofs_; ++k) balance(first, last, k, inertia(first, k), g, f);
      }
    });
    return f;
  }

 private:
  template <class Velocity>
  Vector own_jumps(const Velocity& velocity) const {
    Vector jumps = Vector::Zero(size());
    const auto add = [&](Index row, const GrainCopy& copy, double sign) {
      if (copy.subdomain < 0 || process_of(copy.subdomain) != processes_.rank) return;
      const auto& v = velocity(copy.subdomain, copy.grain);
      for (Index k = 0; k < dofs_; ++k) jumps[dofs_ * row + k] += sign * v[at(k)];
    };
    for_blocks_of_rows([&](Index begin, Index end) {
      for (Index row = begin; row < end; ++row) {
        add(row, gluing_[at(row)].first, 1);
        add(row, gluing_[at(row)].second, -1);
      }
    });
    return jumps;
  }
  /// Calls work(begin, end) for blocks of rows, in parallel if there are many. A block holds all rows of its grains.
  void for_blocks_of_rows(const std::function<void(Index, Index)>& work) const;
  void balance(Index first, Index last, Index k, double inertia, const Vector& g, Vector& f) const;

  Index dofs_ = 0;
  GluingShape shape_ = GluingShape::chain;
  std::vector<Index> start_{0};    // of the copies of each grain
  std::vector<GrainCopy> copies_;  // grain by grain
  std::vector<Gluing> gluing_;
  std::vector<std::vector<Tie>> ties_;  // of each subdomain
  std::vector<Index> held_;             // number of grains of each subdomain, n_E; 0 for those of other ranks
  Processes processes_;
  std::vector<Index> process_of_;  // of each subdomain; empty if one rank has all
  std::function<void(std::span<double>)> between_neighbours_;
};

/// The interface if each rank knows only its own subdomains: `held` is empty for the others, and `tied` is right for
/// own grains only. Collective: ranks exchange which grains they share. Each then knows the copies of these and of its
/// own grains, and stores one number for every other grain. Local numbers of copies on other ranks mean nothing.
/// `process_of_subdomain`: see deal_out; empty: one rank has all subdomains.
Interface shared_interface(Index dofs_per_grain, Index grains, std::vector<std::vector<Index>> held,
                           const std::vector<char>& tied, const std::vector<Index>& process_of_subdomain,
                           const Processes& processes, GluingShape shape = GluingShape::chain);

}  // namespace nscdd
