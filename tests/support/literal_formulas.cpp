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

}  // namespace

LiteralFormulas::LiteralFormulas(const Decomposition& decomposition) : parts(decomposition) {}

Dense LiteralFormulas::x() const {
  Dense sum = zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Matrices e = matrices(subdomain);
    sum += e.a * e.inverse_mass * e.a.transpose();
  }
  return sum;
}

Dense LiteralFormulas::y(double epsilon) const {
  Dense sum = zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Matrices e = matrices(subdomain);
    if (e.h.cols() == 0) continue;
    const Dense w = e.h.transpose() * e.inverse_mass * e.h;
    const Dense a_hat_transposed = e.h.transpose() * e.inverse_mass * e.a.transpose();
    const Dense w_epsilon = w + epsilon * identity(w.rows());
    sum += a_hat_transposed.transpose() * inverse(w_epsilon) * a_hat_transposed;
  }
  return sum;
}

Dense LiteralFormulas::x_eta(double eta) const {
  Dense sum = zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Matrices e = matrices(subdomain);
    const Dense m_eta = e.mass + e.k / eta;
    sum += e.a * m_eta.inverse() * e.a.transpose();
  }
  return sum;
}

Dense LiteralFormulas::y(double epsilon, double eta) const {
  Dense sum = zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Matrices e = matrices(subdomain);
    if (e.h.cols() == 0) continue;
    const Dense m_eta = e.mass + e.k / eta;
    const Dense w_epsilon = e.h.transpose() * e.inverse_mass * e.h + epsilon * identity(e.h.cols());
    sum += e.a * m_eta.inverse() * e.h * (1 - epsilon / eta) * inverse(w_epsilon) * e.h.transpose() * e.inverse_mass *
           e.a.transpose();
  }
  return sum;
}

Dense LiteralFormulas::y_bar(const std::vector<char>& active) const {
  Dense sum = zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Matrices e = matrices(subdomain);
    const Dense h_active = e.h * selection(subdomain, active);
    if (h_active.cols() == 0) continue;
    const Dense a_bar_transposed = h_active.transpose() * e.inverse_mass * e.a.transpose();
    sum += a_bar_transposed.transpose() * inverse(h_active.transpose() * e.inverse_mass * h_active) * a_bar_transposed;
  }
  return sum;
}

Dense LiteralFormulas::y_bar(const std::vector<char>& active, double eta) const {
  Dense sum = zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Matrices e = matrices(subdomain);
    if (e.h.cols() == 0) continue;
    const Dense c = selection(subdomain, active);
    const Dense h_active = e.h * c;
    Dense z = -e.h.transpose() * e.inverse_mass / eta;
    if (h_active.cols() > 0) {
      const Dense w_bar_inverse = inverse(h_active.transpose() * e.inverse_mass * h_active);
      z += c * w_bar_inverse * h_active.transpose() * e.inverse_mass +
           e.h.transpose() * e.inverse_mass * h_active * w_bar_inverse * h_active.transpose() * e.inverse_mass / eta;
    }
    const Dense m_eta = e.mass + e.k / eta;
    sum += e.a * m_eta.inverse() * e.h * z * e.a.transpose();
  }
  return sum;
}

Eigen::VectorXcd contraction_eigenvalues(const Dense& x, const Dense& y) {
  return general_eigenvalues(x.inverse() * y);
}

}  // namespace nscdd::testing
