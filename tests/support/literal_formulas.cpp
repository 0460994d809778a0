// SPDX-License-Identifier: GPL-3.0-or-later
#include "literal_formulas.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace nscdd::testing {
namespace {

struct Dense {
  Matrix inverse_mass, h, a, k, mass;
};

Dense dense(const Subdomain& subdomain) {
  Dense d;
  d.mass = subdomain.inertia.asDiagonal();
  d.inverse_mass = d.mass.inverse();
  d.h = subdomain.h;
  d.a = subdomain.a;
  d.k = d.h * d.h.transpose();
  return d;
}

Matrix inverse(const Matrix& w) {
  Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
  decomposition.setThreshold(1e-11);
  decomposition.compute(w);
  return decomposition.pseudoInverse();
}

// C_E, with H_E C_E = G_E.
Matrix selection(const Subdomain& subdomain, const std::vector<char>& active) {
  Index kept = 0;
  for (const Index contact : subdomain.contacts) kept += active[at(contact)];
  Matrix c = Matrix::Zero(count(subdomain.contacts), kept);
  Index column = 0;
  for (Index i = 0; i < count(subdomain.contacts); ++i)
    if (active[at(subdomain.contacts[at(i)])]) c(i, column++) = 1;
  return c;
}

}  // namespace

LiteralFormulas::LiteralFormulas(const Decomposition& decomposition) : parts(decomposition) {}

Matrix LiteralFormulas::x() const {
  Matrix sum = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Dense e = dense(subdomain);
    sum += e.a * e.inverse_mass * e.a.transpose();
  }
  return sum;
}

Matrix LiteralFormulas::y(double epsilon) const {
  Matrix sum = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Dense e = dense(subdomain);
    if (e.h.cols() == 0) continue;
    const Matrix w = e.h.transpose() * e.inverse_mass * e.h;
    const Matrix a_hat_transposed = e.h.transpose() * e.inverse_mass * e.a.transpose();
    const Matrix w_epsilon = w + epsilon * Matrix::Identity(w.rows(), w.cols());
    sum += a_hat_transposed.transpose() * inverse(w_epsilon) * a_hat_transposed;
  }
  return sum;
}

Matrix LiteralFormulas::x_eta(double eta) const {
  Matrix sum = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Dense e = dense(subdomain);
    const Matrix m_eta = e.mass + e.k / eta;
    sum += e.a * m_eta.inverse() * e.a.transpose();
  }
  return sum;
}

Matrix LiteralFormulas::y(double epsilon, double eta) const {
  Matrix sum = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Dense e = dense(subdomain);
    if (e.h.cols() == 0) continue;
    const Matrix m_eta = e.mass + e.k / eta;
    const Matrix w_epsilon =
        e.h.transpose() * e.inverse_mass * e.h + epsilon * Matrix::Identity(e.h.cols(), e.h.cols());
    sum += e.a * m_eta.inverse() * e.h * (1 - epsilon / eta) * inverse(w_epsilon) * e.h.transpose() *
           e.inverse_mass * e.a.transpose();
  }
  return sum;
}

Matrix LiteralFormulas::y_bar(const std::vector<char>& active) const {
  Matrix sum = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Dense e = dense(subdomain);
    const Matrix g = e.h * selection(subdomain, active);
    if (g.cols() == 0) continue;
    const Matrix a_bar_transposed = g.transpose() * e.inverse_mass * e.a.transpose();
    sum += a_bar_transposed.transpose() * inverse(g.transpose() * e.inverse_mass * g) * a_bar_transposed;
  }
  return sum;
}

Matrix LiteralFormulas::y_bar(const std::vector<char>& active, double eta) const {
  Matrix sum = Matrix::Zero(parts.interface_size(), parts.interface_size());
  for (const Subdomain& subdomain : parts.subdomains) {
    const Dense e = dense(subdomain);
    if (e.h.cols() == 0) continue;
    const Matrix c = selection(subdomain, active);
    const Matrix g = e.h * c;
    Matrix z = -e.h.transpose() * e.inverse_mass / eta;
    if (g.cols() > 0) {
      const Matrix w_bar_inverse = inverse(g.transpose() * e.inverse_mass * g);
      z += c * w_bar_inverse * g.transpose() * e.inverse_mass +
           e.h.transpose() * e.inverse_mass * g * w_bar_inverse * g.transpose() * e.inverse_mass / eta;
    }
    const Matrix m_eta = e.mass + e.k / eta;
    sum += e.a * m_eta.inverse() * e.h * z * e.a.transpose();
  }
  return sum;
}

Eigen::VectorXcd contraction_eigenvalues(const Matrix& x, const Matrix& y) {
  return Eigen::EigenSolver<Matrix>(x.inverse() * y, false).eigenvalues();
}

}  // namespace nscdd::testing
