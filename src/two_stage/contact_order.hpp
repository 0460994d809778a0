// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"
#include "two_stage/step_solver.hpp"

namespace nscdd {

/// The order of contacts in memory and in a sweep. `points`: of the contacts, m; needed for `interleaved` only.
template <int D>
std::vector<Index> contact_order(Choice<ContactOrder> order, const std::vector<GrainContact<D>>& contacts,
                                 const std::vector<GrainVelocity<D>>& bodies, std::uint64_t seed,
                                 std::span<const std::array<double, 3>> points);

}  // namespace nscdd
