// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include <nscdd/ddm/interface.hpp>

#include <map>
#include <set>

namespace nscdd {

Interface::Interface(Index dofs_per_grain, Index grains, const std::vector<std::span<const Index>>& held,
                     const std::vector<char>& tied, GluingShape shape)
    : dofs_(dofs_per_grain), shape_(shape), start_(at(grains + 1), 0), ties_(held.size()) {
  for (const auto& numbers : held) {
    held_.push_back(count(numbers));
    for (const Index grain : numbers) ++start_[at(grain + 1)];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  copies_.resize(at(start_.back()));
  std::vector<Index> next(start_.begin(), start_.end() - 1);
  for (Index e = 0; e < count(held); ++e)
    for (Index i = 0; i < count(held[at(e)]); ++i) copies_[at(next[at(held[at(e)][at(i)])]++)] = {e, i};
  for (Index grain = 0; grain < grains; ++grain) {
    if (!tied.empty() && tied[at(grain)] == 0) continue;
    const auto all = copies(grain);
    for (std::size_t k = 1; k < all.size(); ++k) {
      const GrainCopy &first = all[shape == GluingShape::chain ? k - 1 : 0], &second = all[k];
      ties_[at(first.subdomain)].push_back({count(gluing_), first.grain, 1});
      ties_[at(second.subdomain)].push_back({count(gluing_), second.grain, -1});
      gluing_.push_back({grain, first, second});
    }
  }
}

Interface Interface::of_process(const std::vector<Index>& process_of_subdomain, Processes processes) const {
  Interface shared = *this;
  for (std::size_t e = 0; e < process_of_subdomain.size(); ++e)
    if (process_of_subdomain[e] != processes.rank) {
      shared.ties_[e] = {};
      shared.held_[e] = 0;
    }
  shared.processes_ = std::move(processes);
  shared.process_of_ = process_of_subdomain;
  return shared;
}

Interface Interface::of_copies() const {
  Interface one = *this;
  one.gluing_.clear();
  one.between_neighbours_ = {};
  for (std::vector<Tie>& ties : one.ties_) ties.clear();
  for_glued_grains([&](Index grain, Index, Index) {
    for (const GrainCopy& copy : copies(grain)) {
      if (process_of(copy.subdomain) == processes_.rank)
        one.ties_[at(copy.subdomain)].push_back({count(one.gluing_), copy.grain, 1});
      one.gluing_.push_back({grain, copy, {-1, -1}});
    }
  });
  return one;
}

Interface shared_interface(Index dofs_per_grain, Index grains, std::vector<std::vector<Index>> held,
                           const std::vector<char>& tied, const std::vector<Index>& process_of_subdomain,
                           const Processes& processes, GluingShape shape) {
  const Index all_grains = processes.maximum(grains);
  std::vector<char> tied_of_all(at(all_grains), 1);
  std::copy(tied.begin(), tied.end(), tied_of_all.begin());
  std::vector<double> copies(at(all_grains), 0);
  for (const std::vector<Index>& numbers : held)
    for (const Index grain : numbers) copies[at(grain)] += tied_of_all[at(grain)];
  processes.add_up(copies);
  std::vector<std::array<Index, 2>> shared;  // grains that several subdomains hold, and these
  for (Index e = 0; e < count(held); ++e)
    for (const Index grain : held[at(e)])
      if (tied_of_all[at(grain)] != 0 && copies[at(grain)] > 1) shared.push_back({grain, e});
  for (const auto& [grain, e] : processes.gather(shared))
    if (!process_of_subdomain.empty() && process_of_subdomain[at(e)] != processes.rank) held[at(e)].push_back(grain);
  const std::vector<std::span<const Index>> known(held.begin(), held.end());
  return Interface(dofs_per_grain, all_grains, known, tied_of_all, shape).of_process(process_of_subdomain, processes);
}

void Interface::meet_neighbours() {
  between_neighbours_ = between_neighbours([this](Index row, Index) {
    return Entries{dofs_ * row, dofs_ * (row + multiplicity(gluing_[at(row)].grain) - 1)};
  });
}

std::function<void(std::span<double>)> Interface::between_neighbours(
    const std::function<Entries(Index, Index)>& entries) const {
  std::map<Index, std::vector<Index>> entries_with;
  for_glued_grains([&, k = Index{0}](Index grain, Index row, Index) mutable {
    std::set<Index> holders;
    for (const GrainCopy& copy : copies(grain)) holders.insert(process_of(copy.subdomain));
    if (holders.erase(processes_.rank) == 0) return;
    const auto [first, last] = entries(row, k++);
    for (const Index process : holders)
      for (Index entry = first; entry < last; ++entry) entries_with[process].push_back(entry);
  });
  std::vector<SharedEntries> shared;
  for (auto& [process, own] : entries_with) shared.push_back({process, std::move(own)});
  return processes_.between_neighbours(shared);
}

SparseMatrix Interface::matrix(Index subdomain) const {
  SparseEntries entries;
  for (const Tie& tie : ties(subdomain))
    for (Index k = 0; k < dofs_; ++k) entries.add(dofs_ * tie.row + k, dofs_ * tie.grain + k, tie.sign);
  return entries.matrix(size(), dofs_ * held_[at(subdomain)]);
}

bool Interface::same_rows(const Interface& other) const {
  const auto key = [](const Gluing& row) { return std::tuple(row.grain, row.first.subdomain, row.second.subdomain); };
  return dofs_ == other.dofs_ && std::ranges::equal(gluing_, other.gluing_, {}, key, key);
}

Vector Interface::exchange(const std::vector<Vector>& velocities) const {
  return exchange([&](Index e, Index grain) { return std::span(velocities[at(e)].data() + dofs_ * grain, at(dofs_)); });
}

Vector Interface::distribute(Index subdomain, const Vector& f) const {
  Vector impulses = Vector::Zero(dofs_ * held_[at(subdomain)]);
  for (const Tie& tie : ties(subdomain))
    impulses.segment(dofs_ * tie.grain, dofs_) += tie.sign * f.segment(dofs_ * tie.row, dofs_);
  return impulses;
}

double Interface::part_of_dot(Index subdomain, const Vector& f, const Vector& g) const {
  double sum = 0;
  for (const Tie& tie : ties(subdomain))
    if (tie.sign > 0) sum += f.segment(dofs_ * tie.row, dofs_).dot(g.segment(dofs_ * tie.row, dofs_));
  return sum;
}

void Interface::for_blocks_of_rows(const std::function<void(Index, Index)>& work) const {
  constexpr Index rows_of_block = 500;
  const Index rows = count(gluing_), blocks = rows / rows_of_block + 1;
  const auto begin_of = [&](Index block) {
    Index row = block * rows / blocks;
    while (row > 0 && row < rows && gluing_[at(row)].grain == gluing_[at(row - 1)].grain) ++row;
    return row;
  };
  if (blocks == 1) return work(0, rows);
  for_each_in_parallel(blocks, [&](Index block) { work(begin_of(block), begin_of(block + 1)); });
}

std::vector<Vector> Interface::copies_apart(const Vector& g) const {
  std::vector<Vector> velocities;
  for (const Index grains : held_) velocities.push_back(Vector::Zero(dofs_ * grains));
  for (Index row = 0; row < count(gluing_); ++row) {
    const auto& [grain, first, second] = gluing_[at(row)];
    velocities[at(second.subdomain)].segment(dofs_ * second.grain, dofs_) =
        velocities[at(first.subdomain)].segment(dofs_ * first.grain, dofs_) - g.segment(dofs_ * row, dofs_);
  }
  return velocities;
}

// From the last row: the impulse on the second copy is -F of its row; it is added to the first copy.
Vector Interface::collect(std::vector<Vector> impulses) const {
  Vector f(size());
  for (Index row = count(gluing_) - 1; row >= 0; --row) {
    const auto& [grain, first, second] = gluing_[at(row)];
    const auto leaf = impulses[at(second.subdomain)].segment(dofs_ * second.grain, dofs_);
    f.segment(dofs_ * row, dofs_) = -leaf;
    impulses[at(first.subdomain)].segment(dofs_ * first.grain, dofs_) += leaf;
  }
  return f;
}

// Unknown k of one grain, rows [first, last).
void Interface::balance(Index first, Index last, Index k, double inertia, const Vector& g, Vector& f) const {
  if (gluing_[at(first)].second.subdomain < 0) {  // of copies: X_inf = M_b^-1
    for (Index row = first; row < last; ++row) f[dofs_ * row + k] = inertia * g[dofs_ * row + k];
    return;
  }
  const bool chain = shape_ == GluingShape::chain;
  const double q = static_cast<double>(last - first + 1);
  const auto jump = [&](Index row) { return g[dofs_ * row + k]; };
  double position = 0, mean = 0;  // of the second copy of a row, the first copy of the grain being at 0
  for (Index row = first; row < last; ++row) {
    position = chain ? position - jump(row) : -jump(row);
    mean += position / q;
  }
  position = 0;
  double sum = 0;
  for (Index row = first; row < last; ++row) {
    sum += position - mean;
    f[dofs_ * row + k] = inertia * (chain ? sum : jump(row) + mean);
    position -= jump(row);
  }
}

}  // namespace nscdd
