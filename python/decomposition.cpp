// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "core/fail.hpp"
#include "formats/case/case_file.hpp"
#include "long_work.hpp"
#include "module.hpp"
#include "study/case/case.hpp"
#include "study/linear/inspection.hpp"
#include <nscdd/study/sweep.hpp>

namespace nscdd::python {
namespace {

using SharedModel = std::shared_ptr<Model>;
using Settings = std::vector<std::pair<std::string, std::string>>;
using VelocityGiven = std::variant<std::array<double, 2>, std::array<double, 3>>;
using Prescribed = std::vector<std::pair<Index, VelocityGiven>>;
using Subdomains = std::variant<std::string, Array<Index>>;

// A subdomain with what it belongs to.
struct Part {
  std::shared_ptr<const Subdomain> subdomain;
  std::shared_ptr<const Model> model;
};

Partition partition_of(const Array<Index>& subdomain_of_contact, Index contacts) {
  if (subdomain_of_contact.ndim() != 1)
    fail("subdomains: expected an array of one dimension, met one of {}", subdomain_of_contact.ndim());
  if (subdomain_of_contact.size() != contacts)
    fail("subdomains: expected the number of a subdomain for each of {} contacts, met {}", contacts,
         subdomain_of_contact.size());
  Partition partition{.subdomains = 1,
                      .subdomain_of_contact = {subdomain_of_contact.data(), subdomain_of_contact.data() + contacts}};
  constexpr Index most = 1'000'000;  // as of METIS
  for (const Index e : partition.subdomain_of_contact) {
    if (e >= most) fail("subdomains: expected numbers from 0 to {}, met {}", most - 1, e);
    partition.subdomains = std::max(partition.subdomains, e + 1);
  }
  return partition;
}

// The model of a case cut as `subdomains` states: by a partitioner, or by a number per contact.
SharedModel built(Case one, const std::optional<Subdomains>& subdomains, const py::object& progress) {
  const auto* given = subdomains ? std::get_if<Array<Index>>(&*subdomains) : nullptr;
  if (subdomains)
    one.spec.partition =
        given ? GridPartitioner{} : parse_partitioner(std::get<std::string>(*subdomains), "subdomains");
  LongWork work(progress);
  const auto built_model = work.run(0, [&] {
    auto model = std::make_shared<Model>(build(one, work.monitor()));
    if (given == nullptr) return model;
    // Python owns the array, which stays unchanged during the call.
    model->partition = partition_of(*given, model->problem.contacts());
    model->parts = decompose(model->problem, model->partition);
    return model;
  });
  warn_of(remarks_on(*built_model, one.spec.partition));
  return built_model;
}

SharedModel decomposed(const Packing& packing, const Subdomains& subdomains, const Settings& settings,
                       const Prescribed& prescribed, const std::string& name) {
  Case one;
  one.spec.name = name;
  one.spec.packing = PackingFile{"packing"};
  one.packing = packing;
  for (const auto& [key, value] : settings) override_case(one.spec, key, value);
  for (const auto& [grain, velocity] : prescribed)
    one.spec.prescribed.push_back(
        {grain, std::visit([](const auto& components) { return Components<double>(components); }, velocity)});
  return built(std::move(one), subdomains, py::none());
}

SharedModel read(const std::string& path, const std::optional<Subdomains>& subdomains, const Settings& settings,
                 const py::object& progress) {
  CaseSpec spec = spec_of_file(path);
  for (const auto& [key, value] : settings) override_case(spec, key, value);
  return built(resolve(std::move(spec)), subdomains, progress);
}

std::vector<Part> parts_of(const SharedModel& model) {
  std::vector<Part> all;
  for (const Subdomain& one : model->parts.subdomains) all.push_back({{model, &one}, model});
  return all;
}

py::object gluing(const SharedModel& model) {
  py::list all;
  for (const Part& part : parts_of(model)) all.append(sparse_view(model, part.subdomain->a));
  return py::module_::import("scipy.sparse").attr("hstack")(all, py::arg("format") = "csc");
}

std::string shown_model(const Model& model) {
  return fmt::format(
      "<nscdd.Decomposition '{}' of {} grains and {} contacts into {} subdomains, {} interface unknowns>", model.name,
      model.grains(), model.contacts(), model.partition.subdomains, model.parts.interface_size());
}

void bind_subdomain(py::module_& module) {
  py::class_<Part>(
      module, "Subdomain",
      "One subdomain E: the grains that its contacts touch, with their share of mass. Its arrays cannot be "
      "written to.")
      .def_property_readonly(
          "grains", [](const Part& p) { return view(p.model, p.subdomain->grains); },
          "global numbers, ascending: n_E of them")
      .def_property_readonly(
          "contacts", [](const Part& p) { return view(p.model, p.subdomain->contacts); },
          "global numbers, ascending: c_E of them")
      .def_property_readonly(
          "M", [](const Part& p) { return diagonal_view(p.model, p.subdomain->inertia); },
          "M_E, kg, d n_E x d n_E, diagonal: a grain shared by q subdomains has 1/q of its mass")
      .def_property_readonly(
          "H", [](const Part& p) { return sparse_view(p.model, p.subdomain->h); }, "H_E, d n_E x c_E")
      .def_property_readonly(
          "A", [](const Part& p) { return sparse_view(p.model, p.subdomain->a); },
          "A_E, n_Gamma x d n_E, signed boolean")
      .def("__repr__", [](const Part& p) {
        return fmt::format("<nscdd.Subdomain of {} grains and {} contacts>", p.subdomain->grains.size(),
                           p.subdomain->contacts.size());
      });
}

py::tuple chosen_contacts(const SharedModel& model, const std::string& contacts) {
  LongWork work;
  const auto choice = std::make_shared<ContactChoice>(
      work.run(0, [&, set = Choice<ContactSet>::parse(contacts, "contacts")] { return choose_contacts(*model, set); }));
  const auto flags = view(choice, choice->active.data(), count(choice->active)).attr("astype")("bool");
  return py::make_tuple(flags, view(choice, choice->impulses), choice->rule, choice->certain);
}

}  // namespace

void bind_decomposition(py::module_& module) {
  bind_subdomain(module);
  const auto of = [](auto member) { return [member](const Model& m) { return std::invoke(member, m); }; };
  py::class_<Model, SharedModel>(
      module, "Decomposition",
      "A packing cut into subdomains: its contacts are distributed among them, and sum_E A_E V_E "
      "= 0 glues the copies of shared grains. Its matrices are views of this object's memory and "
      "cannot be written to.")
      .def_readonly("name", &Model::name, "the column `case` of tables")
      .def_property_readonly(
          "packing", [](const SharedModel& m) { return std::shared_ptr<Packing>(m, &m->packing); }, "with its masses")
      .def_property_readonly(
          "network", [](const SharedModel& m) { return std::shared_ptr<ContactNetwork>(m, &m->network); },
          "its contacts")
      .def_property_readonly("grains", of(&Model::grains))
      .def_property_readonly("contacts", of(&Model::contacts))
      .def_property_readonly("subdomains", &parts_of, "the subdomains in their order; one of them may be empty")
      .def_property_readonly(
          "subdomain_of_contact", [](const SharedModel& m) { return view(m, m->partition.subdomain_of_contact); },
          "one per column of H")
      .def_property_readonly(
          "interface_size", [](const Model& m) { return m.parts.interface_size(); },
          "n_Gamma: unknowns of the interface")
      .def_property_readonly(
          "mean_w_nn", [](const Model& m) { return flexibility_scale(m); },
          "mean of W_nn over the contacts, 1/kg: the unit of flexibilities such as '0.1W'")
      .def_property_readonly(
          "M", [](const SharedModel& m) { return diagonal_view(m, m->problem.inertia); },
          "M of the undivided packing, kg, d n x d n, diagonal")
      .def_property_readonly(
          "H", [](const SharedModel& m) { return sparse_view(m, m->problem.h); },
          "H of the undivided packing, d n x c: v = H^T V, and the column of contact (a, b) is -n on a "
          "and +n on b")
      .def_property_readonly(
          "A", &gluing,
          "[A_1 A_2 ...]: A V = 0 glues the copies, V the velocities of all subdomains one after the "
          "other. It is assembled at each use")
      .def_property_readonly(
          "arriving_velocity", [](const SharedModel& m) { return view(m, m->problem.arriving_velocity); },
          "V^-, m/s, d n entries")
      .def("__repr__", &shown_model);
  module.def("decompose", &decomposed, py::arg("packing"), py::arg("subdomains"), py::arg("settings"),
             py::arg("prescribed"), py::arg("name"));
  module.def("read_case", &read, py::arg("path"), py::arg("subdomains"), py::arg("settings"), py::arg("progress"));
  module.def("chosen_contacts", &chosen_contacts, py::arg("parts"), py::arg("contacts"));
}

}  // namespace nscdd::python
