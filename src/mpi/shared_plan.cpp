// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpi/shared_plan.hpp"

#include "linalg/sparse_entries.hpp"

#include <map>

namespace nscdd::mpi {
namespace {

// Adds the sets of ranks first ... last - 1 and returns the number of the whole. Halves are those of
// METIS_PartGraphRecursive, which numbers the parts of the first half before the others.
Index add_sets(std::vector<ProcessSet>& sets, Index first, Index last) {
  if (last - first == 1) return first;
  const Index middle = first + (last - first) / 2;
  const Index left = add_sets(sets, first, middle), right = add_sets(sets, middle, last), whole = count(sets);
  sets[at(left)].parent = sets[at(right)].parent = whole;
  // The last rank of the left half is the worker: no other set has the same one.
  sets.push_back({.first = first, .last = last, .worker = middle - 1, .children = {left, right}});
  return whole;
}

// The lists of all ranks.
std::vector<std::vector<Index>> gathered(const Communicator& all, const std::vector<Index>& own) {
  std::vector<Index> numbers;
  const std::vector<int> sizes = all.gather(std::as_bytes(std::span(own)), sizeof(Index), true, [&](std::size_t bytes) {
    numbers.resize(bytes / sizeof(Index));
    return reinterpret_cast<std::byte*>(numbers.data());
  });
  std::vector<std::vector<Index>> lists;
  auto next = numbers.begin();
  for (const int size : sizes) {
    lists.emplace_back(next, next + size);
    next += size;
  }
  return lists;
}

// Places of numbers in a list that contains them.
std::vector<Index> places(const std::vector<Index>& numbers, const std::vector<Index>& list) {
  std::map<Index, Index> place;
  for (Index k = 0; k < count(list); ++k) place[list[at(k)]] = k;
  std::vector<Index> result;
  for (const Index number : numbers) result.push_back(place.at(number));
  return result;
}

// The border rows that have an entry.
std::vector<Index> touched_rows(const InertiaPattern& pattern) {
  const Index own = pattern.lower.rows() - pattern.border;
  std::vector<char> met(at(pattern.border), 0);
  for_entries(pattern.lower, [&](Index i, Index j, double) {
    for (const Index row : {i, j})
      if (row >= own) met[at(row - own)] = 1;
  });
  std::vector<Index> rows;
  for (Index row = 0; row < pattern.border; ++row)
    if (met[at(row)]) rows.push_back(row);
  return rows;
}

// The pattern without the border rows that have no entry. The values of a matrix keep their order.
SparseMatrix without_empty_rows(const SparseMatrix& lower, Index own, const std::vector<Index>& touched) {
  std::vector<int> number(at(lower.rows()), -1);
  std::iota(number.begin(), number.begin() + own, 0);
  for (Index k = 0; k < count(touched); ++k) number[at(own + touched[at(k)])] = static_cast<int>(own + k);
  SparseMatrix result(own + count(touched), own + count(touched));
  result.resizeNonZeros(lower.nonZeros());
  std::fill_n(result.valuePtr(), lower.nonZeros(), 0.0);
  std::transform(lower.innerIndexPtr(), lower.innerIndexPtr() + lower.nonZeros(), result.innerIndexPtr(),
                 [&](int row) { return number[at(row)]; });
  for (Index j = 0; j < lower.cols(); ++j)
    if (number[at(j)] >= 0) result.outerIndexPtr()[number[at(j)]] = lower.outerIndexPtr()[j];
  result.outerIndexPtr()[result.cols()] = static_cast<int>(lower.nonZeros());
  return result;
}

// For each border row the first row of its group.
std::vector<Index> first_of_group(const InertiaPattern& pattern) {
  std::vector<Index> first(at(pattern.border));
  std::map<Index, Index> met;
  const Index own = pattern.lower.rows() - pattern.border;
  if (std::any_of(pattern.group.begin() + own, pattern.group.end(), [](Index group) { return group < 0; }))
    throw Error("processes: expected a group for each border row, met a row without one");
  for (Index row = 0; row < pattern.border; ++row)
    first[at(row)] = met.try_emplace(pattern.group[at(own + row)], row).first->second;
  return first;
}

// The tree of fronts of this rank. Border rows that others touch, too, are kept, after the rows that they tie.
SymmetricAnalysis own_analysis(const InertiaPattern& pattern, const std::vector<Index>& touched,
                               const std::vector<Index>& handed_on) {
  const Index own_rows = pattern.lower.rows() - pattern.border;
  InertiaPattern own{
      .lower = without_empty_rows(pattern.lower, own_rows, touched), .group = {}, .border = count(touched)};
  const auto groups = at(*std::ranges::max_element(pattern.group) + 1);
  std::vector<Index> kept(groups, -1), others(groups, -1);  // new numbers: of the rows handed on, and of all others
  GroupFlags flags;
  const auto number = [&flags](Index& group, bool keep) {
    if (group < 0) {
      group = count(flags.kept);
      flags.kept.push_back(keep);
    }
    return group;
  };
  for (const Index row : handed_on) number(kept[at(pattern.group[at(own_rows + row)])], true);
  // Matrices may differ between a border row and the rest of its group, which therefore counts as border.
  std::vector<Index> border;
  for (Index i = 0; i < own_rows + count(touched); ++i) {
    const bool on_border = i >= own_rows;
    const Index group = pattern.group[at(on_border ? own_rows + touched[at(i - own_rows)] : i)];
    const bool of_kept = group >= 0 && kept[at(group)] >= 0;
    if (on_border || of_kept) border.push_back(i);
    own.group.push_back(group < 0 ? -1 : on_border && of_kept ? kept[at(group)] : number(others[at(group)], false));
  }
  flags.last = groups_of_border(own);
  return {own.lower, own.group, flags, border};
}

}  // namespace

std::vector<ProcessSet> elimination_tree(const std::vector<std::vector<Index>>& touched,
                                         const std::vector<Index>& group) {
  struct Reach {  // the first and the last rank that touch rows of a group
    Index first = std::numeric_limits<Index>::max(), last = -1;
  };
  std::vector<Reach> reach(group.size());
  for (Index process = 0; process < count(touched); ++process)
    for (const Index row : touched[at(process)]) {
      Reach& of_group = reach[at(group[at(row)])];
      of_group = {std::min(of_group.first, process), process};
    }
  const auto group_by_group = [&](Index row) { return std::pair(group[at(row)], row); };
  std::vector<ProcessSet> sets;
  for (Index p = 0; p < count(touched); ++p) sets.push_back({.first = p, .last = p + 1, .worker = p});
  add_sets(sets, 0, count(touched));
  for (Index s = 0; s < count(sets); ++s) {
    ProcessSet& set = sets[at(s)];
    std::vector<Index> rows;
    if (set.children.empty()) {
      rows = touched[at(s)];
      std::ranges::sort(rows, {}, group_by_group);
    } else {
      const std::vector<Index>&left = sets[at(set.children[0])].handed_on, &right = sets[at(set.children[1])].handed_on;
      std::ranges::set_union(left, right, std::back_inserter(rows), {}, group_by_group, group_by_group);
    }
    for (const Index row : rows) {
      const Reach& of_row = reach[at(group[at(row)])];
      const bool here = set.first <= of_row.first && of_row.last < set.last;
      (here ? set.eliminated : set.handed_on).push_back(row);
    }
  }
  return sets;
}

void SharedPlan::add_work(const std::function<double(const EliminationWork&)>& flops) const {
  std::vector<double> path;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    double before = 0;
    for (const Index child : sets[s].children) before = std::max(before, path[at(child)]);
    path.push_back(before + flops(work[s]));
  }
  WorkCount& total = *all->work();
  total.flops += flops(work[at(rank)]) + (joint ? flops(work[at(*joint)]) : 0.0);
  total.path_flops += std::ranges::max(path);
}

