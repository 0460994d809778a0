// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <algorithm>
#include <numeric>
#include <vector>

namespace nscdd {

/// Contacts (anything with members a and b) ascending by (a, b), in O(N): each is counted into place by its
/// a, 0 <= a < bodies, then the few of one a are sorted by b.
template <class AnyContact>
std::vector<AnyContact> sorted_by_bodies(const std::vector<AnyContact>& contacts, Index bodies) {
  std::vector<std::size_t> start(at(bodies) + 1, 0);
  for (const AnyContact& contact : contacts) ++start[at(contact.a) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<AnyContact> result(contacts.size());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (const AnyContact& contact : contacts) result[next[at(contact.a)]++] = contact;
  for (std::size_t a = 0; a + 1 < start.size(); ++a)
    std::sort(result.begin() + static_cast<std::ptrdiff_t>(start[a]),
              result.begin() + static_cast<std::ptrdiff_t>(start[a + 1]),
              [](const AnyContact& l, const AnyContact& r) { return l.b < r.b; });
  return result;
}

}  // namespace nscdd
