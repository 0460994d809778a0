// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/contact_forces.hpp"

#include "formats/lmgc90/record.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"

namespace nscdd {
namespace {

using Vector3 = Eigen::Vector3d;

// Numbers of the shapes of bodies in a step: grains in the order of the files, then walls. -1 of what is not there.
class Numbering {
 public:
  explicit Numbering(const Datbox& datbox) : datbox_(datbox) {
    for (const DatboxBody& body : datbox.bodies)
      first_.push_back(body.wall().empty() ? std::exchange(grains_, grains_ + count(body.contactors)) : walls_++);
    for (std::size_t k = 0; k < first_.size(); ++k)
      if (!datbox.bodies[k].wall().empty()) first_[k] += grains_;
  }
  Index grains() const { return grains_; }
  Index walls() const { return walls_; }
  Index operator()(Index body, Index shape) const {
    if (body >= count(first_) || shape < 0 || shape >= count(datbox_.bodies[at(body)].contactors)) return -1;
    return first_[at(body)] + shape;
  }

 private:
  const Datbox& datbox_;
  std::vector<Index> first_;
  Index grains_ = 0, walls_ = 0;
};

}  // namespace

ContactForces contact_forces_of(const Datbox& datbox, const DatboxNetwork& network) {
  const Numbering number(datbox);
  ContactForces result{datbox.dimension, number.grains(), number.walls()};
  for (const DatboxContact& contact : network.contacts) {
    if (contact.force.isZero(0)) continue;  // as in impulses_to_remember
    const Index candidate = number(contact.candidate, contact.candidate_shape),
                antagonist = number(contact.antagonist, contact.antagonist_shape);
    if (candidate < 0 || antagonist < 0) continue;
    const double sign = candidate > antagonist ? 1 : -1;  // from the force on the candidate to that on b
    const Vector3 force = sign * contact.frame * contact.force, normal = sign * contact.frame.col(0);
    RememberedImpulse& one = result.forces.emplace_back();
    one.a = std::min(candidate, antagonist);
    one.b = std::max(candidate, antagonist);
    one.slid = contact.slid;
    one.impulse = datbox.space() ? std::array{force[0], force[1], force[2]}
                                 : std::array{normal.dot(force), normal.cross(force)[2], 0.0};
  }
  std::ranges::stable_sort(result.forces, {}, [](const RememberedImpulse& one) { return std::pair(one.a, one.b); });
  return result;
}

ContactForces read_contact_forces(const std::string& path) {
  if (!holds_datbox(path)) fail("{}: expected a folder with BODIES.DAT or a record of LMGC90, met another", path);
  const Datbox datbox = read_datbox(path);
  if (const auto record = record_at(path)) return contact_forces_of(datbox, read_network(*record, datbox));
  const std::string file = vloc_rloc_of_datbox(path);
  if (file.empty()) fail("{}: expected contacts in Vloc_Rloc.INI, met none", path);
  return contact_forces_of(datbox, read_vloc_rloc(file, datbox, "the initial state"));
}

}  // namespace nscdd
