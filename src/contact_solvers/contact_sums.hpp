// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/sum_of_parts.hpp"

namespace nscdd {

/// Sums over all contacts of a problem, and what else all of them decide together. Vectors have D entries per contact
/// of this process. By default it has all contacts. Otherwise contacts belong to parts, the subdomains, and sums over
/// these add up in their order, whoever has them: no bit depends on the number of processes, which ask together.
class ContactSums {
 public:
  ContactSums() = default;
  ContactSums(std::vector<Index> part_of_contact, Index parts, Processes processes)
      : part_(std::move(part_of_contact)), parts_(parts), processes_(std::move(processes)) {}

  /// So many sums: add(c, sums) adds what contact c brings to them, for c = 0 ... contacts - 1.
  template <class Add>
  Vector add_up(Index quantities, Index contacts, const Add& add) const {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(quantities, std::max<Index>(parts_, 1));
    for (Index c = 0; c < contacts; ++c) add(c, sums.col(parts_ == 0 ? 0 : part_[at(c)]));
    return parts_ == 0 ? Vector(sums) : sum_of_parts(std::move(sums), processes_);
  }
  double dot(const Vector& a, const Vector& b) const {
    if (parts_ == 0) return a.dot(b);
    const Index size = part_.empty() ? 0 : a.size() / count(part_);
    return add_up(1, count(part_),
                  [&](Index c, auto&& sum) { sum[0] += a.segment(size * c, size).dot(b.segment(size * c, size)); })[0];
  }
  double squared_norm(const Vector& a) const { return parts_ == 0 ? a.squaredNorm() : dot(a, a); }
  double norm(const Vector& a) const { return parts_ == 0 ? a.norm() : std::sqrt(dot(a, a)); }

  Index total(Index own) const { return processes_.sum(own); }
  bool any(bool own) const { return processes_.any(own); }
  bool all_zero(const Vector& a) const { return !any(!a.isZero(0)); }
  /// Of entries >= 0; infinite if one is not a number.
  double largest(const Vector& entries) const {
    double own = 0;
    for (const double entry : entries) own = std::isnan(entry) ? infinity : std::max(own, entry);
    return processes_.maximum(own);
  }

 private:
  std::vector<Index> part_;
  Index parts_ = 0;
  Processes processes_;
};

}  // namespace nscdd
