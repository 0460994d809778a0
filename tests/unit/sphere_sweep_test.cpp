// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps over spheres go number by number, some contacts two at once: here against the law, contact by contact.
#include "linalg/random.hpp"
#include "mechanics/contact_residual.hpp"

#include <doctest/doctest.h>

using namespace nscdd;

namespace {

struct SweptHeap {
  ContactRows<3> contacts;
  std::vector<GrainVelocity<3>> velocities;
};

// Contacts between random spheres in random directions, every fourth of which is driven. Some contacts that follow each
// other share a sphere, and some do not.
SweptHeap random_heap(std::uint64_t seed, const ContactLaw& law, bool tangential_bias) {
  RandomStream random(seed);
  const auto number = [&] { return 2 * random.uniform() - 1; };
  SweptHeap heap;
  for (int i = 0; i < 14; ++i)
    heap.velocities.push_back(
        with_unknowns(GrainUnknowns<3>{number(), number(), number(), number(), number(), number()},
                      i % 4 == 0 ? 0 : 1 + number() / 2));
  heap.contacts.friction = 0.3;
  heap.contacts.boundary_friction = 0.7;
  while (heap.contacts.size() < 60) {
    const auto a = static_cast<std::int32_t>(random.below(14)), b = static_cast<std::int32_t>(random.below(14));
    if (a == b || (a % 4 == 0 && b % 4 == 0)) continue;
    Direction<3> n{number(), number(), number()};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& one : n) one /= length;
    heap.contacts.rows.push_back({a, b, n, number()});
    const double pressed = 1 + number();
    heap.contacts.impulses.push_back(swept(n, {pressed, {0.2 * number() * pressed, 0.2 * number() * pressed}}));
    if (tangential_bias) heap.contacts.bias_t.push_back(swept(n, {0, {number(), number()}}).t);
    if (std::visit([](const auto& one) { return one.pulls; }, law))
      heap.contacts.pull.push_back(random.below(2) == 0 ? 0 : 0.4);
  }
  return heap;
}

// The same sweep by the law, the frame of each contact and its impulses on the unknowns of its spheres.
SweepSums plain_sweep(const ContactLaw& law, SweptHeap& heap, double relaxation) {
  SweepSums sums;
  for (std::size_t k = 0; k < heap.contacts.size(); ++k) {
    const GrainContact<3> c = heap.contacts.contact(k, heap.velocities);
    const LocalVector<3> stop = stopping_impulse(c, heap.velocities);
    const LocalVector<3> wanted =
        std::visit([&](const auto& one) { return law_at(one, c.pull).impulse(stop, c.inverse_w(), c.friction); }, law);
    const LocalVector<3> next = c.impulse + relaxation * (wanted - c.impulse);
    apply_impulse(c, next - c.impulse, heap.velocities);
    heap.contacts.set_impulse(k, next);
    sums.change += squared(next - c.impulse);
    sums.impulses += squared(next);
  }
  return sums;
}

}  // namespace

TEST_CASE("a sweep over spheres is one contact after the other by its law, in the frame of each") {
  Index pairs = 0, open = 0, stick = 0, slide = 0;
  for (const std::string_view name : names_of(LawName{}))
    for (const double relaxation : {1.0, 0.6})
      for (const bool tangential_bias : {false, true}) {
        Interaction interaction;
        interaction.law = std::string(name);
        interaction.cohesion = 0.4;
        interaction.epsilon = 0.5;
        const ContactLaw law = contact_law(interaction, 1, 1);
        INFO("name = ", name, ", relaxation = ", relaxation, ", tangential_bias = ", tangential_bias);
        SweptHeap swept_once = random_heap(7, law, tangential_bias), plain = swept_once;
        for (int sweep = 0; sweep < 3; ++sweep) {
          const SweepSums sums = gauss_seidel_sweep(law, swept_once.contacts, swept_once.velocities, relaxation);
          const SweepSums expected = plain_sweep(law, plain, relaxation);
          CHECK(sums.change == doctest::Approx(expected.change).epsilon(1e-11));
          CHECK(sums.impulses == doctest::Approx(expected.impulses).epsilon(1e-11));
        }
        for (std::size_t k = 0; k < plain.contacts.size(); ++k) {
          const LocalVector<3> off = swept_once.contacts.impulse(k) - plain.contacts.impulse(k);
          CHECK(std::sqrt(squared(off)) < 1e-12);
          const ContactStatus status = status_of(law, plain.contacts.contact(k, plain.velocities));
          CHECK(status_of(law, swept_once.contacts.contact(k, swept_once.velocities)) == status);
          open += status == ContactStatus::open;
          stick += status == ContactStatus::stick;
          slide += slides(status);
        }
        for (std::size_t i = 0; i < plain.velocities.size(); ++i) {
          const GrainUnknowns<3> one = unknowns(swept_once.velocities[i]), other = unknowns(plain.velocities[i]);
          for (std::size_t u = 0; u < one.size(); ++u) CHECK(std::abs(one[u] - other[u]) < 1e-12);
        }
        const std::vector<ContactRow<3>>& rows = plain.contacts.rows;
        for (std::size_t k = 1; k < rows.size(); ++k)
          pairs += rows[k].a != rows[k - 1].a && rows[k].b != rows[k - 1].b && rows[k].a != rows[k - 1].b &&
                   rows[k].b != rows[k - 1].a;
      }
  // The heap has of everything.
  CHECK(std::min({pairs, open, stick, slide}) > 50);
}

TEST_CASE("an impulse of a sphere is the same along the axes and in the frame of its contact") {
  RandomStream random(3);
  for (int k = 0; k < 100; ++k) {
    Direction<3> n{2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& one : n) one /= length;
    const LocalVector<3> r{random.uniform(), {random.uniform(), -random.uniform()}};
    const AxesVector along = swept(n, r);
    CHECK(along.n == r.n);
    CHECK(std::abs(n[0] * along.t.x + n[1] * along.t.y + n[2] * along.t.z) < 1e-15);
    CHECK(std::sqrt(squared(in_frame(n, along) - r)) < 1e-15);
  }
}