SharedPlan::SharedPlan(std::shared_ptr<const Communicator> communicator, const InertiaPattern& pattern)
    : all(std::move(communicator)),
      rank(all->rank()),
      border(pattern.border),
      own_rows(pattern.lower.rows() - pattern.border),
      touched(touched_rows(pattern)) {
  const std::vector<Index> group = first_of_group(pattern);
  sets = elimination_tree(gathered(*all, touched), group);
  const ProcessSet& alone = sets[at(rank)];
  own = std::make_unique<SymmetricFamily>(own_analysis(pattern, touched, alone.handed_on));
  kept = own->analysis().kept_rows();
  place_of_eliminated = places(alone.eliminated, touched);
  const EliminationWork own_work = own->analysis().work();
  work.resize(at(all->size()));
  MPI_Allgather(&own_work, sizeof own_work, MPI_BYTE, work.data(), sizeof own_work, MPI_BYTE, all->get());
  for (Index s = all->size(); s < count(sets); ++s) {
    work.push_back(work_of_front(count(sets[at(s)].eliminated), count(sets[at(s)].handed_on)));
    if (sets[at(s)].worker == rank) joint = s;
  }
  if (!joint) return;
  const ProcessSet& set = joint_set();
  std::vector<Index> in_front = set.eliminated;
  in_front.insert(in_front.end(), set.handed_on.begin(), set.handed_on.end());
  for (const std::size_t k : {0, 1}) place_of_child[k] = places(sets[at(set.children[k])].handed_on, in_front);
  for (std::size_t k = 0; k < set.eliminated.size(); ++k)
    if (k + 1 == set.eliminated.size() || group[at(set.eliminated[k])] != group[at(set.eliminated[k + 1])])
      group_ends.push_back(static_cast<Index>(k) + 1);
}

}  // namespace nscdd::mpi
