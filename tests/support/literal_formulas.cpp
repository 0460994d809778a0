// SPDX-License-Identifier: GPL-3.0-or-later
#include "literal_formulas.hpp"

namespace nscdd::testing {
namespace {

struct Matrices {
  Dense mass, inverse_mass, h, a, k;
};

Matrices matrices(const Subdomain& subdomain) {
  const Dense mass = diagonal(subdomain.inertia), h = subdomain.h;
  return {mass, mass.inverse(), h, subdomain.a, h * h.transpose()};
}

Dense inverse(const Dense& w) { return pseudo_inverse(w, 1e-11); }

// C_E, with H_E C_E = G_E.
Dense selection(const Subdomain& subdomain, const std::vector<char>& active) {
  Index h_active = 0;
  for (const Index contact : subdomain.contacts) h_active += active[at(contact)];
  Matrix c = Matrix::Zero(count(subdomain.contacts), h_active);
  Index column = 0;
  for (Index i = 0; i < count(subdomain.contacts); ++i)
    if (active[at(subdomain.contacts[at(i)])]) c(i, column++) = 1;
  return c;
}

// The sum of a term over all subdomains.
Dense sum(const Decomposition& parts, const auto& term) {
  Dense all = zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) all += term(matrices(subdomain), subdomain);
  return all;
}

}  // namespace

LiteralFormulas::LiteralFormulas(const Decomposition& decomposition) : parts(decomposition) {}

Dense LiteralFormulas::x() const {
  return sum(parts, [](const Matrices& e, const Subdomain&) { return e.a * e.inverse_mass * e.a.transpose(); });
}

Dense LiteralFormulas::y(double epsilon) const {
  return sum(parts, [&](const Matrices& e, const Subdomain&) {
    if (e.h.cols() == 0) return zero(e.a.rows(), e.a.rows());
    const Dense w_epsilon = e.h.transpose() * e.inverse_mass * e.h + epsilon * identity(e.h.cols());
    const Dense a_hat_transposed = e.h.transpose() * e.inverse_mass * e.a.transpose();
    return a_hat_transposed.transpose() * inverse(w_epsilon) * a_hat_transposed;
  });
}

Dense LiteralFormulas::x_eta(double eta) const {
  return sum(parts, [&](const Matrices& e, const Subdomain&) {
    return e.a * (e.mass + e.k / eta).inverse() * e.a.transpose();
  });
}

Dense LiteralFormulas::y(double epsilon, double eta) const {
  return sum(parts, [&](const Matrices& e, const Subdomain&) {
    if (e.h.cols() == 0) return zero(e.a.rows(), e.a.rows());
    const Dense w_epsilon = e.h.transpose() * e.inverse_mass * e.h + epsilon * identity(e.h.cols());
    return e.a * (e.mass + e.k / eta).inverse() * e.h * (1 - epsilon / eta) * inverse(w_epsilon) * e.h.transpose() *
           e.inverse_mass * e.a.transpose();
  });
}

Dense LiteralFormulas::y_bar(const std::vector<char>& active) const {
  return sum(parts, [&](const Matrices& e, const Subdomain& subdomain) {
    const Dense h_active = e.h * selection(subdomain, active);
    if (h_active.cols() == 0) return zero(e.a.rows(), e.a.rows());
    const Dense a_bar_transposed = h_active.transpose() * e.inverse_mass * e.a.transpose();
    return a_bar_transposed.transpose() * inverse(h_active.transpose() * e.inverse_mass * h_active) * a_bar_transposed;
  });
}

Dense LiteralFormulas::y_bar(const std::vector<char>& active, double eta) const {
  return sum(parts, [&](const Matrices& e, const Subdomain& subdomain) {
    if (e.h.cols() == 0) return zero(e.a.rows(), e.a.rows());
    const Dense c = selection(subdomain, active);
    const Dense h_active = e.h * c;
    Dense z = -e.h.transpose() * e.inverse_mass / eta;
    if (h_active.cols() > 0) {
      const Dense w_bar_inverse = inverse(h_active.transpose() * e.inverse_mass * h_active);
      z += c * w_bar_inverse * h_active.transpose() * e.inverse_mass +
           e.h.transpose() * e.inverse_mass * h_active * w_bar_inverse * h_active.transpose() * e.inverse_mass / eta;
    }
    return e.a * (e.mass + e.k / eta).inverse() * e.h * z * e.a.transpose();
  });
}

Eigen::VectorXcd contraction_eigenvalues(const Dense& x, const Dense& y) {
  return general_eigenvalues(x.inverse() * y);
}

}  // namespace nscdd::testing
