// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpi/multifrontal.hpp"

#include "core/fail.hpp"
#include "linalg/multifrontal/dense_front.hpp"
#include "linalg/multifrontal/family.hpp"
#include "linalg/sparse_entries.hpp"
#include "mpi/communicator.hpp"
#include "mpi/elimination_tree.hpp"

#include <map>
#include <numeric>
#include <set>

namespace nscdd::mpi {
namespace {

// The lists of all processes.
std::vector<std::vector<Index>> gathered(const Communicator& all, const std::vector<Index>& own) {
  static_assert(sizeof(Index) == sizeof(std::int64_t));
  const int size = static_cast<int>(own.size());
  std::vector<int> sizes(at(all.size())), first(sizes.size(), 0);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, all.get());
  std::partial_sum(sizes.begin(), sizes.end() - 1, first.begin() + 1);
  std::vector<Index> numbers(at(first.back() + sizes.back()));
  MPI_Allgatherv(own.data(), size, MPI_INT64_T, numbers.data(), sizes.data(), first.data(), MPI_INT64_T, all.get());
  std::vector<std::vector<Index>> lists;
  for (std::size_t p = 0; p < sizes.size(); ++p)
    lists.emplace_back(numbers.begin() + first[p], numbers.begin() + first[p] + sizes[p]);
  return lists;
}

// Places of some numbers in a list that has them all.
std::vector<Index> places(const std::vector<Index>& numbers, const std::vector<Index>& list) {
  std::map<Index, Index> place;
  for (Index k = 0; k < count(list); ++k) place[list[at(k)]] = k;
  std::vector<Index> result;
  for (const Index number : numbers) result.push_back(place.at(number));
  return result;
}

// The rows of this process that its own tree of fronts has: its own, and behind them the border rows it touches.
struct OwnRows {
  explicit OwnRows(const InertiaPattern& pattern) : own(pattern.lower.rows() - pattern.border) {
    std::vector<char> met(at(pattern.border), 0);
    for_entries(pattern.lower, [&](Index i, Index j, double) {
      for (const Index row : {i, j})
        if (row >= own) met[at(row - own)] = 1;
    });
    for (Index row = 0; row < pattern.border; ++row)
      if (met[at(row)]) touched.push_back(row);
  }

