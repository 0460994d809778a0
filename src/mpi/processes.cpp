// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpi/communicator.hpp"
#include <nscdd/mpi/processes.hpp>

namespace nscdd::mpi {

std::vector<int> Communicator::gather(std::span<const std::byte> own, std::size_t item, bool everywhere,
                                      const Processes::Room& room) const {
  const auto items = static_cast<double>(own.size() / item);
  std::vector<double> of_each(at(size()));
  MPI_Allgather(&items, 1, MPI_DOUBLE, of_each.data(), 1, MPI_DOUBLE, own_);
  const double total = std::accumulate(of_each.begin(), of_each.end(), 0.0);
  if (total > std::numeric_limits<int>::max()) throw Error("processes: expected at most 2^31 items to gather");
  const std::vector<int> sizes(of_each.begin(), of_each.end());
  std::vector<int> first(sizes.size(), 0);
  std::partial_sum(sizes.begin(), sizes.end() - 1, first.begin() + 1);
  std::byte* const all = everywhere || rank() == 0 ? room(item * static_cast<std::size_t>(total)) : nullptr;
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(static_cast<int>(item), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  const int mine = sizes[at(rank())];
  if (everywhere)
    MPI_Allgatherv(own.data(), mine, type, all, sizes.data(), first.data(), type, own_);
  else
    MPI_Gatherv(own.data(), mine, type, all, sizes.data(), first.data(), type, 0, own_);
  MPI_Type_free(&type);
  return sizes;
}

namespace {

constexpr std::size_t numbers_at_a_time = std::size_t{1} << 28;  // MPI counts in int

void combine(const Communicator& all, std::span<double> numbers, MPI_Op operation) {
  while (!numbers.empty()) {
    const std::span<double> part = numbers.first(std::min(numbers.size(), numbers_at_a_time));
    const int size = static_cast<int>(part.size());
    all.count_sum(part.size_bytes());
    const bool root = all.rank() == 0;
    MPI_Reduce(root ? MPI_IN_PLACE : part.data(), root ? part.data() : nullptr, size, MPI_DOUBLE, operation, 0,
               all.get());
    MPI_Bcast(part.data(), size, MPI_DOUBLE, 0, all.get());
    numbers = numbers.subspan(part.size());
  }
}

// Persistent messages between neighbours, which send each other their parts of shared entries.
class Neighbourhood {
 public:
  Neighbourhood(std::shared_ptr<const Communicator> all, const std::vector<SharedEntries>& shared)
      : all_(std::move(all)), shared_(shared), sent_(shared.size()), received_(shared.size()) {
    for (std::size_t k = 0; k < shared_.size(); ++k) {
      const int size = static_cast<int>(shared_[k].entries.size()), other = static_cast<int>(shared_[k].process);
      sent_[k].resize(shared_[k].entries.size());
      received_[k].resize(shared_[k].entries.size());
      MPI_Send_init(sent_[k].data(), size, MPI_DOUBLE, other, 0, all_->get(), &requests_.emplace_back());
      MPI_Recv_init(received_[k].data(), size, MPI_DOUBLE, other, 0, all_->get(), &requests_.emplace_back());
    }
  }
  ~Neighbourhood() {
    if (mpi_has_ended()) return;
    for (MPI_Request& request : requests_) MPI_Request_free(&request);
  }
  Neighbourhood(const Neighbourhood&) = delete;
  Neighbourhood& operator=(const Neighbourhood&) = delete;

  void add_up(std::span<double> numbers) {
    if (shared_.empty()) return;  // MPI wants at least one request
    for (std::size_t k = 0; k < shared_.size(); ++k) {
      std::ranges::transform(shared_[k].entries, sent_[k].begin(), [&](Index i) { return numbers[at(i)]; });
      all_->count_message(static_cast<Index>(sent_[k].size()));
    }
    MPI_Startall(static_cast<int>(requests_.size()), requests_.data());
    MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
    for (std::size_t k = 0; k < shared_.size(); ++k)
      for (std::size_t i = 0; i < received_[k].size(); ++i) numbers[at(shared_[k].entries[i])] += received_[k][i];
  }

 private:
  std::shared_ptr<const Communicator> all_;
  std::vector<SharedEntries> shared_;
  std::vector<std::vector<double>> sent_, received_;
  std::vector<MPI_Request> requests_;
};

}  // namespace

Processes processes_of(MPI_Comm communicator) {
  const auto all = std::make_shared<const Communicator>(communicator);
  return {.rank = all->rank(),
          .size = all->size(),
          .add_up = [all](std::span<double> numbers) { combine(*all, numbers, MPI_SUM); },
          .largest = [all](std::span<double> numbers) { combine(*all, numbers, MPI_MAX); },
          .gather_bytes =
              [all](std::span<const std::byte> own, std::size_t item, bool everywhere, const Processes::Room& room) {
                all->count_sum(sizeof(double));  // the sizes
                all->count_sum(own.size());
                all->gather(own, item, everywhere, room);
              },
          .between_neighbours =
              [all](const std::vector<SharedEntries>& shared) {
                return [here = std::make_shared<Neighbourhood>(all, shared)](std::span<double> numbers) {
                  here->add_up(numbers);
                };
              },
          .counts = all->work()};
}

}  // namespace nscdd::mpi
