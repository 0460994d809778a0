// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/multifrontal/fronts.hpp"
#include "mpi/shared_plan.hpp"
#include <nscdd/mpi/multifrontal.hpp>

#include <map>

namespace nscdd::mpi {
namespace {

// Messages between a set and its parent.
class Messages {
 public:
  explicit Messages(const SharedPlan& plan) : plan_(plan) {}

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
      plan_.all->count_message(numbers.size());
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

  const SharedPlan& plan_;
  std::map<Index, Vector> here_;  // messages of this rank to itself, by set
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

// One factor. Each rank holds the part of its own rows and at most one front of several ranks.
class SharedFactor {
 public:
  SharedFactor(std::shared_ptr<const SharedPlan> plan, const SparseMatrix& lower,
               const std::array<double, 2>& parameters)
      : plan_(std::move(plan)), own_(plan_->own->factorise(lower, parameters)) {
    Messages messages(*plan_);
    messages.hand_up(plan_->rank, packed(own_.take_kept_block()));
    if (plan_->joint) join(messages);
    const bool here = own_.regular() && (!joint_ || joint_->regular());
    const Index negative = here ? own_.negative_eigenvalues() + (joint_ ? joint_->negative_eigenvalues() : 0) : 0;
    std::array<Index, 2> sums{here ? 0 : 1, negative};
    plan_->all->count_sum(sizeof sums);
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_INT64_T, MPI_SUM, plan_->all->get());
    regular = sums[0] == 0;
    negative_eigenvalues = sums[1];
  }

  // Solves for b on the own rows and all border rows or, with `up` = border, on the latter only; likewise for `down`.
  Vector solve(const Vector& b, Fronts up, Fronts down) const {
    const SharedPlan& plan = *plan_;
    const Index own = plan.own_rows;
    plan.add_work([=](const EliminationWork& one) { return one.solve_flops(up, down); });
    Messages messages(plan);
    Vector x = Vector::Zero(own + count(plan.touched));
    const auto border = b.tail(plan.border);
    if (up == Fronts::all) x.head(own) = b.head(own);
    x.tail(count(plan.touched)) = border(plan.touched);
    x(plan.kept).setZero();  // counted once, in the set that eliminates them
    x = own_.go_forward(x, up);
    messages.hand_up(plan.rank, x(plan.kept));
    Vector result = Vector::Zero(own + plan.border);
    if (plan.joint) {
      const ProcessSet& set = plan.joint_set();
      Vector front = go_up(messages, border);
      go_down(messages, front);
      result.tail(plan.border)(set.eliminated) = front.head(count(set.eliminated));
    }
    x(plan.kept) = messages.from_parent(plan.rank, count(plan.kept));
    x = own_.go_back(x, down);
    result.tail(plan.border)(plan.sets[at(plan.rank)].eliminated) =
        x.tail(count(plan.touched))(plan.place_of_eliminated);
    plan.all->count_sum(sizeof(double) * at(plan.border));
    MPI_Allreduce(MPI_IN_PLACE, result.data() + own, static_cast<int>(plan.border), MPI_DOUBLE, MPI_SUM,
                  plan.all->get());
    if (down == Fronts::border) return result.tail(plan.border);
    result.head(own) = x.head(own);
    return result;
  }

  bool regular = false;
  Index negative_eigenvalues = 0;

 private:
  void join(Messages& messages) {
    const ProcessSet& set = plan_->joint_set();
    Matrix front = Matrix::Zero(plan_->front_rows(), plan_->front_rows());
    for (const std::size_t k : {0, 1}) {
      const std::vector<Index>& place = plan_->place_of_child[k];
      add_packed(messages.from_child(set.children[k], packed_size(count(place))), place, front);
    }
    joint_ = std::make_unique<DenseFront>(std::move(front), plan_->group_ends);
    messages.hand_up(*plan_->joint, packed(joint_->take_update()));
  }

  Vector go_up(Messages& messages, const Eigen::Ref<const Vector>& border) const {
    const ProcessSet& set = plan_->joint_set();
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
    const ProcessSet& set = plan_->joint_set();
    front.tail(count(set.handed_on)) = messages.from_parent(*plan_->joint, count(set.handed_on));
    joint_->go_back(front);
    for (const std::size_t k : {0, 1}) messages.hand_down(set.children[k], front(plan_->place_of_child[k]));
  }

  std::shared_ptr<const SharedPlan> plan_;
  SymmetricFactor own_;
  std::unique_ptr<DenseFront> joint_;
};

InertiaFactor record_of(const std::shared_ptr<const SharedFactor>& factor) {
  if (!factor->regular) return {};
  const auto solve = [&factor](Fronts up, Fronts down) {
    return [factor, up, down](const Vector& b) { return factor->solve(b, up, down); };
  };
  return {.regular = true,
          .negative_eigenvalues = factor->negative_eigenvalues,
          .solve = solve(Fronts::all, Fronts::all),
          .solve_from_border = solve(Fronts::border, Fronts::all),
          .solve_to_border = solve(Fronts::all, Fronts::border),
          .solve_on_border = solve(Fronts::border, Fronts::border)};
}

}  // namespace

InertiaMethod multifrontal(MPI_Comm communicator, std::shared_ptr<WorkCount> work) {
  const auto all = std::make_shared<const Communicator>(communicator, work);
  if (all->size() == 1) return nscdd::multifrontal(work);
  const auto analyse = [all](const InertiaPattern& pattern) {
    const auto plan = std::make_shared<const SharedPlan>(all, pattern);
    const auto factorise = [plan](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
      const bool anew = !plan->own->keeps_interior(parameters);
      plan->add_work([=](const EliminationWork& one) { return one.flops(anew); });
      return record_of(std::make_shared<const SharedFactor>(plan, lower, parameters));
    };
    return InertiaFamily{factorise, [plan] { plan->own->release(); }};
  };
  return {"multifrontal", analyse};
}

}  // namespace nscdd::mpi