  // Their pattern. The values of a matrix keep their order, for the columns that are left out are empty.
  SparseMatrix pattern(const SparseMatrix& lower) const {
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

  Index own;
  std::vector<Index> touched;  // numbers in the border, ascending
};

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

// The tree of this process's own fronts. Border rows that others touch, too, are kept, and what they tie here is
// eliminated before them.
SymmetricAnalysis own_analysis(const InertiaPattern& pattern, const OwnRows& rows, const std::vector<Index>& kept) {
  std::vector<char> is_kept(at(pattern.border), 0);
  for (const Index row : kept) is_kept[at(row)] = 1;
  std::map<std::pair<Index, bool>, Index> number;  // of a group without its kept rows, or of these
  InertiaPattern own{.lower = rows.pattern(pattern.lower), .group = {}, .border = count(rows.touched)};
  std::vector<char> kept_groups;
  const auto add = [&](Index row, bool keep) {
    const Index old = pattern.group[at(row)];
    if (old < 0) return own.group.push_back(-1);
    const auto [place, met] = number.try_emplace({old, keep}, count(kept_groups));
    if (met) kept_groups.push_back(keep);
    own.group.push_back(place->second);
  };
  for (Index i = 0; i < rows.own; ++i) add(i, false);
  // Matrices may differ between a border row and the others of its group, so these count as border, too.
  std::vector<Index> border;
  std::set<Index> groups_of_kept;
  for (const Index row : kept) groups_of_kept.insert(pattern.group[at(rows.own + row)]);
  for (Index i = 0; i < rows.own; ++i)
    if (groups_of_kept.contains(pattern.group[at(i)])) border.push_back(i);
  for (const Index row : rows.touched) {
    border.push_back(count(own.group));
    add(rows.own + row, is_kept[at(row)] != 0);
  }
  return {own.lower, own.group, groups_of_border(own), border, kept_groups};
}

// What all matrices of a pattern have in common.
struct Plan {
  Plan(std::shared_ptr<const Communicator> communicator, const InertiaPattern& pattern)
      : all(std::move(communicator)), rank(all->rank()), border(pattern.border), rows(pattern) {
    const std::vector<Index> group = first_of_group(pattern);
    sets = elimination_tree(gathered(*all, rows.touched), group);
    const ProcessSet& alone = sets[at(rank)];
    own = std::make_unique<SymmetricFamily>(own_analysis(pattern, rows, alone.handed_on));
    kept = own->analysis().kept_rows();
    std::vector<Index> touched_rows;
    for (const Index row : kept) touched_rows.push_back(rows.touched[at(row - rows.own)]);
    place_of_kept = places(touched_rows, alone.handed_on);
    place_of_eliminated = places(alone.eliminated, rows.touched);
    for (Index s = all->size(); s < count(sets); ++s)
      if (sets[at(s)].worker == rank) joint = s;
    if (!joint) return;
    const ProcessSet& set = sets[at(*joint)];
    std::vector<Index> in_front = set.eliminated;
    in_front.insert(in_front.end(), set.handed_on.begin(), set.handed_on.end());
    for (const std::size_t k : {0, 1}) place_of_child[k] = places(sets[at(set.children[k])].handed_on, in_front);
    for (std::size_t k = 0; k < set.eliminated.size(); ++k)
      if (k + 1 == set.eliminated.size() || group[at(set.eliminated[k])] != group[at(set.eliminated[k + 1])])
        group_ends.push_back(static_cast<Index>(k) + 1);
  }
  Index front_rows() const { return count(sets[at(*joint)].eliminated) + count(sets[at(*joint)].handed_on); }

  std::shared_ptr<const Communicator> all;
  Index rank, border;
  OwnRows rows;
  std::vector<ProcessSet> sets;
  std::unique_ptr<SymmetricFamily> own;
  std::vector<Index> kept;                 // rows that the own factor keeps, in its order
  std::vector<Index> place_of_kept;        // of each, among those that this process hands on
  std::vector<Index> place_of_eliminated;  // of border rows that are this process's alone, among those it touches
  std::optional<Index> joint;              // the set of several processes that this one puts together
  std::array<std::vector<Index>, 2> place_of_child;  // of what its children hand on, in its front
  std::vector<Index> group_ends;                     // of the rows that it eliminates
};

// Numbers on their way from a set to the one above it, or back.
class Messages {
 public:
  explicit Messages(const Plan& plan) : plan_(plan) {}

  void hand_up(Index set, Vector numbers) {
    const Index parent = plan_.sets[at(set)].parent;
    if (parent >= 0) send(worker(parent), set, std::move(numbers));
  }
  Vector from_child(Index set, Index size) { return receive(worker(set), set, size); }
  void hand_down(Index set, Vector numbers) { send(worker(set), set, std::move(numbers)); }
  Vector from_parent(Index set, Index size) {
    const Index parent = plan_.sets[at(set)].parent;
    return parent < 0 ? Vector(0) : receive(worker(parent), set, size);
  }

 private:
  Index worker(Index set) const { return plan_.sets[at(set)].worker; }
  void send(Index to, Index set, Vector numbers) {
    if (to == plan_.rank) {
      here_[set] = std::move(numbers);
    } else {
      MPI_Send(numbers.data(), length(numbers.size()), MPI_DOUBLE, static_cast<int>(to), static_cast<int>(set),
               plan_.all->get());
    }
  }
  Vector receive(Index from, Index set, Index size) {
    if (from == plan_.rank) return std::move(here_.at(set));
    Vector numbers(size);
    MPI_Recv(numbers.data(), length(size), MPI_DOUBLE, static_cast<int>(from), static_cast<int>(set), plan_.all->get(),
             MPI_STATUS_IGNORE);
    return numbers;
  }
  static int length(Index size) {
    if (size > std::numeric_limits<int>::max())
      fail(
          "processes: expected at most 2^31 numbers in a message, met {}: the subdomains of a process share too many "
          "grains with others",
          size);
    return static_cast<int>(size);
  }

