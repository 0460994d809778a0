// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/network.hpp"

namespace nscdd {

void complete_contact(DatboxContact& contact, bool space) {
  const Eigen::Vector3d n = contact.frame.col(0);
  if (!space) contact.frame.rightCols(2) << Eigen::Vector3d(n[1], -n[0], 0), Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d rest = contact.frame.transpose() * contact.frame - Eigen::Matrix3d::Identity();
  constexpr double tolerance = 1e-5;  // of numbers with seven digits
  if (rest.cwiseAbs().maxCoeff() < tolerance) return;
  if (!space) refuse(contact.place, "expected a unit vector n, met one of length {}", n.norm());
  refuse(contact.place, "expected orthonormal n, t and s, met products of two that are off by up to {:.2g}",
         rest.cwiseAbs().maxCoeff());
}

}  // namespace nscdd
