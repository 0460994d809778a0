// SPDX-License-Identifier: GPL-3.0-or-later
// Any text is a case or an Error; a case survives being written and read back, and builds or is an Error.
#include "formats/case/case_file.hpp"
#include "require.hpp"
#include "study/case/case.hpp"

namespace {

using namespace nscdd;
using namespace fuzzing;

std::optional<CaseSpec> parse(std::string_view text) {
  return unless_error([&] { return parse_case(text, "fuzz.toml"); });
}

Index grains(const Generator& generator) {
  return std::visit(
      [](const auto& one) -> Index {
        if constexpr (requires { one.grains; })
          return one.grains;
        else if constexpr (requires { one.sites; })
          return one.sites.columns * one.sites.rows * one.sites.layers;  // each at most 10^5
        else
          return one.columns * one.rows;
      },
      generator);
}

void require_sound(const Model& model) {
  const Index n = model.packing.size(), contacts = model.network.size();
  require(n >= 1, "a packing has a grain");
  require(count(model.packing.mass) == n, "every grain has a mass");
  require(model.problem.h.rows() == model.packing.dimension() * n && model.problem.h.cols() == contacts,
          "H has its shape");
  require(count(model.partition.subdomain_of_contact) == contacts, "every contact has a subdomain");
  Index distributed = 0;
  for (const Subdomain& subdomain : model.parts.subdomains) distributed += count(subdomain.contacts);
  require(distributed == contacts, "every contact is in one subdomain");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::optional<CaseSpec> one = parse({reinterpret_cast<const char*>(data), size});
  if (!one) return 0;
  const std::string written = to_toml(*one);
  const std::optional<CaseSpec> again = parse(written);
  require(again.has_value(), "a case as written can be read");
  require(to_toml(*again) == written, "a case as written reads back to the same case");
  // Large cases are legal, but what they cost says nothing about the parser.
  constexpr Index largest = 2000;
  const auto* generator = std::get_if<Generator>(&one->packing);  // a file cannot be read here
  if (!generator || grains(*generator) > largest || subdomains(one->partition) > largest) return 0;
  try {
    require_sound(build({*one}));
  } catch (const Error&) {
  }
  return 0;
}