  const Plan& plan_;
  std::map<Index, Vector> here_;  // what this process hands to itself, by set
};

Index packed_size(Index n) { return n * (n + 1) / 2; }

// The lower triangle, column by column.
Vector packed(const Matrix& lower) {
  Vector numbers(packed_size(lower.rows()));
  for (Index j = 0, k = 0; j < lower.cols(); k += lower.rows() - j, ++j)
    numbers.segment(k, lower.rows() - j) = lower.col(j).tail(lower.rows() - j);
  return numbers;
}

void add_packed(const Vector& numbers, const std::vector<Index>& place, Matrix& lower) {
  const double* next = numbers.data();
  for (std::size_t j = 0; j < place.size(); ++j)
    for (std::size_t i = j; i < place.size(); ++i)
      lower(std::max(place[i], place[j]), std::min(place[i], place[j])) += *next++;
}

// One factor, of which each process holds the part of its own rows and at most one front of several processes.
class SharedFactor {
 public:
  SharedFactor(std::shared_ptr<const Plan> plan, const SparseMatrix& lower, const std::array<double, 2>& parameters)
      : plan_(std::move(plan)), own_(plan_->own->factorise(lower, parameters)) {
    Messages messages(*plan_);
    messages.hand_up(plan_->rank, handed_on());
    if (plan_->joint) join(messages);
    const bool regular = own_.regular() && (!joint_ || joint_->regular());
    const Index here = regular ? own_.negative_eigenvalues() + (joint_ ? joint_->negative_eigenvalues() : 0) : 0;
    std::array<Index, 2> sums{regular ? 0 : 1, here};
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_INT64_T, MPI_SUM, plan_->all->get());
    regular_ = sums[0] == 0;
    negative_eigenvalues_ = sums[1];
  }

  bool regular() const { return regular_; }
  Index negative_eigenvalues() const { return negative_eigenvalues_; }

  // Solves with b on the own rows (nothing: zero) and `border` on all border rows. The solution on the own rows, in
  // front of that on the border, is right where `down` reaches.
  Vector solve(const Vector* b, const Vector& border, Fronts up, Fronts down) const {
    const Plan& plan = *plan_;
    const Index own = plan.rows.own;
    Messages messages(plan);
    Vector x(own + count(plan.rows.touched));
    if (b != nullptr)
      x.head(own) = b->head(own);
    else
      x.head(own).setZero();
    x.tail(count(plan.rows.touched)) = border(plan.rows.touched);
    x(plan.kept).setZero();  // they count once, where they are eliminated
    x = own_.go_forward(x, up);
    const ProcessSet& alone = plan.sets[at(plan.rank)];
    Vector values(count(alone.handed_on));
    values(plan.place_of_kept) = x(plan.kept);
    messages.hand_up(plan.rank, values);
    Vector result = Vector::Zero(own + plan.border);
    if (plan.joint) {
      const ProcessSet& set = plan.sets[at(*plan.joint)];
      Vector front = go_up(messages, border);
      go_down(messages, front);
      result.tail(plan.border)(set.eliminated) = front.head(count(set.eliminated));
    }
    x(plan.kept) = Vector(messages.from_parent(plan.rank, values.size())(plan.place_of_kept));
    x = own_.go_back(x, down);
    result.tail(plan.border)(alone.eliminated) = x.tail(count(plan.rows.touched))(plan.place_of_eliminated);
    MPI_Allreduce(MPI_IN_PLACE, result.data() + own, static_cast<int>(plan.border), MPI_DOUBLE, MPI_SUM,
                  plan.all->get());
    result.head(own) = x.head(own);
    return result;
  }

