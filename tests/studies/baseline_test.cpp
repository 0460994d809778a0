// SPDX-License-Identifier: GPL-3.0-or-later
// Every study gives its baseline again, and says what it is about.
#include <nscdd/io/config.hpp>
#include <nscdd/io/csv.hpp>
#include <nscdd/study/study.hpp>

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>

using namespace nscdd;

TEST_CASE("studies: folder complete, tables equal to their baselines to 1e-8") {
  const char* source = std::getenv("NSCDD_SOURCE");
  REQUIRE(source != nullptr);
  const std::filesystem::path root(source);
  int studies = 0;
  for (const auto& entry : std::filesystem::directory_iterator(root / "studies")) {
    if (!entry.is_directory()) continue;
    CAPTURE(entry.path().string());
    const std::string file = (entry.path() / "study.toml").string();
    const Study study = parse_study(read_text(file), file, [&](const std::string& name) {
      return read_case((root / "cases" / (name + ".toml")).string());
    });
    const std::string readme = read_text((entry.path() / "README.md").string());
    for (const char* part : {"## Question", "## What to expect", "## What was found"}) {
      CAPTURE(part);
      CHECK(readme.find(part) != std::string::npos);
    }
    for (std::size_t i = 0; i < study.tables.size(); ++i) {
      Table table{study_columns(study.tables[i]), {}};
      run_table(study.tables[i], [&](const Row& row) { table.rows.push_back(row); });
      const std::string name = i == 0 ? "baseline.csv" : "baseline-" + study.tables[i].name + ".csv";
      const std::string path = (entry.path() / name).string();
      CHECK(compare(table, parse_csv(read_text(path), path), 1e-8) == "");
    }
    ++studies;
  }
  CHECK(studies >= 8);
}
