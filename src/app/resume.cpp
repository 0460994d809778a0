// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/resume.hpp"

#include "app/interruption.hpp"
#include "app/progress.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

namespace nscdd::app {

void declare_resume(Command& command, bool& resume) {
  command.add_flag("--resume", resume,
                   "go on with the rows of an interrupted run; of the same case, options and program: what "
                   "is missing is computed");
}

bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how) {
  if (!how.resume || how.force || !is_complete(csv)) return false;
  if (!hdf5.empty() && !std::filesystem::exists(hdf5))
    throw Error(
        fmt::format("{}: expected rows to resume, met a complete table, and nothing tells what work it "
                    "came from: {} cannot be made of it; --force computes both again",
                    csv, hdf5));
  note(fmt::format("{}: already complete, nothing to resume", csv));
  return true;
}

std::optional<std::uintmax_t> leftover(bool resume) { return resume ? std::optional<std::uintmax_t>(0) : std::nullopt; }

int leave(ResumableTable& table, const std::string& path) {
  table.leave();
  const auto total = table.total();
  const std::string rows =
      total ? fmt::format("{} of {} rows", table.rows(), *total) : fmt::format("{} rows", table.rows());
  note(fmt::format("{}: interrupted after {}{}", path == "-" ? "standard output" : path, rows,
                   table.resumable() && total ? "; --resume continues" : ""));
  return interrupted_exit_code;
}

}  // namespace nscdd::app
