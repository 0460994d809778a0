// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/contact_problem/siconos_dat.hpp"

#include "core/fail.hpp"
#include "core/text.hpp"
#include "files/csv.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"
#include "linalg/sparse_entries.hpp"
#include <nscdd/core/fields.hpp>

#include <charconv>
#include <filesystem>

namespace nscdd {
namespace {

constexpr Index largest_index = std::numeric_limits<int>::max() - 1;

bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

class Words {
 public:
  Words(std::string_view text, std::string name)
      : rest_(without_byte_order_mark(text)), name_(std::move(name)), end_(line_end_of(text)) {
    require_utf8(text, name_);
  }

  // `what`: the expected word, for errors.
  std::string_view word(std::string_view what) {
    for (; !rest_.empty() && blank(rest_.front()); rest_.remove_prefix(1)) line_ += rest_.front() == end_;
    if (rest_.empty()) fail("{}: expected {}, met the end of the file", where(), what);
    const auto end = std::ranges::find_if(rest_, blank);
    const std::string_view found = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(found.size());
    return found;
  }
  // Formats the place of a number only for errors, because most numbers are valid.
  double number(std::string_view what) {
    const std::string_view text = word(what);
    const std::optional<double> value = number_of(text);
    return value ? *value : parse_number(text, named(what));
  }
  Index integer(std::string_view what, Index minimum, Index maximum = largest_index) {
    return bounded(word(what), what, minimum, maximum);
  }
  Index bounded(std::string_view text, std::string_view what, Index minimum, Index maximum) const {
    Index value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size()) value = parse_integer(text, named(what));
    if (value < minimum || value > maximum)
      fail("{}: expected an integer from {} to {}, met {}", named(what), minimum, maximum, value);
    return value;
  }
  void expect(std::string_view expected, std::string_view what) {
    if (const std::string_view met = word(what); met != expected)
      fail("{}: expected '{}', met '{}'", named(what), expected, met.substr(0, 40));
  }
  // A size, at most the number of words left in the file.
  Index size(std::string_view what) {
    const Index value = integer(what, 0);
    if (value > left())
      fail("{}: expected at least as many numbers behind it, met {}, and {} words to the end of the file", named(what),
           value, left());
    return value;
  }
  void skip_line() {
    const std::size_t end = rest_.find(end_);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (end != std::string_view::npos) ++line_;
  }
  // Words to the end of the file.
  Index left() const {
    Index words = 0;
    for (std::size_t i = 0; i < rest_.size(); ++i) words += !blank(rest_[i]) && (i == 0 || blank(rest_[i - 1]));
    return words;
  }
  std::string where() const { return fmt::format("{}:{}", name_, line_); }
  std::string named(std::string_view what) const { return fmt::format("{}: {}", where(), what); }

