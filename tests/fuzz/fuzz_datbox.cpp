// SPDX-License-Identifier: GPL-3.0-or-later
// Any five texts are a DATBOX or an Error, and what is made of it is a packing, a system that moves, or an Error.
#include "formats/lmgc90/datbox.hpp"
#include "require.hpp"

namespace {

using namespace nscdd;
using namespace fuzzing;

// The files one behind the other, parted by the character %; the last one is every table that they name.
DatboxTexts parted(std::string_view text) {
  DatboxTexts texts;
  for (std::string* file : {&texts.bodies, &texts.bulk, &texts.tact, &texts.driven, &texts.initial}) {
    const auto end = text.find('%');
    *file = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  texts.table = [table = std::string(text)](const std::string&) { return table; };
  return texts;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::optional<Datbox> datbox = unless_error([&] { return parse_datbox(parted(text), "fuzz"); });
  if (!datbox) return 0;
  const auto packing = unless_error([&] { return datbox_packing(*datbox, DatboxGrains::all); });
  if (!packing) return 0;
  check(*packing);  // throws, and so ends the program, for a packing that should not have passed
  require(count(packing->mass) == packing->size(), "every grain has a mass");
  try {
    const GranularScene start = scene(*packing, datbox_dynamics(*datbox));
    require(count(start.state.x) == packing->size(), "disks that are driven are grains of the packing");
  } catch (const Error&) {
  }
  return 0;
}
