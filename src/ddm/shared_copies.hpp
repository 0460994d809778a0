// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"
#include <nscdd/ddm/interface.hpp>

namespace nscdd {

/// Velocities of the bodies of every subdomain, in its own order; those of subdomains of other processes are empty.
template <int D>
using CopiesOfGrains = std::vector<std::vector<GrainVelocity<D>>>;

/// Keeps the copies of shared grains equal, each with the whole mass of its grain: what W couples beyond a subdomain.
/// Processes that have copies of the same grains send each other messages; all processes construct it together. No bit
/// depends on their number.
template <int D>
class SharedCopies {
 public:
  explicit SharedCopies(const Interface& interface);

  /// Every copy of a grain takes the sum of all, in the order of their subdomains.
  void add_up(CopiesOfGrains<D>& velocities) const;
  /// Every copy of a grain takes the velocity of the one that has changed. `changed`: copies in subdomains of this
  /// process, of different grains in whatever process.
  void follow(const std::vector<Index>& changed, CopiesOfGrains<D>& velocities) const;

  /// The numbers of copies in this process, for `follow`.
  struct Copy {
    Index subdomain, grain;  ///< local number
    Index shared, place;     ///< the shared grain, and the copy among all of these
  };
  const std::vector<Copy>& own() const { return own_; }

 private:
  std::vector<Copy> own_;
  std::vector<Index> start_{0};  // of the copies of each shared grain of which this process has one
  std::function<void(std::span<double>)> add_copies_, add_grains_;
};

}  // namespace nscdd
