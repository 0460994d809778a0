// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/manual.hpp"
#include "app/verbs.hpp"
#include "files/output_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text, bool force) {
  fs::create_directories(path.parent_path());
  OutputFile file(path.string(), force);
  file.bytes(text);
  file.finish();
  fmt::print("{}\n", path.string());
}

int run(const std::string& folder, bool force, const std::vector<DescribedVerb>& verbs) {
  const fs::path pages = fs::path(folder) / "man1";
  write(pages / "nscdd.1", manual_page(verbs), force);
  for (const DescribedVerb& verb : verbs) write(pages / fmt::format("nscdd-{}.1", verb.name), manual_page(verb), force);
  write(fs::path(folder) / "bash-completion" / "nscdd", bash_completion(verbs), force);
  return 0;
}

}  // namespace

std::function<int()> declare_manual(Command& command, const Context& context) {
  struct Options {
    std::string folder;
    bool force = false;
  };
  auto options = std::make_shared<Options>();
  command.add_option("FOLDER", options->folder, "receives man1/*.1 and bash-completion/nscdd")->required();
  command.add_flag("--force", options->force, "replace existing files");
  command.footer(
      "An installation has these files in their places already.\n"
      "Examples:\n"
      "  nscdd manual pages");
  return [options, verbs = context.verbs] { return run(options->folder, options->force, *verbs); };
}

}  // namespace nscdd::app
