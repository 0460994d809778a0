// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/stiffest.hpp"

#include "linalg/sparse_entries.hpp"

namespace nscdd {

double stiffest(const Decomposition& parts) {
  double bound = 0;
  for (const Subdomain& subdomain : parts.subdomains) {
    if (subdomain.h.cols() == 0) continue;
    const SparseMatrix a = over_rows(subdomain.h.cwiseAbs(), subdomain.inertia.cwiseSqrt());
    const Vector rows = a * Vector::Ones(a.cols());
    bound = std::max(bound, (a.transpose() * rows).maxCoeff());
  }
  return parts.interface.processes().maximum(bound);
}

double inverse_at_most(const InterfaceOperator& x, const Vector& g) {
  const double in_generic = std::max(0.0, g.dot(x.solve_generic(g)));
  return std::isinf(x.flexibility()) ? in_generic : (1 + stiffest(x.decomposition()) / x.flexibility()) * in_generic;
}

}  // namespace nscdd
