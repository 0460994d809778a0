// SPDX-License-Identifier: GPL-3.0-or-later
// The order in which a sweep visits the contacts of a subdomain.
#include "contact_solvers/contact_turns.hpp"
#include "two_stage/granular_decomposition.hpp"

namespace nscdd {
namespace {

// Place of a cell of a 2^16 x 2^16 grid along Hilbert's curve.
std::uint32_t hilbert_place(std::uint32_t x, std::uint32_t y) {
  std::uint32_t place = 0;
  for (std::uint32_t side = 1U << 15; side > 0; side /= 2) {
    const bool right = (x & side) != 0, up = (y & side) != 0;
    place += side * side * ((right ? 3U : 0U) ^ (up ? 1U : 0U));
    if (!up) {  // rotate the quadrant into the first one
      if (right) {
        x = ~x;
        y = ~y;
      }
      std::swap(x, y);
    }
  }
  return place;
}

// The same for a grid of 2^16 cubes a side: the bits of its transposed coordinates (J. Skilling, Programming the
// Hilbert curve, AIP Conf. Proc. 707 (2004) 381-387).
std::uint64_t hilbert_place(std::array<std::uint32_t, 3> cell) {
  constexpr std::uint32_t top = 1U << 15;
  for (std::uint32_t bit = top; bit > 1; bit /= 2)
    for (std::uint32_t& one : cell) {
      if ((one & bit) != 0) {
        cell[0] ^= bit - 1;
      } else {
        const std::uint32_t exchanged = (cell[0] ^ one) & (bit - 1);
        cell[0] ^= exchanged;
        one ^= exchanged;
      }
    }
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  std::uint32_t turned = 0;
  for (std::uint32_t bit = top; bit > 1; bit /= 2)
    if ((cell[2] & bit) != 0) turned ^= bit - 1;
  std::uint64_t place = 0;
  for (std::uint32_t bit = top; bit > 0; bit /= 2)
    for (const std::uint32_t one : cell) place = 2 * place + (((one ^ turned) & bit) != 0 ? 1 : 0);
  return place;
}

std::vector<Index> along_curve(std::span<const std::array<double, 3>> points, int dimension) {
  if (points.empty()) return {};
  const Eigen::Map<const Eigen::Matrix3Xd> all(points.front().data(), 3, count(points));
  const Eigen::Vector3d low = all.rowwise().minCoeff(), high = all.rowwise().maxCoeff();
  const double extent = std::max((high - low).maxCoeff(), 1e-300);
  const auto cell = [&](Index point, Index k) {
    return static_cast<std::uint32_t>(std::clamp((all(k, point) - low[k]) / extent * 65535, 0.0, 65535.0));
  };
  std::vector<std::pair<std::uint64_t, Index>> places;
  places.reserve(points.size());
  for (Index p = 0; p < all.cols(); ++p)
    places.emplace_back(
        dimension == 2 ? hilbert_place(cell(p, 0), cell(p, 1)) : hilbert_place({cell(p, 0), cell(p, 1), cell(p, 2)}),
        p);
  std::ranges::sort(places);
  std::vector<Index> order;
  for (const auto& [place, p] : places) order.push_back(p);
  return order;
}

// The contacts in the given order by blocks, each sorted by colours. No two of one colour share a free grain.
template <int D>
std::vector<Index> by_colour(std::vector<Index> order, const std::vector<GrainContact<D>>& contacts,
                             const std::vector<GrainVelocity<D>>& bodies, Index block) {
  constexpr Index last_turn = 63;  // shared by all further colours, of grains with more than 64 contacts
  GreedyColours taken(count(bodies));
  std::vector<Index> colours(contacts.size());
  std::vector<std::array<Index, 2>> ends;  // free ones, first of all contacts: far apart in memory, waited for together
  ends.reserve(order.size());
  for (const Index c : order) {
    const Index a = contacts[at(c)].a, b = contacts[at(c)].b;
    ends.push_back({bodies[at(a)].inverse_mass > 0 ? a : b, bodies[at(b)].inverse_mass > 0 ? b : a});
  }
  for (Index place = 0; place < count(order); ++place) {
    const std::array<Index, 2>& free = ends[at(place)];
    colours[at(order[at(place)])] = std::min(last_turn, taken.take_least(free, free, place / block));
  }
  sort_by_colour(order, colours, block);
  return order;
}

}  // namespace

template <int D>
std::vector<Index> contact_order(Choice<ContactOrder> order, const std::vector<GrainContact<D>>& contacts,
                                 const std::vector<GrainVelocity<D>>& bodies, std::uint64_t seed,
                                 std::span<const std::array<double, 3>> points) {
  const Index size = count(contacts);
  if (order == ContactOrder::interleaved) return by_colour(along_curve(points, D), contacts, bodies, interleaved_block);
  if (order == ContactOrder::random) return random_order(size, seed);
  std::vector<Index> natural = natural_order(size);
  if (order == ContactOrder::coloured) return by_colour(std::move(natural), contacts, bodies, std::max<Index>(1, size));
  if (order == ContactOrder::reverse) std::ranges::reverse(natural);
  return natural;
}

template std::vector<Index> contact_order(Choice<ContactOrder>, const std::vector<GrainContact<2>>&,
                                          const std::vector<GrainVelocity<2>>&, std::uint64_t,
                                          std::span<const std::array<double, 3>>);
template std::vector<Index> contact_order(Choice<ContactOrder>, const std::vector<GrainContact<3>>&,
                                          const std::vector<GrainVelocity<3>>&, std::uint64_t,
                                          std::span<const std::array<double, 3>>);

}  // namespace nscdd