 private:
  // The Schur complement of the own part.
  Vector handed_on() {
    const Matrix block = own_.take_kept_block();
    const Index n = block.rows();
    Vector numbers(packed_size(n));
    const std::vector<Index>& place = plan_->place_of_kept;
    for (Index j = 0; j < n; ++j)
      for (Index i = j; i < n; ++i) {
        const auto [column, row] = std::minmax(place[at(i)], place[at(j)]);
        numbers[packed_size(n) - packed_size(n - column) + row - column] = block(i, j);
      }
    return numbers;
  }

  void join(Messages& messages) {
    const ProcessSet& set = plan_->sets[at(*plan_->joint)];
    Matrix front = Matrix::Zero(plan_->front_rows(), plan_->front_rows());
    for (const std::size_t k : {0, 1}) {
      const std::vector<Index>& place = plan_->place_of_child[k];
      add_packed(messages.from_child(set.children[k], packed_size(count(place))), place, front);
    }
    joint_ = std::make_unique<DenseFront>(std::move(front), plan_->group_ends);
    messages.hand_up(*plan_->joint, packed(joint_->take_update()));
  }

  Vector go_up(Messages& messages, const Vector& border) const {
    const ProcessSet& set = plan_->sets[at(*plan_->joint)];
    Vector front = Vector::Zero(plan_->front_rows());
    front.head(count(set.eliminated)) = border(set.eliminated);
    for (const std::size_t k : {0, 1}) {
      const std::vector<Index>& place = plan_->place_of_child[k];
      front(place) += messages.from_child(set.children[k], count(place));
    }
    joint_->go_forward(front);
    messages.hand_up(*plan_->joint, front.tail(count(set.handed_on)));
    return front;
  }

  void go_down(Messages& messages, Vector& front) const {
    const ProcessSet& set = plan_->sets[at(*plan_->joint)];
    front.tail(count(set.handed_on)) = messages.from_parent(*plan_->joint, count(set.handed_on));
    joint_->go_back(front);
    for (const std::size_t k : {0, 1}) messages.hand_down(set.children[k], front(plan_->place_of_child[k]));
  }

  std::shared_ptr<const Plan> plan_;
  SymmetricFactor own_;
  std::unique_ptr<DenseFront> joint_;
  bool regular_ = false;
  Index negative_eigenvalues_ = 0;
};

InertiaFactor record_of(const std::shared_ptr<const SharedFactor>& factor, Index border) {
  if (!factor->regular()) return {};
  const auto on_border = [border](const Vector& x) -> Vector { return x.tail(border); };
  return {
      .regular = true,
      .negative_eigenvalues = factor->negative_eigenvalues(),
      .solve = [=](const Vector& b) { return factor->solve(&b, b.tail(border), Fronts::all, Fronts::all); },
      .solve_from_border = [=](const Vector& g) { return factor->solve(nullptr, g, Fronts::border, Fronts::all); },
      .solve_to_border =
          [=](const Vector& b) { return on_border(factor->solve(&b, b.tail(border), Fronts::all, Fronts::border)); },
      .solve_on_border =
          [=](const Vector& g) { return on_border(factor->solve(nullptr, g, Fronts::border, Fronts::border)); }};
}

}  // namespace

InertiaMethod multifrontal(MPI_Comm communicator) {
  const auto all = std::make_shared<const Communicator>(communicator);
  if (all->size() == 1) return nscdd::multifrontal();
  const auto analyse = [all](const InertiaPattern& pattern) {
    const auto plan = std::make_shared<const Plan>(all, pattern);
    const auto factorise = [plan](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
      return record_of(std::make_shared<const SharedFactor>(plan, lower, parameters), plan->border);
    };
    return InertiaFamily{factorise, [plan] { plan->own->release(); }};
  };
  return {"multifrontal", analyse};
}

}  // namespace nscdd::mpi
