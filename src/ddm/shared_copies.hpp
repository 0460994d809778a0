// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"
#include <nscdd/ddm/interface.hpp>

namespace nscdd {

/// Velocities of the bodies of every subdomain, in its own order; empty for subdomains of other ranks.
template <int D>
using CopiesOfGrains = std::vector<std::vector<GrainVelocity<D>>>;

/// Keeps the copies of shared grains equal, each with the whole mass of its grain. Construction is collective; then
/// only ranks that share grains communicate. No bit depends on the ranks.
template <int D>
class SharedCopies {
 public:
  explicit SharedCopies(const Interface& interface);

  /// Sets every copy of a grain to the sum of all, in the order of their subdomains.
  void add_up(CopiesOfGrains<D>& velocities) const;
  /// Sets the copies of a grain to the changed one. `changed`: copies on this rank, with no grain twice on all ranks.
  void follow(const std::vector<Index>& changed, CopiesOfGrains<D>& velocities) const;

  /// The copies on this rank, by the numbers that `follow` takes.
  struct Copy {
    Index subdomain, grain;  ///< local number
    Index shared, place;     ///< of the grain among shared ones, and of the copy among all of theirs
  };
  const std::vector<Copy>& own() const { return own_; }

 private:
  std::vector<Copy> own_;
  std::vector<Index> start_{0};  // of the copies of each shared grain that this rank has
  std::function<void(std::span<double>)> add_copies_, add_grains_;
};

}  // namespace nscdd
