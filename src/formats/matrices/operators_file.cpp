// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/matrices/operators_file.hpp"

#include "core/fail.hpp"
#include "files/hdf5_file.hpp"
#include "linalg/sparse_entries.hpp"

namespace nscdd {
namespace {

using hdf5::Group;

std::string_view kind_of(const CaseOperator& one) {
  constexpr std::array<std::string_view, 3> kinds{"sparse", "dense", "numbers"};
  return kinds.at(one.values.index());
}

std::string_view truth(bool value) { return value ? "true" : "false"; }

std::vector<std::pair<const char*, std::string_view>> attributes_of(const CaseOperator& one) {
  return {{"formula", one.formula}, {"meaning", one.meaning}, {"unit", one.unit}, {"symmetric", truth(one.symmetric)}};
}

void put(const Group& root, const CaseOperator& one, SparseMatrix matrix) {
  matrix.makeCompressed();
  const Group group = root.make_group(one.name);
  for (const auto& [name, text] : attributes_of(one)) group.put_attribute(name, text);
  group.put_attribute("format", "csc");
  const std::array<std::int64_t, 2> shape{matrix.rows(), matrix.cols()};
  group.put<std::int64_t>("shape", shape);
  group.put<std::int32_t>("indptr", {matrix.outerIndexPtr(), at(matrix.cols() + 1)});
  group.put<std::int32_t>("indices", {matrix.innerIndexPtr(), at(matrix.nonZeros())});
  group.put<double>("data", {matrix.valuePtr(), at(matrix.nonZeros())});
}

void put(const Group& root, const CaseOperator& one, const Matrix& matrix) {
  const auto put_rows = [&](const Matrix& rows) {
    root.put<double>(one.name, {rows.data(), at(rows.size())},
                     {.attributes = attributes_of(one), .rows = at(matrix.rows())});
  };
  // HDF5 is row-major, Eigen column-major.
  one.symmetric ? put_rows(matrix) : put_rows(matrix.transpose());
}

void put(const Group& root, const CaseOperator& one, const std::vector<Index>& numbers) {
  const std::vector<std::int64_t> values(numbers.begin(), numbers.end());
  root.put<std::int64_t>(one.name, values, {.attributes = attributes_of(one)});
}

Index stored_entries(const CaseOperator& one) {
  if (const auto* sparse = std::get_if<SparseMatrix>(&one.values)) return sparse->nonZeros();
  return one.shape()[0] * one.shape()[1];
}

std::string file_of(const CaseOperator& one) { return one.name + ".mtx"; }

std::string manifest_table(const CaseOperator& one) {
  const auto [rows, columns] = one.shape();
  return fmt::format(
      "\n[[operator]]\nname = \"{}\"\nfile = \"{}\"\nhdf5 = \"/{}\"\nkind = \"{}\"\nformula = {}\nmeaning = {}\n"
      "unit = {}\nrows = {}\ncolumns = {}\nentries = {}\nsymmetric = {}\n",
      one.name, file_of(one), one.name, kind_of(one), field_text(one.formula), field_text(one.meaning),
      field_text(one.unit), rows, columns, stored_entries(one), truth(one.symmetric));
}

std::string manifest_head(const CaseSummary& of_case, Index dofs_per_grain, const OperatorParameters& parameters,
                          const Provenance& provenance) {
  std::string text =
      "# Operators of a case for other programs: each in a Matrix Market file beside this one, all in operators.h5.\n"
      "# `entries` are those stored in full; a symmetric Matrix Market file has only the lower triangle.\n";
  for (const auto& [name, content] : provenance)
    if (name == "program" || name == "command_line") text += fmt::format("{} = {}\n", name, field_text(content));
  const ResultColumns<CaseSummary>& columns = case_columns();
  const Row cells = row(columns, of_case);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto* words = std::get_if<std::string>(&cells[k]);
    text += fmt::format("{} = {}  # {}\n", columns[k].heading.name, words ? field_text(*words) : to_text(cells[k]),
                        columns[k].heading.description);
  }
  text += fmt::format("dofs_per_grain = {}  # d\n", dofs_per_grain);
  if (parameters.dense)
    text += fmt::format(
        "epsilon = {}  # 1/kg, of the linear law, behind S\neta = {}  # 1/kg, of Stage 2, behind P\n"
        "relaxation = {}  # omega of B\n",
        field_text(parameters.epsilon), field_text(parameters.eta), field_text(parameters.relaxation));
  return text;
}

// Text of a matrix in the Matrix Market exchange formats (https://math.nist.gov/MatrixMarket/formats.html), written in
// pieces. Numbers have 17 significant digits, so they read back bit for bit. Rows and columns count from 1. Of a matrix
// that is symmetric to the last bit only the lower triangle is written.
class MatrixMarket {
 public:
  MatrixMarket(OutputFile& file, bool symmetric, std::vector<std::string> remarks)
      : file_(file), symmetric_(symmetric), remarks_(std::move(remarks)) {}

