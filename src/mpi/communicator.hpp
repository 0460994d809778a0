// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/processes.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// Whether MPI is finalised, so that its objects must no longer be freed.
inline bool mpi_has_ended() {
  int finalised = 0;
  MPI_Finalized(&finalised);
  return finalised != 0;
}

/// A duplicate of a communicator, which counts what is sent. Freed with the object, unless MPI is finalised.
class Communicator {
 public:
  explicit Communicator(MPI_Comm of, std::shared_ptr<WorkCount> work = std::make_shared<WorkCount>())
      : work_(std::move(work)) {
    MPI_Comm_dup(of, &own_);
    MPI_Comm_rank(own_, &rank_);
    MPI_Comm_size(own_, &size_);
  }
  ~Communicator() {
    if (!mpi_has_ended()) MPI_Comm_free(&own_);
  }
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  MPI_Comm get() const { return own_; }
  int rank() const { return rank_; }
  int size() const { return size_; }
  const std::shared_ptr<WorkCount>& work() const { return work_; }
  /// Counts a message to another rank, of numbers of eight bytes.
  void count_message(Index numbers) const {
    ++work_->messages;
    work_->message_bytes += 8 * static_cast<double>(numbers);
  }
  /// Counts a collective exchange, to which this rank contributes so many bytes.
  void count_sum(std::size_t bytes) const {
    ++work_->sums;
    work_->sum_bytes += static_cast<double>(bytes);
  }

  /// See Processes::gather_bytes; not counted. Returns the number of items of each rank.
  std::vector<int> gather(std::span<const std::byte> own, std::size_t item, bool everywhere,
                          const Processes::Room& room) const;

 private:
  std::shared_ptr<WorkCount> work_;
  MPI_Comm own_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
};

}  // namespace nscdd::mpi
