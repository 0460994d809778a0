// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_blocks.hpp"

#include "linalg/threads.hpp"

namespace nscdd {
namespace {

constexpr Index contacts_at_a_time = 1024;
constexpr Index contacts_for_threads = 8192;  // fewer take as long as waking a thread

}  // namespace

Index parts_of(Index contacts) { return (contacts + contacts_at_a_time - 1) / contacts_at_a_time; }

void for_parts(Index contacts, const std::function<void(const ContactRange&)>& visit) {
  const auto part = [&](Index k) {
    visit({k * contacts_at_a_time, std::min(contacts, (k + 1) * contacts_at_a_time), k});
  };
  if (contacts >= contacts_for_threads) return for_each_in_parallel(parts_of(contacts), part);
  for (Index k = 0; k < parts_of(contacts); ++k) part(k);
}

template <int D>
ContactBlocks<D>::ContactBlocks(const SparseMatrix& w, const std::vector<Index>& contact) {
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  const Rows rows = w;
  std::vector<int> place_of = natural_order<int>(rows.rows() / D);
  for (std::size_t place = 0; place < contact.size(); ++place) place_of[at(contact[place])] = static_cast<int>(place);
  for (Index place = 0; place < count(place_of); ++place) {
    const Index c = contact.empty() ? place : contact[at(place)];
    std::vector<Rows::InnerIterator> own;
    for (Index k = 0; k < D; ++k) own.emplace_back(rows, D * c + k);
    for (;;) {
      Index other = std::numeric_limits<Index>::max();
      for (const auto& e : own)
        if (e) other = std::min(other, e.col() / D);
      if (other == std::numeric_limits<Index>::max()) break;
      Block block{};
      for (std::size_t k = 0; k < D; ++k)
        for (auto& e = own[k]; e && e.col() / D == other; ++e) block[k][at(e.col() % D)] = e.value();
      column_.push_back(place_of[at(other)]);
      block_.push_back(block);
    }
    start_.push_back(count(column_));
  }
  column_.shrink_to_fit();
  block_.shrink_to_fit();
}

template <int D>
Vector ContactBlocks<D>::operator*(const Vector& x) const {
  Vector result(D * places());
  for_parts(places(), [&](const ContactRange& range) {
    for (Index place = range.first; place < range.last; ++place) set_component(result, place, add_row(place, x, {}));
  });
  return result;
}

template class ContactBlocks<2>;
template class ContactBlocks<3>;

}  // namespace nscdd
