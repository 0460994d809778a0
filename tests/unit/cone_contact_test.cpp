// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/dense.hpp"
#include "linalg/random.hpp"
#include "mechanics/contact_law.hpp"

#include <Eigen/LU>
#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();

// Q diag(values) Q^T with a random rotation Q.
Eigen::Matrix3d random_block(RandomStream& random, const Eigen::Vector3d& values) {
  Eigen::Matrix3d a;
  for (double& value : a.reshaped()) value = random.normal();
  const Eigen::Matrix3d q = orthogonal_factor(Matrix(a)).entries();
  const Eigen::Matrix3d w = q * values.asDiagonal() * q.transpose();
  return (w + w.transpose()) / 2;
}

FullDelassus<3> delassus(const Eigen::Matrix3d& w) {
  return {w(0, 0), {w(0, 1), w(0, 2)}, {w(1, 1), w(1, 2), w(2, 2)}};
}

// What is left of Signorini's and Coulomb's laws, written out, over what rounding of u = W r + free may leave.
double violation(const Eigen::Matrix3d& w, const Eigen::Vector3d& free, double friction, const LocalVector<3>& r) {
  const Eigen::Vector3d impulse(r.n, r.t.first, r.t.second), u = w * impulse + free;
  const double u_scale = w.norm() * impulse.norm() + free.norm(), r_scale = impulse.norm() + free.norm() / w.norm();
  const double u_t = u.tail<2>().norm(), r_t = impulse.tail<2>().norm();
  double worst = std::max({0.0, -r.n / r_scale, -u[0] / u_scale, (r_t - friction * r.n) / r_scale});
  worst = std::max(worst, std::abs(u[0] * r.n) / (u_scale * r_scale));
  // Opposite where equal: the power of friction is as negative as the cone allows.
  worst = std::max(worst, std::abs(u.tail<2>().dot(impulse.tail<2>()) + friction * r.n * u_t) / (u_scale * r_scale));
  return worst / rounding;
}

}  // namespace

TEST_CASE("one contact in space obeys the law to rounding, for any friction and coupling, also badly conditioned") {
  RandomStream random(17);
  Index open = 0, stick = 0, slide = 0, coupled = 0;
  double worst = 0;
  for (Index k = 0; k < 100'000; ++k) {
    const double spread = k % 2 == 0 ? 1 : 12;  // decades between principal values
    const auto value = [&] { return std::pow(10.0, spread * (random.uniform() - 0.5)); };
    const Eigen::Matrix3d w = random_block(random, {value(), value(), value()});
    const FullDelassus<3> block = delassus(w);
    Eigen::Vector3d free(random.normal(), random.normal(), random.normal());
    if (k % 3 == 0) free.tail<2>() *= 1e-3;
    if (k % 7 == 0) free = -w * Eigen::Vector3d(1, random.uniform(), random.uniform());
    const double friction = k % 11 == 0 ? 0.0 : 2 * random.uniform();
    const LocalVector<3> r = ConeContact(block).impulse({free[0], {free[1], free[2]}}, friction);
    worst = std::max(worst, violation(w, free, friction, r));
    const ContactStatus status = contact_status(r, friction, 1e-12);
    open += status == ContactStatus::open;
    stick += status == ContactStatus::stick;
    slide += status == ContactStatus::slide;
    coupled += friction * norm(block.nt) > block.nn;
    if (free[0] >= 0) CHECK(r.n == 0);
  }
  CAPTURE(worst);
  CHECK(worst < 500);
  CHECK(open > 20'000);
  CHECK(stick > 5'000);
  CHECK(slide > 20'000);
  CHECK(coupled > 1'000);  // where the plane too may have several solutions
}

TEST_CASE("a contact in space that is coupled in a plane alone has the impulse of that plane") {
  RandomStream random(3);
  for (Index k = 0; k < 2000; ++k) {
    const double nn = 0.1 + random.uniform(), tt = 0.1 + random.uniform(), other = 0.1 + random.uniform();
    const double nt = (2 * random.uniform() - 1) * 0.9 * std::sqrt(nn * tt), friction = 0.9 * random.uniform();
    if (friction * std::abs(nt) > 0.9 * nn) continue;
    const LocalVector<2> free{random.normal(), random.normal()}, flipped{-free.n, -free.t};
    const FullDelassus<2> plane{nn, nt, tt};
    const LocalVector<2> expected = Coulomb{}.impulse(plane.solve(flipped), plane, friction);
    const double angle = 7 * random.uniform(), c = std::cos(angle), s = std::sin(angle);
    // The tangent of the plane lies at an angle in space.
    const FullDelassus<3> turned{
        nn, {c * nt, s * nt}, {c * c * tt + s * s * other, c * s * (tt - other), s * s * tt + c * c * other}};
    const LocalVector<3> r = ConeContact(turned).impulse({free.n, {c * free.t, s * free.t}}, friction);
    CHECK(std::abs(r.n - expected.n) <= 1e-12 * (1 + expected.n));
    CHECK(norm(r.t - TangentVector{c * expected.t, s * expected.t}) <= 1e-12 * (1 + expected.n));
  }
}

TEST_CASE("a full block in space: products, solutions and flexible ones are those of its matrix") {
  RandomStream random(5);
  for (Index k = 0; k < 200; ++k) {
    const Eigen::Matrix3d w = random_block(random, {0.2 + random.uniform(), 1, 3});
    const FullDelassus<3> block = delassus(w);
    const Eigen::Vector3d r(random.normal(), random.normal(), random.normal());
    const auto close = [&](LocalVector<3> found, const Eigen::Vector3d& expected) {
      CHECK((Eigen::Vector3d(found.n, found.t.first, found.t.second) - expected).norm() <
            1e-13 * (1 + expected.norm()));
    };
    const LocalVector<3> own{r[0], {r[1], r[2]}};
    close(block.apply(own), w * r);
    close(block.solve(own), w.inverse() * r);
    close(block.soften(own, 0.7), (w + 0.7 * Eigen::Matrix3d::Identity()).inverse() * (w * r));
    // The law by the impulse that would stop it, as sweeps over bodies have it.
    const LocalVector<3> stopped = Coulomb{}.impulse(own, block, 0.4);
    const LocalVector<3> direct = ConeContact(block).impulse(block.apply(-1.0 * own), 0.4);
    CHECK(norm(stopped.t - direct.t) + std::abs(stopped.n - direct.n) < 1e-14);
  }
}

TEST_CASE("numbers that are not finite are not taken for an impulse") {
  const ConeContact contact(FullDelassus<3>{1, {0.2, 0.1}, {1, 0, 2}});
  const LocalVector<3> r = contact.impulse({-1, {not_a_number, 0}}, 0.3);
  CHECK_FALSE(std::isfinite(r.n + r.t.first + r.t.second));
}
