// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/simulation.hpp"

#include "arrays.hpp"
#include "core/fail.hpp"
#include "formats/case/case_file.hpp"
#include "long_work.hpp"
#include "module.hpp"

namespace nscdd::python {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

// Where everything is after a step, and how the step was solved. It does not change while the run goes on.
struct Step {
  std::shared_ptr<const GranularSystem> system;
  std::shared_ptr<const GranularState> state;
  Row report;  // one cell per column of step_columns; empty before the first step
};

// A run that has come to its end.
struct Run {
  std::vector<Row> reports;
  RunOutcome outcome;
  Step last;
  std::shared_ptr<Packing> packing;
};

template <class Number>
auto of_state(std::vector<Number> GranularState::*member) {
  return [member](const Step& step) { return view(step.state, (*step.state).*member); };
}

py::object of_impulses(const Step& step, const auto& part) {
  static const RememberedImpulse none;
  const auto& all = step.state->impulses;
  const auto* first = &part(all.empty() ? none : all.front());
  return strided_view(step.state, first, count(all), sizeof(RememberedImpulse));
}

// A component of the impulses in their frame, which is what is remembered in the plane alone.
py::object of_plane_impulses(const Step& step, std::size_t component) {
  if (step.system->dimension != 2)
    fail("impulse_{}: expected disks in the plane, met spheres in space, of which `impulse` has x, y and z",
         component == 0 ? "n" : "t");
  return of_impulses(
      step, [component](const auto& one) -> auto& { return one.impulse[component]; });
}

py::object impulses_of(const Step& step) {
  const auto& all = step.state->impulses;
  static const RememberedImpulse none;
  const double* first = (all.empty() ? none : all.front()).impulse.data();
  py::array_t<double> array({count(all), Index{3}}, {sizeof(RememberedImpulse), sizeof(double)}, first,
                            keeper(step.state));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A row of numbers for each boundary.
template <class Get>
Rows of_boundaries(const Step& step, Index columns, Get get) {
  Rows rows(count(step.system->boundaries), columns);
  for (Index k = 0; k < rows.rows(); ++k) {
    const std::vector<double> numbers = get(at(k));
    rows.row(k) = Vector::Map(numbers.data(), columns).transpose();
  }
  return rows;
}

Rows body_velocities(const Step& step) {
  const std::vector<RigidVelocity> all = boundary_velocities(*step.system, *step.state, step.state->time);
  if (step.system->dimension == 2)
    return of_boundaries(step, 3, [&](std::size_t k) { return std::vector{all[k].x, all[k].y, all[k].spin}; });
  return of_boundaries(step, 6, [&](std::size_t k) {
    const RigidVelocity& v = all[k];
    return std::vector{v.x, v.y, v.z, v.spin_x, v.spin_y, v.spin};
  });
}

Rows body_poses(const Step& step) {
  const std::vector<Pose>& all = step.state->poses;
  if (step.system->dimension == 2)
    return of_boundaries(step, 3, [&](std::size_t k) { return std::vector{all[k].x, all[k].y, all[k].angle}; });
  return of_boundaries(step, 7, [&](std::size_t k) {
    const Pose& p = all[k];
    return std::vector{p.x, p.y, p.z, p.turn.w(), p.turn.x(), p.turn.y(), p.turn.z()};
  });
}

py::dict report_of(const Step& step) {
  py::dict report;
  const std::vector<Column> columns = headings(step_columns());
  for (std::size_t k = 0; k < step.report.size(); ++k)
    report[py::str(columns[k].name)] = std::visit([](const auto& value) { return py::cast(value); }, step.report[k]);
  return report;
}

Case case_of(const std::string& path, const Packing* packing, const std::optional<std::string>& subdomains,
             const Settings& settings) {
  CaseSpec spec = spec_of_file(path, true);
  if (subdomains) spec.partition = parse_partitioner(*subdomains, "subdomains");
  for (const auto& [key, value] : settings) {
    if (subdomains && key.starts_with("partition."))
      fail("{}: expected either subdomains or a parameter of the partition, met both", key);
    if (packing != nullptr && key.starts_with("packing."))
      fail("{}: expected no parameter of the packing that `packing` replaces", key);
    override_case(spec, key, value);
  }
  check_dynamics(spec);
  if (subdomains) require_effect(spec, "partition.", "subdomains");
  for (const auto& [key, value] : settings) require_effect(spec, key, key);
  if (packing == nullptr) return resolve(std::move(spec));
  spec.packing = PackingFile{"packing"};
  Case one{.spec = std::move(spec), .packing = *packing};
  add_clumps(one);
  return one;
}

std::shared_ptr<Run> simulated(const std::string& path, const Packing* packing,
                               const std::optional<std::string>& subdomains, const Settings& settings,
                               const py::object& callback, const py::object& progress, Index threads) {
  const Case one = case_of(path, packing, subdomains, settings);
  LongWork work(progress);
  bool wanted = true;
  return work.run(threads, [&] {
    Simulation simulation = simulation_of(one);
    auto run = std::make_shared<Run>();
    auto system = std::make_shared<const GranularSystem>(simulation.system);
    const auto step_at = [&](const Simulation& now, Row report) {
      if (now.system.driven_by != system->driven_by)  // a source has released a grain
        system = std::make_shared<const GranularSystem>(now.system);
      return Step{system, std::make_shared<const GranularState>(now.state), std::move(report)};
    };
    RunSinks sinks;
    sinks.step = [&](const Simulation& after, const AnySolvedStep&, const StepReport& report) {
      run->reports.push_back(row(step_columns(), report));
      if (callback.is_none()) return;
      const Step step = step_at(after, run->reports.back());
      work.call([&] { wanted = !asks_to_stop(callback(step)); });
    };
    sinks.iteration.goes_on = [&] { return work.goes_on(); };
    sinks.monitor = [&, monitor = work.monitor()](Index done, Index total) { return monitor(done, total) && wanted; };
    run->outcome = run_simulation(simulation, sinks);
    run->last = step_at(simulation, run->reports.empty() ? Row() : run->reports.back());
    run->packing =
        std::make_shared<Packing>(free_grains(simulation.system, simulation.state, packing_of(one).size(), 0, true));
    return run;
  });
}

void bind_step(py::module_& module) {
  using S = Step;
  py::class_<S>(module, "Step",
                "Where everything is after a step of a simulation. Grains of the packing come first, then the disks of "
                "boundaries. Its arrays cannot be written to, and do not change while the run goes on.")
      .def_property_readonly(
          "number", [](const S& s) { return s.state->step; }, "from 1; 0 before the first step")
      .def_property_readonly(
          "time", [](const S& s) { return s.state->time; }, "s")
      .def_property_readonly("x", of_state(&GranularState::x), "centres, m")
      .def_property_readonly("y", of_state(&GranularState::y), "centres, m")
      .def_property_readonly("angle", of_state(&GranularState::angle), "rad")
      .def_property_readonly("velocity_x", of_state(&GranularState::velocity_x), "m/s")
      .def_property_readonly("velocity_y", of_state(&GranularState::velocity_y), "m/s")
      .def_property_readonly("spin", of_state(&GranularState::spin), "rad/s, in space about z")
      .def_property_readonly("z", of_state(&GranularState::z), "centres, m; empty in the plane, as all of the next")
      .def_property_readonly("velocity_z", of_state(&GranularState::velocity_z), "m/s")
      .def_property_readonly("spin_x", of_state(&GranularState::spin_x), "rad/s")
      .def_property_readonly("spin_y", of_state(&GranularState::spin_y), "rad/s")
      .def_property_readonly("turn_w", of_state(&GranularState::turn_w),
                             "the rotation since the beginning in space, a unit quaternion w + x i + y j + z k")
      .def_property_readonly("turn_x", of_state(&GranularState::turn_x), "of it")
      .def_property_readonly("turn_y", of_state(&GranularState::turn_y), "of it")
      .def_property_readonly("turn_z", of_state(&GranularState::turn_z), "of it")
      .def_property_readonly(
          "radius", [](const S& s) { return view(s.system, s.system->radius); }, "m")
      .def_property_readonly(
          "driven_by", [](const S& s) { return view(s.system, s.system->driven_by); },
          "boundary that moves a disk, -1 for a free one")
      .def_property_readonly(
          "boundaries",
          [](const S& s) {
            std::vector<std::string> names;
            for (const Boundary& one : s.system->boundaries) names.push_back(one.name);
            return names;
          },
          "names of the boundaries, bodies included, by number; those of a clump file come last")
      .def_property_readonly(
          "body_velocities", &body_velocities,
          "velocities of the boundaries at the end of the step: of the reference point c, for a body "
          "its centre of mass, m/s, and the spin w, rad/s. A point p of a boundary has v + w x (p - "
          "c). Rows (vx, vy, w), in space (vx, vy, vz, wx, wy, wz). Along free directions they are "
          "solved for, along the others prescribed")
      .def_property_readonly(
          "body_poses", &body_poses,
          "places of these reference points, m, and the turns since the beginning. Rows (x, y, "
          "angle), rad, in space (x, y, z, qw, qx, qy, qz) with the unit quaternion qw + qx i + qy j "
          "+ qz k")
      .def_property_readonly(
          "contact_a",
          [](const S& s) {
            return of_impulses(
                s, [](const auto& i) -> auto& { return i.a; });
          },
          "first body of each contact that is remembered: a disk, or wall w as the number of disks + w")
      .def_property_readonly(
          "contact_b",
          [](const S& s) {
            return of_impulses(
                s, [](const auto& i) -> auto& { return i.b; });
          },
          "second body, with a larger number")
      .def_property_readonly(
          "impulse_n", [](const S& s) { return of_plane_impulses(s, 0); },
          "normal impulse of these contacts in the plane, N s, pressing > 0")
      .def_property_readonly(
          "impulse_t", [](const S& s) { return of_plane_impulses(s, 1); }, "tangential impulse in the plane, N s")
      .def_property_readonly("impulse", &impulses_of,
                             "impulse of these contacts on b, N s, a row (x, y, z) each; in the plane (n, t, 0)")
      .def_property_readonly("report", &report_of, "how the step was solved: a row of the table `steps` as a dict")
      .def("__repr__", [](const S& s) {
        return fmt::format("<nscdd.Step {} at {} s, {} {}s>", s.state->step, s.state->time, s.system->grains(),
                           shape_of_grains(s.system->dimension));
      });
}

}  // namespace

void bind_simulation(py::module_& module) {
  bind_step(module);
  py::class_<Run, std::shared_ptr<Run>>(module, "Run")
      .def_property_readonly("columns",
                             [](const Run& r) { return columns_of_rows(headings(step_columns()), r.reports); })
      .def_property_readonly("end", [](const Run& r) { return std::string(to_string(r.outcome.end)); })
      .def_property_readonly("reason", [](const Run& r) { return r.outcome.reason; })
      .def_readonly("last", &Run::last)
      .def_readonly("packing", &Run::packing);
  module.def("simulate", &simulated, py::arg("path"), py::arg("packing"), py::arg("subdomains"), py::arg("settings"),
             py::arg("callback"), py::arg("progress"), py::arg("threads"));
}

}  // namespace nscdd::python
