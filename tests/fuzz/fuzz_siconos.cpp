// SPDX-License-Identifier: GPL-3.0-or-later
// Any text is a contact problem of Siconos or an Error; a problem is sound, and written it reads back bit for bit.
#include "formats/siconos_dat.hpp"
#include "require.hpp"

#include <cstddef>
#include <cstdint>

namespace {

using namespace nscdd;
using fuzzing::require;

std::optional<FclibFile> parse(std::string_view text) {
  try {
    return siconos_from_text(text, "fuzz.dat");
  } catch (const Error&) {
    return std::nullopt;
  }
}

void require_sound(const LocalFrictionProblem& problem) {
  require(problem.w.rows() == 2 * problem.contacts() && problem.w.cols() == problem.w.rows(), "W is 2c x 2c");
  require(problem.q.size() == 2 * problem.contacts(), "q has two numbers per contact");
}

void require_sound(const GlobalFrictionProblem& problem) {
  require(problem.h.rows() == problem.mass.rows() && problem.h.cols() == 2 * problem.contacts(), "H is n x 2c");
  require(problem.f.size() == problem.mass.rows() && problem.w.size() == 2 * problem.contacts(), "f and w fit");
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
