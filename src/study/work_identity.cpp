// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fingerprint.hpp"
#include "study/study.hpp"
#include <nscdd/core/fields.hpp>
#include <nscdd/core/version.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

namespace nscdd {
namespace {

constexpr Index shown_values = 64;  // longer lists are told apart by their fingerprint

std::string version_text() {
  std::string text = fmt::format("nscdd {}\nbuild {}\n", version(), build_fingerprint());
  for (const auto& [name, number] : dependency_versions()) text += fmt::format("{} {}\n", name, number);
  return text;
}

std::string content(const Packing& packing) {
  std::vector<double> all;
  for (const auto* values : {&packing.x, &packing.y, &packing.radius, &packing.mass})
    all.insert(all.end(), values->begin(), values->end());
  return fmt::format("{} grains, content {}", packing.size(), fingerprint(all));
}

std::string content(const GlobalFrictionProblem& problem) {
  std::vector<double> all;
  for (const SparseMatrix* matrix : {&problem.mass, &problem.h})
    for (Index j = 0; j < matrix->cols(); ++j)
      for (SparseMatrix::InnerIterator e(*matrix, j); e; ++e)
        all.insert(all.end(), {static_cast<double>(e.row()), static_cast<double>(j), e.value()});
  for (const Vector* values : {&problem.f, &problem.w, &problem.friction})
    all.insert(all.end(), values->begin(), values->end());
  return fmt::format("{} contacts, content {}", problem.contacts(), fingerprint(all));
}

// The name of a file, wherever it lies, with its content.
std::string file_text(const std::string& path, const std::string& content) {
  return fmt::format("{} ({})", std::filesystem::path(path).filename().string(), content);
}

std::string case_text(const Case& one) {
  CaseSpec spec = one.spec;
  if (auto* file = std::get_if<PackingFile>(&spec.packing)) file->path = file_text(file->path, content(one.packing));
  if (auto* file = std::get_if<ContactProblemFile>(&spec.packing))
    file->path = file_text(file->path, content(one.problem));
  if (auto* settled = std::get_if<SettledFrom>(&spec.packing))
    settled->name = fmt::format("{} ({})", settled->name, content(one.packing));
  return fmt::format("name = {}\n", field_text(spec.name)) + to_toml(spec);
}

std::string list_text(const std::vector<std::string>& items) {
  const std::string text = fmt::format("{}", fmt::join(items, ", "));
  if (count(items) <= shown_values) return fmt::format("[{}]", text);
  return fmt::format("[{}, ..., {}], {} values, content {}", items.front(), items.back(), items.size(),
                     fingerprint(text));
}

// The text of a list of numbers. An empty one has a name of its own.
std::string number_list(const auto& values, const char* empty = "") {
  std::vector<std::string> texts;
  for (const std::optional value : values) texts.push_back(value ? field_text(*value) : empty);
  return list_text(texts);
}

std::string options_text(const StudyTable& table) {
  const SweepParameters& sweep = table.sweep;
  std::string text = fmt::format("observable = {}\n", table.observable->name);
  for (const Variation& variation : table.vary_together)
    text += fmt::format("together {} = {}\n", variation.parameter, list_text(variation.values));
  for (const Variation& variation : table.vary)
    text += fmt::format("{} = {}\n", variation.parameter, list_text(variation.values));
  text += fmt::format("epsilon = {}{}\neta = {}{}\nrelaxation = {}\ngauss_seidel_sweeps = {}\ncontacts = {}\n",
                      number_list(sweep.epsilon), sweep.relative_epsilon ? " W" : "", number_list(sweep.eta),
                      sweep.relative_eta ? " W" : "", number_list(sweep.relaxation, "optimal"),
                      number_list(sweep.gauss_seidel_sweeps, "inf"), to_string(sweep.contacts));
  if (table.observable->moving)
    text += fmt::format("steps = {}\nlead_in = {}\n", fmt::join(table.steps, ", "), to_string(table.lead_in));
  return text + fmt::format("seed = {}\n", table.seed);
}

// Every member of SpectralOptions but the factorisation, which no study chooses.
std::string effort_text(const SpectralOptions& options) {
  return fmt::format(
      "solver = {}\ndense_limit = {}\ntolerance = {}\nbasis = {}\nmaximum_restarts = {}\n"
      "arpack_tolerance = {}\ncertify = {}\neigenvalues = {}\n",
      to_string(options.solver), options.dense_limit, options.tolerance, options.arpack.basis,
      options.arpack.maximum_restarts, options.arpack.tolerance, options.certify, options.eigenvalues);
}

}  // namespace

WorkIdentity work_identity(const StudyTable& table) {
  std::string cases;
  for (const Case& one : table.cases) cases += case_text(one);
  return {version_text(), cases, options_text(table), effort_text(table.sweep.spectral)};
}

TableWork table_work(const StudyTable& table) {
  return {work_identity(table), study_columns(table), row_count(table),
          [&table](Index row) { return known_cells(table, row); }};
}

}  // namespace nscdd
