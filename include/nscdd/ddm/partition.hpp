// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <vector>

namespace nscdd {

/// Contacts distributed among subdomains 0 ... subdomains-1 ([ADI12] section 2); a subdomain may be empty.
struct Partition {
  Index subdomains = 1;
  std::vector<Index> subdomain_of_contact;  ///< one per column of H
};

}  // namespace nscdd
