// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/matrices/operators_file.hpp"

#include "files/hdf5_file.hpp"
#include "files/output_file.hpp"
#include "formats/matrices/matrix_market.hpp"

#include <filesystem>

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
  // HDF5 has the rows one after another, Eigen the columns.
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

std::string cell_as_toml(const Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return field_text(*text);
  return to_text(cell);
}

std::string manifest_head(const OperatorsHead& head, const Provenance& provenance) {
  std::string text =
      "# Operators of a case for other programs: each in a Matrix Market file beside this one, all in operators.h5.\n"
      "# `entries` are those stored in full; a symmetric Matrix Market file has the lower triangle alone.\n";
  for (const auto& [name, content] : provenance)
    if (name == "program" || name == "command_line") text += fmt::format("{} = {}\n", name, field_text(content));
  const ResultColumns<CaseSummary>& columns = case_columns();
  const Row cells = row(columns, head.of_case);
  for (std::size_t k = 0; k < columns.size(); ++k)
    text +=
        fmt::format("{} = {}  # {}\n", columns[k].heading.name, cell_as_toml(cells[k]), columns[k].heading.description);
  text += fmt::format("dofs_per_grain = {}  # d\n", head.dofs_per_grain);
  if (head.dense)
    text += fmt::format(
        "epsilon = {}  # 1/kg, of the linear law, behind S\neta = {}  # 1/kg, of Stage 2, behind P\n"
        "relaxation = {}  # omega of B\n",
        field_text(head.dense->epsilon), field_text(head.dense->eta), field_text(head.dense->relaxation));
  return text;
}

}  // namespace

struct OperatorsFolder::Contents {
  hdf5::File hdf5;
  std::string manifest;  // its tables
};

OperatorsFolder::OperatorsFolder(const std::string& path, bool force, const std::string& program)
    : folder_(path, force), program_(program), contents_(std::make_unique<Contents>()) {}

OperatorsFolder::~OperatorsFolder() = default;

void OperatorsFolder::add(const CaseOperator& one) {
  std::error_code ignored;
  if (contents_->manifest.empty())
    std::filesystem::remove(std::filesystem::path(folder_.path()) / manifest_name, ignored);
  MatrixMarketHead head{{fmt::format("{}: {}", one.name, one.meaning)}, one.symmetric};
  if (!one.formula.empty()) head.remarks.push_back("formula: " + one.formula);
  if (!one.unit.empty()) head.remarks.push_back("unit: " + one.unit);
  head.remarks.push_back(fmt::format("written by {}; {} says what belongs to it", program_, manifest_name));
  OutputFile file(folder_.next(file_of(one)), folder_.force());
  std::visit(
      [&](const auto& values) {
        write_matrix_market(values, head, [&](std::string_view text) { file.bytes(text); });
        put(contents_->hdf5.root(), one, values);
      },
      one.values);
  file.finish();
  contents_->manifest += manifest_table(one);
}

void OperatorsFolder::finish(const OperatorsHead& head, const Provenance& provenance) {
  hdf5::put_provenance(contents_->hdf5.root(), provenance);
  write_file(folder_.next(hdf5_name), contents_->hdf5.bytes(), folder_.force());
  write_file(folder_.next(manifest_name), manifest_head(head, provenance) + contents_->manifest, folder_.force());
  folder_.finish();
}

}  // namespace nscdd
