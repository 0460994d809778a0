// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include <nscdd/ddm/bddc.hpp>

namespace nscdd {

Index own_subdomain(const Decomposition& parts) {
  const Interface& glued = parts.interface;
  if (glued.processes().size != count(parts.subdomains))
    fail("bddc: expected as many processes as subdomains, {}, met {}", count(parts.subdomains), glued.processes().size);
  Index own = 0;
  while (glued.process_of(own) != glued.processes().rank) ++own;
  return own;
}

}  // namespace nscdd