 private:
  std::string_view rest_;
  std::string name_;
  char end_;  // of lines
  Index line_ = 1;
};

struct Shape {
  Index rows = 0, columns = 0;
};

// The entries of a dense block, column by column. `rows`, `columns`: the first and the one after the last.
void read_block(Words& words, const std::string& name, SparseEntries& entries, std::pair<Index, Index> rows,
                std::pair<Index, Index> columns) {
  const std::string entry = "an entry of " + name;
  for (Index j = columns.first; j < columns.second; ++j)
    for (Index i = rows.first; i < rows.second; ++i)
      if (const double value = words.number(entry); value != 0) entries.add(i, j, value);
}

// A 0, then the ends of the block rows (or columns) of a matrix.
std::vector<Index> block_ends(Words& words, const std::string& what, Index blocks, Index size) {
  std::vector<Index> ends{0};
  for (Index k = 0; k < blocks; ++k) ends.push_back(words.integer(what, ends.back(), size));
  if (ends.back() != size) fail("{}: expected {} at last, met {}", words.named(what), size, ends.back());
  return ends;
}

SparseMatrix read_blocks(Words& words, const std::string& name, Shape shape) {
  const Index blocks = words.size("blocks of " + name);
  if (blocks == 0) return {shape.rows, shape.columns};
  const Index block_rows = words.size("block rows of " + name), block_columns = words.size("block columns of " + name);
  const std::vector<Index> row_ends = block_ends(words, "ends of block rows of " + name, block_rows, shape.rows);
  const std::vector<Index> column_ends =
      block_ends(words, "ends of block columns of " + name, block_columns, shape.columns);
  // Block-row pointers; trailing empty rows may be omitted.
  const Index places = words.integer("places of block rows of " + name, 1, block_rows + 1);
  words.integer("blocks of " + name, blocks, blocks);
  std::vector<Index> first;
  for (Index k = 0; k < places; ++k)
    first.push_back(words.integer("places of block rows of " + name, k == 0 ? 0 : first.back(), k == 0 ? 0 : blocks));
  std::vector<Index> column;
  for (Index k = 0; k < blocks; ++k) column.push_back(words.integer("block columns of " + name, 0, block_columns - 1));
  if (first.back() != blocks)
    fail("{}: expected {} blocks in the block rows, met {}", words.named(name), blocks, first.back());
  SparseEntries entries;
  for (std::size_t row = 0; row + 1 < first.size(); ++row)
    for (Index k = first[row]; k < first[row + 1]; ++k) {
      words.integer("number of a block of " + name, k, k);
      const std::size_t c = at(column[at(k)]);
      read_block(words, name, entries, {row_ends[row], row_ends[row + 1]}, {column_ends[c], column_ends[c + 1]});
    }
  return entries.matrix(shape.rows, shape.columns);
}

// An integer that a comma may follow.
Index counted(Words& words, std::string_view key, const std::string& name) {
  words.expect(key, fmt::format("{} of {}", key, name));
  const std::string what = fmt::format("number behind {} of {}", key, name);
  std::string_view text = words.word(what);
  if (text.ends_with(',')) text.remove_suffix(1);
  return words.bounded(text, what, 0, words.left());
}

SparseMatrix read_lines(Words& words, const std::string& name, Shape shape, bool by_columns, Index nonzeros) {
  const Index lines = by_columns ? shape.columns : shape.rows, width = by_columns ? shape.rows : shape.columns;
  const std::string of_line = "a line of " + name, of_entry = "an entry of " + name;
  SparseEntries entries;
  Index first = 0;
  for (Index line = 0; line < lines; ++line) {
    words.expect(by_columns ? "col" : "row", of_line);
    words.integer(of_line, line, line);
    words.expect(":", of_line);
    words.expect("locations", of_line);
    words.integer(of_line, first, first);
    words.expect("to", of_line);
    const Index last = words.integer(of_line, first - 1, nonzeros - 1);
    for (; first <= last; ++first) {
      const Index inner = words.integer(of_entry, 0, width - 1);
      words.expect(":", of_entry);
      const double value = words.number(of_entry);
      entries.add(by_columns ? inner : line, by_columns ? line : inner, value);
    }
  }
  if (first != nonzeros) fail("{}: expected {} entries, met {}", words.named(name), nonzeros, first);
  return entries.matrix(shape.rows, shape.columns);
}

SparseMatrix read_triplets(Words& words, const std::string& name, Shape shape, Index nonzeros) {
  const std::string entry = "an entry of " + name;
  SparseEntries entries;
  for (Index k = 0; k < nonzeros; ++k) {
    const Index i = words.integer(entry, 0, shape.rows - 1), j = words.integer(entry, 0, shape.columns - 1);
    words.expect(":", entry);
    entries.add(i, j, words.number(entry));
  }
  return entries.matrix(shape.rows, shape.columns);
}

SparseMatrix read_sparse(Words& words, const std::string& name, Shape shape) {
  const Index origin = words.integer("sparse storage of " + name, 1, 4);
  if (origin == 4)
    fail("{}: not supported: half of a symmetric matrix (4); expected 1 triplets, 2 columns or 3 rows",
         words.named(name));
  words.skip_line();
  words.skip_line();  // the version of CSparse
  if (origin != 2) words.expect(origin == 1 ? "triplet:" : "csr:", "kind of " + name);
  words.expect(fmt::format("{}-by-{},", shape.rows, shape.columns), "sizes of " + name);
  counted(words, "nzmax:", name);
  const Index nonzeros = counted(words, "nnz:", name);
  words.skip_line();
  if (origin == 1) return read_triplets(words, name, shape, nonzeros);
  return read_lines(words, name, shape, origin == 2, nonzeros);
}

SparseMatrix read_matrix(Words& words, const std::string& name) {
  const Index storage = words.integer("storage of " + name, 0, 2);
  const Shape shape{words.size("rows of " + name), words.size("columns of " + name)};
  if (storage == 1) return read_blocks(words, name, shape);
  if (storage == 2) return read_sparse(words, name, shape);
  words.integer("rows of " + name, shape.rows, shape.rows);
  words.integer("columns of " + name, shape.columns, shape.columns);
  SparseEntries entries;
  read_block(words, name, entries, {0, shape.rows}, {0, shape.columns});
  return entries.matrix(shape.rows, shape.columns);
}

Vector read_numbers(Words& words, const std::string& name, Index size) {
  Vector values(size);
  for (double& value : values) value = words.number(name);
  return values;
}

std::variant<LocalFrictionProblem, GlobalFrictionProblem> read_problem(Words& words) {
  const Index dimension = words.integer("dimension", 1, 6), contacts = words.size("contacts");
  if (dimension == 5)
    fail("{}: not supported: rolling friction ({} contacts, dimension 5); expected dimension 2 or 3", words.where(),
         contacts);
  if (dimension != 2 && dimension != 3) fail("{}: expected 2 or 3, met {}", words.named("dimension"), dimension);
  SparseMatrix matrix = read_matrix(words, "the first matrix");
  const Index numbers = (dimension + 1) * contacts;  // of q and mu
  if (matrix.rows() == dimension * contacts && words.left() <= numbers + 1)
    return LocalFrictionProblem{.w = std::move(matrix),
                                .q = read_numbers(words, "q", dimension * contacts),
                                .friction = read_numbers(words, "mu", contacts),
                                .dimension = dimension};
  GlobalFrictionProblem global{std::move(matrix), read_matrix(words, "H"), {}, {}, {}, dimension};
  global.f = read_numbers(words, "f", global.mass.rows());
  global.w = read_numbers(words, "w", dimension * contacts);
  global.friction = read_numbers(words, "mu", contacts);
  return global;
}

void write_matrix(std::string& text, const SparseMatrix& matrix, const std::string& program) {
  Index first = 0;
  double norm = 0;
  for (Index j = 0; j < matrix.cols(); ++j) norm = std::max(norm, matrix.col(j).cwiseAbs().sum());
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "2\n{0}\n{1}\n2\n{2} (in the layout of CSparse)\n{0}-by-{1}, nzmax: {3} nnz: {3}, 1-norm: {4:g}\n",
                 matrix.rows(), matrix.cols(), program, matrix.nonZeros(), norm);
  for (Index j = 0; j < matrix.cols(); ++j) {
    const Index entries = matrix.col(j).nonZeros();
    fmt::format_to(out, "    col {} : locations {} to {}\n", j, first, first + entries - 1);
    for (SparseMatrix::InnerIterator e(matrix, j); e; ++e)
      fmt::format_to(out, "      {} : {:.17g}\n", e.row(), e.value());
    first += entries;
  }
}

