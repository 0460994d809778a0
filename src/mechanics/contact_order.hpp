// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/disk_contacts.hpp"
#include <nscdd/core/choice.hpp>
#include <nscdd/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace nscdd {

/// Orders in which a sweep may visit contacts.
enum class ContactOrder {
  natural,   ///< ascending by the disks
  reverse,   ///< descending
  random,    ///< a new permutation each step
  coloured,  ///< contacts of one colour share no free disk
  /// Along a space-filling curve, in blocks of 256 contacts that are coloured each. Neighbours in space are
  /// neighbours in memory, yet no contact waits for the one before it: the fastest.
  interleaved,
};
constexpr auto names_of(ContactOrder) {
  return std::to_array<std::string_view>({"natural", "reverse", "random", "coloured", "interleaved"});
}

/// Permutation of the contacts: the order in which they are to lie in memory. `bodies`: velocities of the
/// disks (driven ones may be shared within a colour). `points`: where the contacts are, m, for `interleaved`;
/// without them it takes the natural order for the curve.
std::vector<Index> contact_order(Choice<ContactOrder> order, std::span<const DiskContact> contacts,
                                 std::span<const DiskVelocity> bodies, std::uint64_t seed,
                                 std::span<const std::array<double, 2>> points = {});

}  // namespace nscdd
