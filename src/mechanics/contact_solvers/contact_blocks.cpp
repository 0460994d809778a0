// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_solvers/contact_blocks.hpp"

#include "linalg/threads.hpp"

#include <numeric>

namespace nscdd {
namespace {

constexpr Index contacts_at_a_time = 1024;
constexpr Index contacts_for_threads = 8192;  // fewer take no longer than waking a thread does

}  // namespace

Index parts_of(Index contacts) { return (contacts + contacts_at_a_time - 1) / contacts_at_a_time; }

void for_parts(Index contacts, const std::function<void(const ContactRange&)>& visit) {
  const auto part = [&](Index k) {
    visit({k * contacts_at_a_time, std::min(contacts, (k + 1) * contacts_at_a_time), k});
  };
  if (contacts >= contacts_for_threads) return for_each_in_parallel(parts_of(contacts), part);
  for (Index k = 0; k < parts_of(contacts); ++k) part(k);
}

ContactBlocks::ContactBlocks(const SparseMatrix& w, const std::vector<Index>& contact) {
  const Eigen::SparseMatrix<double, Eigen::RowMajor> rows = w;
  std::vector<int> place_of(at(rows.rows() / 2));
  std::iota(place_of.begin(), place_of.end(), 0);
  for (std::size_t place = 0; place < contact.size(); ++place) place_of[at(contact[place])] = static_cast<int>(place);
  for (Index place = 0; place < count(place_of); ++place) {
    const Index c = contact.empty() ? place : contact[at(place)];
    decltype(rows)::InnerIterator n(rows, 2 * c), t(rows, 2 * c + 1);
    const auto next = [](const auto& e) { return e ? e.col() / 2 : std::numeric_limits<Index>::max(); };
    while (n || t) {
      const Index other = std::min(next(n), next(t));
      Block block{};
      for (; n && n.col() / 2 == other; ++n) block[0][at(n.col() % 2)] = n.value();
      for (; t && t.col() / 2 == other; ++t) block[1][at(t.col() % 2)] = t.value();
      column_.push_back(place_of[at(other)]);
      block_.push_back(block);
    }
    start_.push_back(count(column_));
  }
  column_.shrink_to_fit();
  block_.shrink_to_fit();
}

Vector ContactBlocks::operator*(const Vector& x) const {
  Vector result(2 * places());
  for_parts(places(), [&](const ContactRange& range) {
    for (Index place = range.first; place < range.last; ++place) {
      const LocalVector<2> sum = add_row(place, x, {});
      result.segment<2>(2 * place) << sum.n, sum.t;
    }
  });
  return result;
}

}  // namespace nscdd
