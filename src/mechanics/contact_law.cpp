// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_law.hpp"

namespace nscdd {

ContactLaw contact_law(const Interaction& interaction, double h, double scale) {
  ContactLaw law = Alternatives<ContactLaw>::at(static_cast<std::size_t>(LawName{interaction.law}));
  std::visit([&](auto& one) { one = one.of(interaction, h, scale); }, law);
  return law;
}

}  // namespace nscdd
