// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/shared_copies.hpp"

#include <map>
#include <set>

namespace nscdd {
namespace {

template <int D>
GrainVelocity<D>& copy_in(CopiesOfGrains<D>& velocities, const typename SharedCopies<D>::Copy& copy) {
  return velocities[at(copy.subdomain)][at(copy.grain)];
}

template <int D>
constexpr Index size = unknowns_of_grain<D>;
template <int D>
constexpr Index size_with_mark = size<D> + 1;  // of a grain whose copies follow one, and whether there is such a one

}  // namespace

// Processes list what they share in the order of the grains.
template <int D>
SharedCopies<D>::SharedCopies(const Interface& interface) {
  const Processes& processes = interface.processes();
  std::map<Index, SharedEntries> copies_with, grains_with;
  Index last = -1;
  for (const Gluing& row : interface.gluing()) {
    if (std::exchange(last, row.grain) == row.grain) continue;
    std::set<Index> holders;
    for (const GrainCopy& copy : interface.copies(row.grain)) holders.insert(interface.process_of(copy.subdomain));
    if (!holders.contains(processes.rank)) continue;
    const Index shared = count(start_) - 1, first = start_.back();
    start_.push_back(first);
    for (const GrainCopy& copy : interface.copies(row.grain)) {
      if (interface.process_of(copy.subdomain) == processes.rank)
        own_.push_back({copy.subdomain, copy.grain, shared, start_.back()});
      ++start_.back();
    }
    for (const Index process : holders) {
      if (process == processes.rank) continue;
      const auto share = [process](std::map<Index, SharedEntries>& with, Index begin, Index end) {
        with[process].process = process;
        for (Index entry = begin; entry < end; ++entry) with[process].entries.push_back(entry);
      };
      share(copies_with, size<D> * first, size<D> * start_.back());
      share(grains_with, size_with_mark<D> * shared, size_with_mark<D> * (shared + 1));
    }
  }
  const auto between = [&](std::map<Index, SharedEntries>& with) {
    std::vector<SharedEntries> all;
    for (auto& [process, entries] : with) all.push_back(std::move(entries));
    return processes.between_neighbours(all);
  };
  add_copies_ = between(copies_with);
  add_grains_ = between(grains_with);
}

template <int D>
void SharedCopies<D>::add_up(CopiesOfGrains<D>& velocities) const {
  Vector all = Vector::Zero(size<D> * start_.back());
  for (const Copy& copy : own_) {
    const GrainUnknowns<D> v = unknowns(copy_in<D>(velocities, copy));
    std::ranges::copy(v, all.data() + size<D> * copy.place);
  }
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
  // Zeros without the sign of one would take it from a velocity that has it.
  Vector all = Vector::Constant(size_with_mark<D> * (count(start_) - 1), -0.0);
  for (const Index k : changed) {
    const Copy& copy = own_[at(k)];
    const GrainUnknowns<D> v = unknowns(copy_in<D>(velocities, copy));
    double* const entries = all.data() + size_with_mark<D> * copy.shared;
    std::ranges::copy(v, entries);
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
