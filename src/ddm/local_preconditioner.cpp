// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/local_preconditioner.hpp"

#include "core/fail.hpp"
#include "linalg/threads.hpp"

namespace nscdd {

LocalPreconditioner::LocalPreconditioner(const Decomposition& parts, std::shared_ptr<const PrimalInterface> interface,
                                         LocalStiffness stiffness, std::shared_ptr<const CoarseProblem> coarse)
    : glued_(parts.interface), interface_(std::move(interface)), stiffness_(stiffness), coarse_(std::move(coarse)) {
  if (coarse_ && coarse_->size() == 0) coarse_.reset();
  if (coarse_ && stiffness_ == LocalStiffness::lumped)
    throw Error("coarse space: expected the preconditioner dirichlet with it, met lumped");
}

Vector LocalPreconditioner::solve(const Vector& g) const {
  const OneBlasThread serial_blas;
  const std::vector<CondensedSubdomain>& subdomains = interface_->subdomains;
  std::vector<Vector> whole = glued_.copies_apart(g), copies;
  for (std::size_t e = 0; e < whole.size(); ++e) copies.push_back(whole[e](subdomains[e].local));
  std::vector<std::size_t> shared;  // subdomains with shared grains: the BLAS takes no empty matrix
  for (std::size_t e = 0; e < copies.size(); ++e)
    if (copies[e].size() > 0) shared.push_back(e);
  const auto sum = [&](const auto& of_one) {
    Vector all = Vector::Zero(interface_->size());
    for (const std::size_t e : shared) all(subdomains[e].rows) += of_one(subdomains[e], copies[e]);
    return all;
  };
  const auto shift = [&](const Vector& u) {  // the same velocity of all copies changes no jump
    for (const std::size_t e : shared) copies[e] -= u(subdomains[e].rows);
  };
  if (coarse_)
    shift(coarse_->solve(
        sum([](const CondensedSubdomain& one, const Vector& o) -> Vector { return one.stiffness * o; })));
  Vector mean = sum([](const CondensedSubdomain& one, const Vector& o) -> Vector { return one.weights * o; });
  if (coarse_) mean -= coarse_->solve(interface_->apply(mean));
  shift(mean);
  for (const std::size_t e : shared)
    copies[e] = (stiffness_ == LocalStiffness::lumped ? subdomains[e].block : subdomains[e].stiffness) * copies[e];
  const Vector unbalanced = sum([](const CondensedSubdomain&, const Vector& p) -> const Vector& { return p; });
  for (Vector& impulses : whole) impulses.setZero();
  for (const std::size_t e : shared)
    whole[e](subdomains[e].local) = copies[e] - subdomains[e].weights.transpose() * unbalanced(subdomains[e].rows);
  return glued_.collect(std::move(whole));
}

}  // namespace nscdd
