// SPDX-License-Identifier: GPL-3.0-or-later
// The layers of the library: a file includes its own layer or a lower one, never a higher one.
#include "../support/run_program.hpp"
#include "files/csv.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// From the lowest to the highest. A room of its own may be a folder of another one.
std::istringstream layer_names(
    "core files linalg packing mechanics contact_solvers ddm spectra two_stage simulation "
    "study study/case study/tables study/linear study/moving formats formats/lmgc90 formats/packing "
    "formats/contact_problem formats/matrices formats/case formats/trajectory formats/vtk formats/report app mpi");
const std::vector<std::string> layers{std::istream_iterator<std::string>(layer_names), {}};

// The layer of a file by its path, such as "study/case/case.hpp"; -1 for one of no layer.
std::ptrdiff_t layer_of(const std::string& path) {
  std::ptrdiff_t layer = -1;
  for (std::size_t i = 0; i < layers.size(); ++i)
    if (path.starts_with(layers[i] + "/") && (layer < 0 || layers[i].size() > layers[std::size_t(layer)].size()))
      layer = std::ptrdiff_t(i);
  return layer;
}

std::vector<fs::path> sources(const fs::path& root) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.path().extension() == ".hpp" || entry.path().extension() == ".cpp") files.push_back(entry.path());
  return files;
}

// What a file includes of this repository, such as "study/case/case.hpp", and whether it is a public header.
struct Included {
  std::string path;
  bool is_public;
};

std::vector<Included> includes_of(const std::string& text) {
  std::vector<Included> includes;
  for (const std::string marker : {"#include <nscdd/", "#include \""})
    for (std::size_t at = text.find(marker); at != std::string::npos; at = text.find(marker, at + 1)) {
      const std::size_t start = at + marker.size();
      includes.push_back({text.substr(start, text.find_first_of(">\"", start) - start), marker.back() == '/'});
    }
  return includes;
}

// Names of sources and their headers, "mechanics/path", that each name includes.
using IncludeGraph = std::map<std::string, std::set<std::string>>;

// Leaves out, again and again, names that include nothing that is left, or that nothing left includes.
IncludeGraph circles(IncludeGraph graph) {
  const auto is_end = [&](const auto& one) {
    return std::ranges::none_of(one.second, [&](const std::string& name) { return graph.contains(name); }) ||
           std::ranges::none_of(graph, [&](const auto& other) { return other.second.contains(one.first); });
  };
  for (auto found = graph.begin(); found != graph.end();) {
    found = std::ranges::find_if(graph, is_end);
    if (found != graph.end()) graph.erase(found->first);
  }
  return graph;
}

}  // namespace

TEST_CASE("no file includes a higher layer, and below app nothing prints") {
  int includes = 0;
  for (const fs::path& root :
       {nscdd::testing::source_folder() / "include" / "nscdd", nscdd::testing::source_folder() / "src"})
    for (const fs::path& file : sources(root)) {
      CAPTURE(file.string());
      if (file.filename() == "nscdd.hpp") continue;
      const auto own = layer_of(fs::relative(file, root).string());
      REQUIRE(own >= 0);
      const std::string text = nscdd::read_text(file.string());
      for (const Included& one : includes_of(text)) {
        CAPTURE(one.path);
        CHECK(layer_of(one.path) <= own);
        ++includes;
      }
      if (own != layer_of("app/"))
        for (const char* printing : {"fmt::print", "std::cout", "std::cerr", "printf("})
          CHECK(text.find(printing) == std::string::npos);
    }
  CHECK(includes > 100);
}

TEST_CASE("no sources include each other in a circle") {
  // A source and the header of its name count as one. A public header has types that its source may hand on to others.
  IncludeGraph graph;
  const fs::path root = nscdd::testing::source_folder() / "src";
  const auto name_of = [](const fs::path& file) { return (file.parent_path() / file.stem()).string(); };
  for (const fs::path& file : sources(root)) {
    const std::string name = name_of(fs::relative(file, root));
    for (const Included& one : includes_of(nscdd::read_text(file.string())))
      if (!one.is_public && name_of(one.path) != name) graph[name].insert(name_of(one.path));
  }
  CHECK(graph.size() > 100);
  for (const auto& [name, included] : circles(graph)) FAIL_CHECK(name);
  CHECK(circles({{"a", {"b"}}, {"b", {"c", "d"}}, {"c", {"a"}}, {"d", {"e"}}, {"f", {"a"}}}).size() == 3);
}

TEST_CASE("the public face is whole: it includes nothing but itself, and nscdd.hpp names every header of one process") {
  const fs::path include = nscdd::testing::source_folder() / "include";
  const std::string face = nscdd::read_text((include / "nscdd" / "nscdd.hpp").string());
  int headers = 0;
  for (const fs::path& file : sources(include)) {
    CAPTURE(file.string());
    CHECK(nscdd::read_text(file.string()).find("#include \"") == std::string::npos);
    if (file.filename() == "nscdd.hpp" || file.parent_path().filename() == "mpi") continue;
    CHECK(face.find("#include <" + fs::relative(file, include).string() + ">\n") != std::string::npos);
    ++headers;
  }
  CHECK(headers == std::count(face.begin(), face.end(), '<'));
}
