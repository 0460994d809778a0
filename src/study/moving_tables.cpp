// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/steps.hpp"

#include <array>
#include <set>

namespace nscdd {
namespace {

// Disks after some steps, and the contacts that carry an impulse in the step after them: Figures 8 and 10 of
// [ADI12].

// Subdomains that hold each disk after a fresh decomposition of the present step.
std::vector<std::set<Index>> memberships(const SolvedStep& step, Index disks) {
  std::vector<std::set<Index>> of_disk(at(disks));
  for (std::size_t k = 0; k < step.problem.geometry.size(); ++k)
    for (const Index i : {step.problem.geometry[k].a, step.problem.geometry[k].b})
      if (i < disks) of_disk[at(i)].insert(step.partition.subdomain_of_contact[k]);
  return of_disk;
}

struct PlacedDisk {
  const std::string& name;  // of the case
  const Simulation& simulation;
  Index number;
  const std::set<Index>& subdomains;  // that hold it
};

const ResultColumns<PlacedDisk>& disk_columns() {
  const auto of = [](std::vector<double> GranularState::*values) {
    return [=](const PlacedDisk& disk) { return (disk.simulation.state.*values)[at(disk.number)]; };
  };
  static const ResultColumns<PlacedDisk> columns{
      {"case", "", "name of the case", [](const PlacedDisk& disk) { return disk.name; }},
      {"step", "1", "steps done", [](const PlacedDisk& disk) { return disk.simulation.state.step; }},
      {"disk", "1", "number of the disk, grains first", &PlacedDisk::number},
      {"x", "m", "centre", of(&GranularState::x)},
      {"y", "m", "centre", of(&GranularState::y)},
      {"radius", "m", "radius", [](const PlacedDisk& disk) { return disk.simulation.system.radius[at(disk.number)]; }},
      {"angle", "rad", "angle turned by", of(&GranularState::angle)},
      {"driven", "", "whether a boundary drives it",
       [](const PlacedDisk& disk) { return !disk.simulation.system.free(disk.number); }},
      {"subdomain", "1", "lowest subdomain that holds it; -1 for a disk without contact",
       [](const PlacedDisk& disk) { return disk.subdomains.empty() ? -1 : *disk.subdomains.begin(); }},
      {"multiplicity", "1", "subdomains that hold it", [](const PlacedDisk& disk) { return disk.subdomains.size(); }}};
  return columns;
}

Index disks(const ObservedCase& work, Index steps, const Sink<PlacedDisk>& sink) {
  const Simulation simulation = simulation_at(work, steps);
  const auto held = memberships(next_step(simulation, work.table.lead_in), simulation.system.disks());
  for (Index i = 0; i < count(held); ++i) sink({work.one.spec.name, simulation, i, held[at(i)]});
  return 0;
}

struct ChainContact {
  const std::string& name;              // of the case
  Index steps;                          // done before
  std::array<double, 2> first, second;  // centres, or the foot on a wall, m
  double impulse_n, impulse_t;          // N s
  ContactStatus status;
  Index subdomain;
};

const ResultColumns<ChainContact>& chain_columns() {
  using Link = ChainContact;
  static const ResultColumns<Link> columns{
      {"case", "", "name of the case", [](const Link& c) { return c.name; }},
      {"step", "1", "steps done before the one whose impulses these are", &Link::steps},
      {"x_a", "m", "centre of one disk", [](const Link& c) { return c.first[0]; }},
      {"y_a", "m", "centre of one disk", [](const Link& c) { return c.first[1]; }},
      {"x_b", "m", "centre of the other, or foot on a wall", [](const Link& c) { return c.second[0]; }},
      {"y_b", "m", "centre of the other, or foot on a wall", [](const Link& c) { return c.second[1]; }},
      {"impulse_n", "N s", "normal impulse", &Link::impulse_n},
      {"impulse_t", "N s", "tangential impulse", &Link::impulse_t},
      {"status", "", "stick, slide_forward or slide_backward", &Link::status},
      {"subdomain", "1", "subdomain of the contact", &Link::subdomain}};
  return columns;
}

Index chains(const ObservedCase& work, Index steps, const Sink<ChainContact>& sink) {
  const Simulation simulation = simulation_at(work, steps);
  const GranularState& state = simulation.state;
  const SolvedStep step = next_step(simulation, work.table.lead_in);
  const ContactLaw law = contact_law(simulation.dynamics.interaction, step.problem.h);
  const auto centre = [&](Index disk) { return std::array{state.x[at(disk)], state.y[at(disk)]}; };
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const DiskContact& c = step.contacts[k];
    const StepContact& g = step.problem.geometry[k];
    if (c.impulse_n == 0 && c.impulse_t == 0) continue;
    const bool wall = g.b >= simulation.system.disks();
    sink({work.one.spec.name, steps, centre(g.a), wall ? std::array{g.point[0], g.point[1]} : centre(g.b), c.impulse_n,
          c.impulse_t, status_of(law, c), step.partition.subdomain_of_contact[k]});
  }
  return 0;
}

}  // namespace

constinit const Observable observables::configuration =
    at_steps<disk_columns, disks>({.name = "configuration",
                                   .summary = "disks of a case that moves after some steps, with their subdomains",
                                   .first_step = 0});

constinit const Observable observables::force_chains =
    at_steps<chain_columns, chains>({.name = "force_chains",
                                     .summary = "contacts with their impulses of a case that moves after some steps",
                                     .first_step = 0});

}  // namespace nscdd
