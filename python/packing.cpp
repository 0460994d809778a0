// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "core/fail.hpp"
#include "long_work.hpp"
#include "module.hpp"
#include "packing/precision.hpp"
#include "study/case/case.hpp"
#include <nscdd/formats/packing_file.hpp>
#include <nscdd/packing/generator.hpp>

namespace nscdd::python {
namespace {

std::shared_ptr<Packing> packing_of(const py::object& x, const py::object& y, const py::object& radius,
                                    const py::object& mass, const py::object& z, const py::object& clump) {
  const bool with_masses = !mass.is_none(), in_space = !z.is_none();
  const auto given = [](const py::object& values, const char* name) {
    return values.is_none() ? std::vector<double>() : numbers(values, name);
  };
  auto packing = std::make_shared<Packing>(
      Packing{numbers(x, "x"), numbers(y, "y"), numbers(radius, "radius"), given(mass, "mass"), given(z, "z")});
  const std::size_t n = packing->x.size();
  if (packing->y.size() != n || packing->radius.size() != n || (with_masses && packing->mass.size() != n) ||
      (in_space && packing->z.size() != n))
    fail("packing: expected arrays of one length, met x of {}, y of {}, radius of {}{}{}", n, packing->y.size(),
         packing->radius.size(), with_masses ? fmt::format(", mass of {}", packing->mass.size()) : "",
         in_space ? fmt::format(", z of {}", packing->z.size()) : "");
  for (const double number : given(clump, "clump")) {
    if (!(number >= -1 && number <= 1e15 && number == std::floor(number)))
      fail("clump: expected integers >= -1, met {}", number);
    packing->clump.push_back(static_cast<Index>(number));
  }
  check(*packing);
  return packing;
}

// An array that a packing may be without.
py::object optional_view(const std::shared_ptr<Packing>& packing, const std::vector<double>& values) {
  if (values.empty()) return py::none();
  return view(packing, values);
}
py::object masses(const std::shared_ptr<Packing>& packing) { return optional_view(packing, packing->mass); }
py::object depths(const std::shared_ptr<Packing>& packing) { return optional_view(packing, packing->z); }
py::object clumps(const std::shared_ptr<Packing>& packing) {
  if (packing->clump.empty()) return py::none();
  return view(packing, packing->clump);
}

std::string shown_packing(const Packing& packing) {
  return fmt::format("<nscdd.Packing of {} {}, {} masses>", packing.size(),
                     packing.dimension() == 2 ? "disks" : "spheres", packing.mass.empty() ? "without" : "with");
}

std::shared_ptr<Packing> generated(const std::string& generator,
                                   const std::vector<std::pair<std::string, std::string>>& parameters,
                                   const py::object& progress, Index threads) {
  CaseSpec spec;
  spec.packing = Alternatives<Generator>::at(position_of(generator, Alternatives<Generator>::names, "generator"));
  for (const auto& [key, value] : parameters) override_case(spec, "packing." + key, value);
  LongWork work(progress);
  return work.run(
      threads, [&] { return std::make_shared<Packing>(generate(std::get<Generator>(spec.packing), work.monitor())); });
}

// The generators and their parameters, for the documentation of `generate`.
std::string generators_text() {
  std::string text;
  for (std::size_t k = 0; k < Alternatives<Generator>::names.size(); ++k)
    std::visit(
        [&](const auto& generator) {
          text += fmt::format("{}: {}.\n", generator.name, generator.summary);
          for (const FieldDescription& field : describe_fields(generator))
            text += fmt::format("    {} = {}: {}{}\n", field.key, field.value, field.description,
                                field.unit == "1" || field.type == "text" ? "" : ", " + field.unit);
        },
        Alternatives<Generator>::at(k));
  return text;
}

// A column of the contacts, which lie one after the other in memory.
template <class Number>
py::array_t<Number> column(const std::shared_ptr<ContactNetwork>& network, Number Contact::*member) {
  static const Contact none;
  const Contact& first = network->contacts.empty() ? none : network->contacts.front();
  return strided_view(network, &(first.*member), network->size(), sizeof(Contact));
}
py::array_t<double> column(const std::shared_ptr<ContactNetwork>& network, std::array<double, 3> Contact::*member) {
  static const Contact none;
  const Contact& first = network->contacts.empty() ? none : network->contacts.front();
  const std::array<py::ssize_t, 2> strides{sizeof(Contact), sizeof(double)};
  py::array_t<double> array({network->size(), network->dimension}, strides, (first.*member).data(), keeper(network));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

void bind_network(py::module_& module) {
  using Network = std::shared_ptr<ContactNetwork>;
  py::class_<ContactNetwork, Network>(module, "ContactNetwork",
                                      "Pairs of touching grains a < b, sorted by (a, b). Its arrays cannot be written "
                                      "to.")
      .def_property_readonly(
          "a", [](const Network& n) { return column(n, &Contact::a); }, "first grain of each contact")
      .def_property_readonly(
          "b", [](const Network& n) { return column(n, &Contact::b); }, "second grain")
      .def_property_readonly(
          "normal", [](const Network& n) { return column(n, &Contact::normal); },
          "unit vectors from the centre of a to the centre of b, contacts x 2, in space x 3")
      .def_property_readonly(
          "midpoint", [](const Network& n) { return column(n, &Contact::midpoint); },
          "middle of the two centres, m, contacts x 2, in space x 3: what grids of subdomains distribute")
      .def_property_readonly(
          "gap", [](const Network& n) { return column(n, &Contact::gap); }, "m, negative for an overlap")
      .def_property_readonly(
          "grains", [](const Network& n) { return n->grains; },
          "grains of the packing, those without a contact included")
      .def_property_readonly(
          "digits", [](const Network& n) { return n->rounding.digits; },
          "how coarsely the coordinates are written: \"6 decimals\", \"7 significant digits\", \"single precision\" or "
          "\"double precision\"")
      .def_property_readonly(
          "uncertainty", [](const Network& n) { return n->rounding.uncertainty; },
          "how far gaps may be off by these digits, times the smaller radius, where a contact depends on it; else 0")
      .def_property_readonly(
          "decided_by_rounding", [](const Network& n) { return n->rounding.decided.size; },
          "contacts whose gap or overlap is beyond the tolerances, but within the uncertainty")
      .def_property_readonly(
          "open_pairs", [](const Network& n) { return n->rounding.open.size; },
          "pairs that do not touch, by a gap of at most three times the uncertainty")
      .def_property_readonly(
          "ambiguous", [](const Network& n) { return n->rounding.ambiguous(); },
          "whether more than a few contacts depend on digits that are missing")
      .def("__len__", [](const Network& n) { return n->size(); })
      .def("__repr__", [](const Network& n) {
        return fmt::format("<nscdd.ContactNetwork of {} contacts among {} grains>", n->size(), n->grains);
      });
}

}  // namespace

void warn_of(const std::vector<std::string>& remarks, Py_ssize_t caller) {
  for (const std::string& remark : remarks)
    if (PyErr_WarnEx(PyExc_UserWarning, remark.c_str(), caller) != 0) throw py::error_already_set();
}

void bind_packing(py::module_& module) {
  using Shared = std::shared_ptr<Packing>;
  py::class_<Packing, Shared>(module, "Packing",
                              "Disks in the plane, grain i at (x[i], y[i]), or with `z` spheres in space, grain i at "
                              "(x[i], y[i], z[i]): m, m, m, kg and m. Without `mass` every grain has 1 kg where a mass "
                              "is needed. Arrays are copied in; those that come out cannot be written to and copy "
                              "nothing. Raises Error naming the grain where a coordinate is not finite or a radius or "
                              "mass is not finite and positive, and for clumps that are no integers from -1 on.")
      .def(py::init(&packing_of), py::arg("x"), py::arg("y"), py::arg("radius"), py::arg("mass") = py::none(),
           py::arg("z") = py::none(), py::arg("clump") = py::none())
      .def_property_readonly(
          "x", [](const Shared& p) { return view(p, p->x); }, "centres, m")
      .def_property_readonly(
          "y", [](const Shared& p) { return view(p, p->y); }, "centres, m")
      .def_property_readonly(
          "radius", [](const Shared& p) { return view(p, p->radius); }, "m")
      .def_property_readonly("mass", &masses, "kg, or None where no masses were given")
      .def_property_readonly("z", &depths, "centres, m, or None in the plane")
      .def_property_readonly(
          "clump", &clumps,
          "number of the clump of each grain, -1 for a free one, or None: nscdd.simulate moves grains "
          "of one number as a rigid body, of mass m = sum m_i and inertia sum m_i (k r_i^2 1 + "
          "|d_i|^2 1 - d_i d_i^T) about its centre, k = 1/2, in space 2/5")
      .def_property_readonly("dimension", &Packing::dimension, "2 for disks in the plane, 3 for spheres in space")
      .def("__len__", [](const Packing& p) { return p.size(); })
      .def("__repr__", &shown_packing)
      .def(py::pickle(
          [](const Shared& p) {
            return py::make_tuple(view(p, p->x), view(p, p->y), view(p, p->radius), masses(p), depths(p), p->half_digit,
                                  clumps(p));
          },
          [](const py::tuple& state) {
            auto packing = packing_of(state[0], state[1], state[2], state[3], state[4],
                                      state.size() > 6 ? py::object(state[6]) : py::none());
            if (state.size() > 5) packing->half_digit = state[5].cast<double>();
            return packing;
          }));
  bind_network(module);
  module.def(
      "read_packing", [](const std::string& path) { return std::make_shared<Packing>(read_packing(path)); },
      py::arg("path"));
  module.def("generate", &generated, py::arg("generator"), py::arg("parameters"), py::arg("progress"),
             py::arg("threads"));
  module.attr("generators_text") = generators_text();
  module.def(
      "contacts",
      [](const Packing& packing, double tolerance, double overlap_tolerance) {
        ContactDetection detection;
        override_field(detection, "tolerance", field_text(tolerance), "tolerance");
        override_field(detection, "overlap_tolerance", field_text(overlap_tolerance), "overlap_tolerance");
        const auto found =
            LongWork().run(0, [&] { return std::make_shared<ContactNetwork>(detect_contacts(packing, detection)); });
        warn_of(rounding_remarks(*found, "packing"));
        return found;
      },
      py::arg("packing"), py::arg("tolerance"), py::arg("overlap_tolerance"));
}

}  // namespace nscdd::python
