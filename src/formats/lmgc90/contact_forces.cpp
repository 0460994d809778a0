// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/contact_forces.hpp"

#include "files/csv.hpp"
#include "formats/lmgc90/record.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"

namespace nscdd {
namespace {

using Vector3 = Eigen::Vector3d;

// Numbers of the shapes of bodies in a step: grains in the order of the files, then walls.
class Numbering {
 public:
  explicit Numbering(const Datbox& datbox) : datbox_(datbox) {
    Index grains = 0, walls = 0;
    for (const DatboxBody& body : datbox.bodies)
      first_.push_back(body.wall().empty() ? std::exchange(grains, grains + count(body.contactors)) : walls++);
    for (std::size_t k = 0; k < first_.size(); ++k)
      if (!datbox.bodies[k].wall().empty()) first_[k] += grains;
  }
  Index operator()(Index body, Index shape, const DatboxPlace& place) const {
    const Index shapes = count(datbox_.bodies[at(body)].contactors);
    if (shape < 0 || shape >= shapes)
      refuse(place, "expected one of the {} shapes of body {}, met {}", shapes, body + 1, shape + 1);
    return first_[at(body)] + shape;
  }

 private:
  const Datbox& datbox_;
  std::vector<Index> first_;
};

}  // namespace

std::vector<RememberedImpulse> contact_forces_of(const Datbox& datbox, const DatboxNetwork& network) {
  const Numbering number(datbox);
  std::vector<RememberedImpulse> forces;
  for (const DatboxContact& contact : network.contacts) {
    if (contact.force.isZero(0)) continue;  // as in impulses_to_remember
    const Index candidate = number(contact.candidate, contact.candidate_shape, contact.place),
                antagonist = number(contact.antagonist, contact.antagonist_shape, contact.place);
    const double sign = candidate > antagonist ? 1 : -1;  // from the force on the candidate to that on b
    const Vector3 force = sign * contact.frame * contact.force, normal = sign * contact.frame.col(0);
    RememberedImpulse& one = forces.emplace_back();
    one.a = std::min(candidate, antagonist);
    one.b = std::max(candidate, antagonist);
    one.slid = contact.slid;
    one.impulse = datbox.space() ? std::array{force[0], force[1], force[2]}
                                 : std::array{normal.dot(force), normal.cross(force)[2], 0.0};
  }
  std::ranges::stable_sort(forces, {}, [](const RememberedImpulse& one) { return std::pair(one.a, one.b); });
  return forces;
}

std::vector<RememberedImpulse> read_contact_forces(const std::string& path) {
  const Datbox datbox = read_datbox(path);
  if (const auto record = record_at(path)) return contact_forces_of(datbox, read_network(*record, datbox));
  const std::string file = vloc_rloc_of_datbox(path);
  return file.empty() ? std::vector<RememberedImpulse>()
                      : contact_forces_of(datbox, parse_vloc_rloc(read_text(file), file, datbox));
}

}  // namespace nscdd
