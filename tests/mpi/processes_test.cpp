// SPDX-License-Identifier: GPL-3.0-or-later
// What crosses from process to process.
#include "ranks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <vector>

using namespace nscdd;

namespace {

// Whether the others have the bits of the first process.
bool same_bits(double value) {
  double of_first = value;
  MPI_Bcast(&of_first, 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  return std::memcmp(&of_first, &value, sizeof value) == 0;
}

}  // namespace

TEST_CASE("processes: sums and maxima are those of all, with the same bits everywhere") {
  int size = 0, rank = -1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  CHECK(world().size == size);
  CHECK(world().rank == rank);
  CHECK(world().alone() == (size == 1));
  CHECK(world().sum(static_cast<double>(rank)) == size * (size - 1) / 2);
  CHECK(world().maximum(static_cast<double>(-rank)) == 0);
  CHECK(world().maximum(static_cast<double>(rank)) == size - 1);
  CHECK(world().any(rank == size - 1));
  CHECK(!world().any(false));
  double harmonic = 0;
  for (int k = 1; k <= size; ++k) harmonic += 1.0 / k;
  const double sum = world().sum(1.0 / (rank + 1));
  CHECK(std::abs(sum - harmonic) < 1e-15 * size);
  CHECK(same_bits(sum));
  std::vector<double> numbers(1000);
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = static_cast<double>(k) * (rank + 1);
  world().add_up(numbers);
  for (std::size_t k = 0; k < numbers.size(); ++k) CHECK(numbers[k] == static_cast<double>(k) * size * (size + 1) / 2);
}

TEST_CASE("processes: neighbours add up what they share, and nobody else takes part") {
  // A ring: entry k belongs to the processes k and k + 1. The last one shares with the first, and stays away where it
  // would be its own neighbour.
  const Index size = world().size, rank = world().rank;
  std::vector<SharedEntries> shared;
  const auto add = [&](Index process, std::vector<Index> entries) {
    if (process != rank) shared.push_back({process, std::move(entries)});
  };
  const Index next = (rank + 1) % size, before = (rank + size - 1) % size;
  if (next == before)
    add(next, rank == 0 ? std::vector<Index>{rank, before} : std::vector<Index>{before, rank});
  else if (next < before)
    add(next, {rank}), add(before, {before});
  else
    add(before, {before}), add(next, {rank});
  const auto add_up = world().between_neighbours(shared);
  for (const double factor : {1.0, 3.0}) {  // the same messages again
    std::vector<double> numbers(static_cast<std::size_t>(size + 1), 7);
    const auto entry = [&](Index k) -> double& { return numbers[static_cast<std::size_t>(k)]; };
    entry(rank) = factor;
    if (size > 1) entry(before) = 10 * factor;
    add_up(numbers);
    CHECK(entry(rank) == (size == 1 ? factor : 11 * factor));
    CHECK(entry(before) == (size == 1 ? factor : 11 * factor));
    CHECK(entry(size) == 7);
  }
}

TEST_CASE("processes: numbers are gathered in their order, at all, at the first, or of one after the other") {
  const Index size = world().size, rank = world().rank;
  const std::vector<double> own(static_cast<std::size_t>(rank), static_cast<double>(rank));  // none of the first
  std::vector<double> expected;
  for (Index k = 0; k < size; ++k) expected.insert(expected.end(), static_cast<std::size_t>(k), static_cast<double>(k));
  CHECK(world().gather(own) == expected);
  CHECK(world().gather(own, false) == (rank == 0 ? expected : std::vector<double>()));
  std::vector<double> met;
  Index turns = 0;
  world().exchange(own, [&](std::span<const double> numbers) {
    CHECK(static_cast<Index>(numbers.size()) == turns++);
    met.insert(met.end(), numbers.begin(), numbers.end());
  });
  CHECK(met == expected);
}

TEST_CASE("processes: items of any type are gathered, and whole numbers added up") {
  struct Item {
    Index rank;
    float half;
    char letter;
  };
  const auto rank = static_cast<int>(world().rank);
  const std::vector<Item> items = world().gather_each(Item{rank, 0.5F * static_cast<float>(rank), 'x'});
  REQUIRE(static_cast<Index>(items.size()) == world().size);
  for (Index k = 0; k < world().size; ++k) {
    const Item& one = items[static_cast<std::size_t>(k)];
    CHECK(one.rank == k);
    CHECK(one.half == 0.5F * static_cast<float>(k));
    CHECK(one.letter == 'x');
  }
  const std::vector<char> text = world().gather(std::string(static_cast<std::size_t>(rank), 'a'));
  CHECK(static_cast<Index>(text.size()) == world().size * (world().size - 1) / 2);
  CHECK(world().sum(Index{1}) == world().size);
  CHECK(world().maximum(Index{-rank}) == 0);
}

TEST_CASE("processes: what is sent is counted") {
  const Processes own = mpi::processes_of(MPI_COMM_WORLD);
  const WorkCount& counts = *own.counts;
  std::vector<double> numbers(10, 1.0);
  own.add_up(numbers);
  own.largest(std::span(numbers).first(3));
  own.gather(std::span(numbers).first(2));
  CHECK(counts.sums == 4);  // a gather is two, the first of the lengths
  CHECK(counts.sum_bytes == 8 * (10 + 3 + 1 + 2));
  CHECK(counts.messages == 0);
  std::vector<SharedEntries> shared;  // everybody with everybody
  for (Index other = 0; other < own.size; ++other)
    if (other != own.rank) shared.push_back({other, {0, 3, 4}});
  const auto add_up = own.between_neighbours(shared);
  for (int round = 1; round <= 2; ++round) {
    add_up(numbers);
    CHECK(counts.messages == static_cast<double>(round * (own.size - 1)));
    CHECK(counts.message_bytes == static_cast<double>(24 * round * (own.size - 1)));
  }
  CHECK(counts.sums == 4);
}

TEST_CASE("processes: what one of them throws, all throw, with its words") {
  struct Met {
    std::string text;
    bool elsewhere = false;
  };
  const auto met = [](const auto& work) {
    try {
      work();
    } catch (const FailedElsewhere& error) {
      return Met{error.what(), true};
    } catch (const Error& error) {
      return Met{error.what()};
    }
    return Met{};
  };
  for (Index culprit = 0; culprit < world().size; ++culprit) {
    const Met one = met([&] {
      world().together([&] {
        if (world().rank >= culprit) throw Error("too bad: " + std::to_string(world().rank) + ", met µ");
        return 1;
      });
    });
    CHECK(one.text == "too bad: " + std::to_string(culprit) + ", met µ");
    CHECK(one.elsewhere == (world().rank != culprit));
  }
  const Met inner = met([&] {  // one has failed, and all are together again further out
    world().together([&] {
      return world().together([&] {
        if (world().rank == world().size - 1) throw Error("the last one");
        return 1;
      });
    });
  });
  CHECK(inner.text == "the last one");
  CHECK(inner.elsewhere == (world().rank != world().size - 1));
  CHECK(world().together([] { return 7; }) == 7);
}

TEST_CASE("processes: a communicator of the caller is not disturbed") {
  MPI_Comm pair = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, static_cast<int>(world().rank) / 2, 0, &pair);
  {
    const Processes two = mpi::processes_of(pair);
    CHECK(two.sum(1) == static_cast<double>(two.size));
    CHECK(two.size <= 2);
  }
  int size = 0;
  MPI_Comm_size(pair, &size);  // it is still there
  CHECK(size >= 1);
  MPI_Comm_free(&pair);
}