void write_numbers(std::string& text, const Vector& values) {
  for (const double value : values) fmt::format_to(std::back_inserter(text), "{:32.24e} ", value);
  text += '\n';
}

}  // namespace

FclibFile siconos_from_text(std::string_view text, const std::string& name) {
  Words words(text, name);
  FclibFile file;
  file.problem = read_problem(words);
  // Old versions end their files with a flag.
  if (words.left() == 1) words.integer("the end of the file, or 0 or 1", 0, 1);
  if (words.left() > 0) fail("{}: expected the end of the file, met {} further words", words.where(), words.left());
  std::visit([&](const auto& problem) { check(problem, name); }, file.problem);
  return file;
}

std::string siconos_text(const FclibFile& file, const std::string& program) {
  std::string text = fmt::format("{}\n{}\n", file.dimension(), file.contacts());
  if (const auto* local = std::get_if<LocalFrictionProblem>(&file.problem)) {
    write_matrix(text, local->w, program);
    write_numbers(text, local->q);
    write_numbers(text, local->friction);
  } else {
    const auto& global = std::get<GlobalFrictionProblem>(file.problem);
    write_matrix(text, global.mass, program);
    write_matrix(text, global.h, program);
    for (const Vector* values : {&global.f, &global.w, &global.friction}) write_numbers(text, *values);
  }
  return text;
}

bool has_siconos_name(const std::string& path) { return std::filesystem::path(path).extension() == ".dat"; }

FclibFile read_contact_problem(const std::string& path) {
  if (has_vloc_rloc_name(path) || holds_datbox(path)) return read_vloc_rloc(path);
  return has_siconos_name(path) ? siconos_from_text(read_text(path), path) : read_fclib(path);
}

}  // namespace nscdd
