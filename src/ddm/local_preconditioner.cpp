// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/local_preconditioner.hpp"

#include "linalg/threads.hpp"

namespace nscdd {

LinearMap local_preconditioner(std::shared_ptr<const PrimalInterface> interface, InterfacePreconditioner kind,
                               std::shared_ptr<const CoarseProblem> coarse) {
  if (coarse && coarse->size() == 0) coarse.reset();
  const bool lumped = kind == InterfacePreconditioner::lumped;
  if (coarse && lumped) throw Error("coarse space: expected the preconditioner dirichlet with it, met lumped");
  return [interface, lumped, coarse](const Vector& g) {
    const OneBlasThread serial_blas;
    const std::vector<CondensedSubdomain>& subdomains = interface->subdomains;
    std::vector<Vector> copies = interface->glued.copies_apart(g);
    std::vector<std::size_t> shared;  // subdomains with shared grains: the BLAS takes no empty matrix
    for (std::size_t e = 0; e < copies.size(); ++e)
      if (copies[e].size() > 0) shared.push_back(e);
    const auto sum = [&](const auto& of_one) {
      Vector all = Vector::Zero(interface->size());
      for (const std::size_t e : shared) all(subdomains[e].rows) += of_one(e);
      return all;
    };
    const auto shift = [&](const Vector& u) {  // the same velocity of all copies changes no jump
      for (const std::size_t e : shared) copies[e] -= u(subdomains[e].rows);
    };
    if (coarse) shift(coarse->solve(sum([&](std::size_t e) -> Vector { return subdomains[e].stiffness * copies[e]; })));
    Vector mean = sum([&](std::size_t e) -> Vector { return subdomains[e].weights * copies[e]; });
    if (coarse) mean -= coarse->solve(interface->apply(mean));
    shift(mean);
    for (const std::size_t e : shared) copies[e] = (lumped ? subdomains[e].block : subdomains[e].stiffness) * copies[e];
    const Vector unbalanced = sum([&](std::size_t e) -> const Vector& { return copies[e]; });
    for (const std::size_t e : shared) copies[e] -= subdomains[e].weights.transpose() * unbalanced(subdomains[e].rows);
    return interface->glued.collect(std::move(copies));
  };
}

}  // namespace nscdd
