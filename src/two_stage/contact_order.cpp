// SPDX-License-Identifier: GPL-3.0-or-later
// The order in which a sweep visits the contacts of a subdomain.
#include "two_stage/granular_decomposition.hpp"

namespace nscdd {
namespace {

std::uint32_t all_bits_if(bool condition) { return condition ? ~0U : 0U; }

// Place of a cell of a 2^16 x 2^16 grid along Hilbert's curve.
std::uint32_t hilbert_place(std::uint32_t x, std::uint32_t y) {
  std::uint32_t place = 0;
  for (std::uint32_t side = 1U << 15; side > 0; side /= 2) {
    const std::uint32_t right = all_bits_if((x & side) != 0), down = all_bits_if((y & side) == 0);
    place += side * side * ((right & 3U) ^ (~down & 1U));
    x ^= right & down;  // rotate the quadrant into the first one
    y ^= right & down;
    const std::uint32_t exchanged = (x ^ y) & down;
    x ^= exchanged;
    y ^= exchanged;
  }
  return place;
}

// The same for a grid of 2^16 cubes a side: the bits of its transposed coordinates (J. Skilling, Programming the
// Hilbert curve, AIP Conf. Proc. 707 (2004) 381-387).
std::uint64_t hilbert_place(std::array<std::uint32_t, 3> cell) {
  constexpr std::uint32_t top = 1U << 15;
  for (std::uint32_t bit = top; bit > 1; bit /= 2)
    for (std::uint32_t& one : cell) {
      const std::uint32_t inverted = all_bits_if((one & bit) != 0) & (bit - 1);
      const std::uint32_t exchanged = (cell[0] ^ one) & (bit - 1) & ~inverted;
      cell[0] ^= inverted ^ exchanged;
      one ^= exchanged;
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

// Contacts along Hilbert's curve through their points.
template <int D>
std::vector<Index> along_curve(const StepProblem<D>& problem, const std::vector<Index>& numbers) {
  Eigen::Array3d low = Eigen::Array3d::Constant(infinity), high = -low;
  for (const Index c : numbers) {
    const Eigen::Map<const Eigen::Array3d> point(problem.geometry[at(c)].point.data());
    low = low.min(point);
    high = high.max(point);
  }
  const double extent = std::max((high - low).maxCoeff(), 1e-300);
  std::vector<std::pair<std::uint64_t, Index>> places;
  places.reserve(numbers.size());
  for (const Index c : numbers) {
    const std::array<double, 3>& point = problem.geometry[at(c)].point;
    const auto cell = [&](std::size_t k) {
      return static_cast<std::uint32_t>(
          std::clamp((point[k] - low[static_cast<Index>(k)]) / extent * 65535, 0.0, 65535.0));
    };
    places.emplace_back(D == 2 ? hilbert_place(cell(0), cell(1)) : hilbert_place({cell(0), cell(1), cell(2)}), c);
  }
  std::ranges::sort(places);
  std::vector<Index> order;
  order.reserve(places.size());
  for (const auto& [place, c] : places) order.push_back(c);
  return order;
}

// The contacts in the given order by blocks, each sorted by colours. No two of one colour share a free grain.
template <int D>
std::vector<Index> by_colour(std::vector<Index> order, const StepProblem<D>& problem, Index block,
                             GreedyColours& taken) {
  constexpr Index last_turn = 63;          // shared by all further colours, of grains with more than 64 contacts
  std::vector<std::array<Index, 2>> ends;  // free ones, first of all contacts: far apart in memory, waited for together
  ends.reserve(order.size());
  for (const Index c : order) {
    const Index a = problem.contacts[at(c)].a, b = problem.contacts[at(c)].b;
    ends.push_back({problem.free[at(a)].inverse_mass > 0 ? a : b, problem.free[at(b)].inverse_mass > 0 ? b : a});
  }
  std::vector<Index> colours;
  colours.reserve(order.size());
  for (Index place = 0; place < count(order); ++place) {
    if (place % block == 0) taken.next_block();
    colours.push_back(std::min(last_turn, taken.take_least(ends[at(place)], ends[at(place)])));
  }
  sort_by_colour(order, colours, block);
  return order;
}

}  // namespace

template <int D>
std::vector<Index> contact_order(Choice<ContactOrder> order, const StepProblem<D>& problem, std::vector<Index> numbers,
                                 std::uint64_t seed, GreedyColours& taken) {
  if (order == ContactOrder::interleaved)
    return by_colour(along_curve(problem, numbers), problem, interleaved_block, taken);
  if (order == ContactOrder::coloured)
    return by_colour(std::move(numbers), problem, std::numeric_limits<Index>::max(), taken);  // one block
  if (order == ContactOrder::random) return shuffled(std::move(numbers), seed);
  if (order == ContactOrder::reverse) std::ranges::reverse(numbers);
  return numbers;
}

template std::vector<Index> contact_order(Choice<ContactOrder>, const StepProblem<2>&, std::vector<Index>,
                                          std::uint64_t, GreedyColours&);
template std::vector<Index> contact_order(Choice<ContactOrder>, const StepProblem<3>&, std::vector<Index>,
                                          std::uint64_t, GreedyColours&);

}  // namespace nscdd