  // The stored entries, zeros among them, column by column.
  void write(const SparseMatrix& matrix) {
    const auto written = [&](Index i, Index j) { return !symmetric_ || i >= j; };
    Index entries = 0;
    for_entries(matrix, [&](Index i, Index j, double) { entries += written(i, j); });
    head("coordinate", "real");
    add("{} {} {}\n", matrix.rows(), matrix.cols(), entries);
    for_entries(matrix, [&](Index i, Index j, double value) {
      if (written(i, j)) add("{} {} {:.17g}\n", i + 1, j + 1, value);
    });
  }
  // Every entry, column by column.
  void write(const Matrix& matrix) {
    head("array", "real");
    add("{} {}\n", matrix.rows(), matrix.cols());
    for (Index j = 0; j < matrix.cols(); ++j)
      for (Index i = symmetric_ ? j : 0; i < matrix.rows(); ++i) add("{:.17g}\n", matrix(i, j));
  }
  void write(const std::vector<Index>& numbers) {
    head("array", "integer");
    add("{} 1\n", numbers.size());
    for (const Index number : numbers) add("{}\n", number);
  }
  // Gives the pieces that are left to the file.
  void hand_on() {
    file_.bytes({text_.data(), text_.size()});
    text_.clear();
  }

 private:
  void head(std::string_view form, std::string_view field) {
    add("%%MatrixMarket matrix {} {} {}\n", form, field, symmetric_ ? "symmetric" : "general");
    for (std::string& remark : remarks_) {
      std::ranges::replace_if(
          remark, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
      add("% {}\n", remark);
    }
  }
  template <class... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    constexpr std::size_t piece = 1 << 18;
    fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    if (text_.size() >= piece) hand_on();
  }

  OutputFile& file_;
  bool symmetric_;
  std::vector<std::string> remarks_;
  fmt::memory_buffer text_;
};

}  // namespace

OperatorsFolder::OperatorsFolder(std::string path, bool force, const std::string& program)
    : path_(path),
      force_(force),
      made_(make_folder(path, force)),
      program_(program),
      hdf5_(std::make_unique<hdf5::File>()) {}

OperatorsFolder::~OperatorsFolder() {
  files_.clear();
  std::error_code ignored;
  if (made_ && fs::is_empty(path_, ignored)) fs::remove(path_, ignored);
}

OutputFile& OperatorsFolder::open(const std::string& name) { return files_.emplace_back(path_ / name, force_); }

void OperatorsFolder::add(const CaseOperator& one) {
  std::vector<std::string> remarks{fmt::format("{}: {}", one.name, one.meaning)};
  if (!one.formula.empty()) remarks.push_back("formula: " + one.formula);
  if (!one.unit.empty()) remarks.push_back("unit: " + one.unit);
  remarks.push_back(fmt::format("written by {}; {} says what belongs to it", program_, manifest_name));
  OutputFile& file = open(file_of(one));
  MatrixMarket text(file, one.symmetric, std::move(remarks));
  std::visit(
      [&](const auto& values) {
        text.write(values);
        text.hand_on();
        put(hdf5_->root(), one, values);
      },
      one.values);
  file.close();
  tables_ += manifest_table(one);
}

void OperatorsFolder::finish(const CaseSummary& of_case, Index dofs_per_grain, const OperatorParameters& parameters,
                             const Provenance& provenance) {
  hdf5::put_provenance(hdf5_->root(), provenance);
  open(hdf5_name).bytes(hdf5_->bytes());
  open(manifest_name).bytes(manifest_head(of_case, dofs_per_grain, parameters, provenance) + tables_);
  std::error_code ignored;
  fs::remove(path_ / manifest_name, ignored);
  for (OutputFile& file : files_) file.finish();
}

}  // namespace nscdd
