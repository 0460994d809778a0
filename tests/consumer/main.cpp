// SPDX-License-Identifier: GPL-3.0-or-later
// The paper in a few lines, against the installed library: rho(B_0) of the 4 disks is (29 + sqrt 57)/56.
#include <nscdd/ddm/contraction.hpp>
#include <nscdd/ddm/partitioners/grid.hpp>
#include <nscdd/ddm/spectral_radius.hpp>
#include <nscdd/packing/generator.hpp>

#include <cmath>
#include <iostream>

int main() {
  using namespace nscdd;
  const Packing packing = with_masses(generate(TriangularStrip{.grains = 4}), {MassModel::unit, 0});
  const ContactNetwork network = detect_contacts(packing);

  const auto problem = assemble(packing, network);
  const auto parts = decompose(problem, partition(GridPartitioner{{2, 1}}, packing, network));
  const auto b = contraction(parts, Generic{}, LinearViscous{.epsilon = 0});
  const auto rho = spectral_radius(b);  // value, ends of the spectrum, residual, applications, converged

  std::cout.precision(16);
  std::cout << "rho(B_0) = " << rho.value << ", residual " << rho.residual << '\n';
  return std::abs(rho.value - (29 + std::sqrt(57.0)) / 56) < 1e-14 && rho.converged ? 0 : 1;
}
