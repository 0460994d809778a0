// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/shared_copies.hpp"

namespace nscdd {
namespace {

template <int D>
GrainVelocity<D>& copy_in(CopiesOfGrains<D>& velocities, const typename SharedCopies<D>::Copy& copy) {
  return velocities[at(copy.subdomain)][at(copy.grain)];
}

template <int D>
constexpr Index size = unknowns_of_grain<D>;
template <int D>
constexpr Index size_with_mark = size<D> + 1;  // of a grain that follows a copy, and a mark that there is one

}  // namespace

template <int D>
SharedCopies<D>::SharedCopies(const Interface& interface) {
  const auto is_own = [&](const GrainCopy& copy) {
    return interface.process_of(copy.subdomain) == interface.processes().rank;
  };
  interface.for_glued_grains([&](Index grain, Index, Index) {
    const std::span<const GrainCopy> copies = interface.copies(grain);
    if (std::ranges::none_of(copies, is_own)) return;
    const Index shared = count(start_) - 1;
    for (Index place = start_.back(); const GrainCopy& copy : copies) {
      if (is_own(copy)) own_.push_back({copy.subdomain, copy.grain, shared, place});
      ++place;
    }
    start_.push_back(start_.back() + count(copies));
  });
  add_copies_ = interface.between_neighbours([&](Index, Index k) {
    return Interface::Entries{size<D> * start_[at(k)], size<D> * start_[at(k + 1)]};
  });
  add_grains_ = interface.between_neighbours([](Index, Index k) {
    return Interface::Entries{size_with_mark<D> * k, size_with_mark<D> * (k + 1)};
  });
}

template <int D>
void SharedCopies<D>::add_up(CopiesOfGrains<D>& velocities) const {
  Vector all = Vector::Zero(size<D> * start_.back());
  for (const Copy& copy : own_)
    std::ranges::copy(unknowns(copy_in<D>(velocities, copy)), all.data() + size<D> * copy.place);
  add_copies_({all.data(), at(all.size())});
  for (const Copy& copy : own_) {
    GrainVelocity<D>& velocity = copy_in<D>(velocities, copy);
    GrainUnknowns<D> sum{};
    for (Index place = start_[at(copy.shared)]; place < start_[at(copy.shared + 1)]; ++place)
      for (Index k = 0; k < size<D>; ++k) sum[at(k)] += all[size<D> * place + k];
    velocity = with_unknowns(sum, velocity.inverse_mass);
  }
}

template <int D>
void SharedCopies<D>::follow(const std::vector<Index>& changed, CopiesOfGrains<D>& velocities) const {
  // Adding +0.0 would turn a velocity -0.0 into +0.0.
  Vector all = Vector::Constant(size_with_mark<D> * (count(start_) - 1), -0.0);
  for (const Index k : changed) {
    const Copy& copy = own_[at(k)];
    double* const entries = all.data() + size_with_mark<D> * copy.shared;
    std::ranges::copy(unknowns(copy_in<D>(velocities, copy)), entries);
    entries[size<D>] = 1;
  }
  add_grains_({all.data(), at(all.size())});
  for (const Copy& copy : own_) {
    const double* const entries = all.data() + size_with_mark<D> * copy.shared;
    if (entries[size<D>] == 0) continue;
    GrainVelocity<D>& velocity = copy_in<D>(velocities, copy);
    GrainUnknowns<D> v;
    std::copy_n(entries, size<D>, v.begin());
    velocity = with_unknowns(v, velocity.inverse_mass);
  }
}

template class SharedCopies<2>;
template class SharedCopies<3>;

}  // namespace nscdd
