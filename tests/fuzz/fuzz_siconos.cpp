// SPDX-License-Identifier: GPL-3.0-or-later
// Any text is a contact problem of Siconos or an Error; a problem is sound, and written it reads back bit for bit.
#include "formats/contact_problem/siconos_dat.hpp"
#include "require.hpp"

namespace {

using namespace nscdd;
using namespace fuzzing;

std::optional<FclibFile> parse(std::string_view text) {
  return unless_error([&] { return siconos_from_text(text, "fuzz.dat"); });
}

void require_sound(const LocalFrictionProblem& problem) {
  require(problem.dimension == 2 || problem.dimension == 3, "a problem is in the plane or in space");
  require(problem.w.rows() == problem.dimension * problem.contacts(), "W has D rows per contact");
  require(problem.w.cols() == problem.w.rows() && problem.q.size() == problem.w.rows(), "W is square, q fits");
}

void require_sound(const GlobalFrictionProblem& problem) {
  require(problem.h.rows() == problem.mass.rows() && problem.h.cols() == problem.dimension * problem.contacts(),
          "H is n x D c");
  require(problem.f.size() == problem.mass.rows() && problem.w.size() == problem.h.cols(), "f and w fit");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::optional<FclibFile> file = parse({reinterpret_cast<const char*>(data), size});
  if (!file) return 0;
  std::visit([](const auto& problem) { require_sound(problem); }, file->problem);
  const std::string text = siconos_text(*file, "nscdd");
  const std::optional<FclibFile> back = parse(text);
  require(back.has_value(), "what is written is read");
  require(back->problem.index() == file->problem.index(), "a local problem stays local, a global one global");
  require(siconos_text(*back, "nscdd") == text, "what is written reads back bit for bit");
  return 0;
}
