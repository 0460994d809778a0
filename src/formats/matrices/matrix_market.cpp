// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/matrices/matrix_market.hpp"

#include "linalg/sparse_entries.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

// Lines that are handed on in pieces of some size.
class Lines {
 public:
  Lines(const MatrixMarketHead& head, std::string_view form, std::string_view field, const TextSink& sink)
      : sink_(sink) {
    add("%%MatrixMarket matrix {} {} {}\n", form, field, head.symmetric ? "symmetric" : "general");
    for (std::string remark : head.remarks) {
      // Nothing in a remark may end its line.
      std::ranges::replace_if(
          remark, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
      add("% {}\n", remark);
    }
  }

  template <class... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    if (text_.size() >= piece) hand_on();
  }
  void hand_on() {
    sink_({text_.data(), text_.size()});
    text_.clear();
  }

 private:
  static constexpr std::size_t piece = 1 << 18;
  const TextSink& sink_;
  fmt::memory_buffer text_;
};

}  // namespace

void write_matrix_market(const SparseMatrix& matrix, const MatrixMarketHead& head, const TextSink& sink) {
  const auto written = [&](Index i, Index j) { return !head.symmetric || i >= j; };
  Index entries = 0;
  for_entries(matrix, [&](Index i, Index j, double) { entries += written(i, j); });
  Lines lines(head, "coordinate", "real", sink);
  lines.add("{} {} {}\n", matrix.rows(), matrix.cols(), entries);
  for_entries(matrix, [&](Index i, Index j, double value) {
    if (written(i, j)) lines.add("{} {} {:.17g}\n", i + 1, j + 1, value);
  });
  lines.hand_on();
}

void write_matrix_market(const Matrix& matrix, const MatrixMarketHead& head, const TextSink& sink) {
  Lines lines(head, "array", "real", sink);
  lines.add("{} {}\n", matrix.rows(), matrix.cols());
  for (Index j = 0; j < matrix.cols(); ++j)
    for (Index i = head.symmetric ? j : 0; i < matrix.rows(); ++i) lines.add("{:.17g}\n", matrix(i, j));
  lines.hand_on();
}

void write_matrix_market(const std::vector<Index>& numbers, const MatrixMarketHead& head, const TextSink& sink) {
  Lines lines(head, "array", "integer", sink);
  lines.add("{} 1\n", numbers.size());
  for (const Index number : numbers) lines.add("{}\n", number);
  lines.hand_on();
}

}  // namespace nscdd
