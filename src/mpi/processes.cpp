// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpi/processes.hpp"

#include "mpi/communicator.hpp"

#include <numeric>

namespace nscdd::mpi {
namespace {

constexpr std::size_t numbers_at_a_time = std::size_t{1} << 28;  // MPI counts in int

void combine(const Communicator& all, std::span<double> numbers, MPI_Op operation) {
  while (!numbers.empty()) {
    const std::span<double> part = numbers.first(std::min(numbers.size(), numbers_at_a_time));
    const int size = static_cast<int>(part.size());
    if (all.rank() == 0)
      MPI_Reduce(MPI_IN_PLACE, part.data(), size, MPI_DOUBLE, operation, 0, all.get());
    else
      MPI_Reduce(part.data(), nullptr, size, MPI_DOUBLE, operation, 0, all.get());
    MPI_Bcast(part.data(), size, MPI_DOUBLE, 0, all.get());
    numbers = numbers.subspan(part.size());
  }
}

std::vector<double> gathered(const Communicator& all, std::span<const double> own) {
  const int size = static_cast<int>(own.size());
  std::vector<int> sizes(static_cast<std::size_t>(all.size())), first(sizes.size(), 0);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, all.get());
  std::partial_sum(sizes.begin(), sizes.end() - 1, first.begin() + 1);
  std::vector<double> numbers(static_cast<std::size_t>(first.back() + sizes.back()));
  MPI_Allgatherv(own.data(), size, MPI_DOUBLE, numbers.data(), sizes.data(), first.data(), MPI_DOUBLE, all.get());
  return numbers;
}

}  // namespace

Processes processes_of(MPI_Comm communicator) {
  const auto all = std::make_shared<const Communicator>(communicator);
  return {.rank = all->rank(),
          .size = all->size(),
          .add_up = [all](std::span<double> numbers) { combine(*all, numbers, MPI_SUM); },
          .largest = [all](std::span<double> numbers) { combine(*all, numbers, MPI_MAX); },
          .gather = [all](std::span<const double> own) { return gathered(*all, own); }};
}

}  // namespace nscdd::mpi
