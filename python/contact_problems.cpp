// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "core/fail.hpp"
#include "core/text.hpp"
#include "files/output_file.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/contact_problem/step_fclib.hpp"
#include "friction.hpp"
#include "long_work.hpp"
#include "study/tables/study.hpp"

namespace nscdd::python {
namespace {

CompressedColumns columns_of(const py::object& csc) {
  return {csc.attr("data").cast<Array<double>>(), csc.attr("indices").cast<Array<int>>(),
          csc.attr("indptr").cast<Array<int>>(), csc.attr("shape").cast<std::array<Index, 2>>()};
}

template <class Problem>
ContactProblem checked(Problem problem) {
  check(problem, "problem");
  FclibFile file;
  file.problem = std::move(problem);
  return ContactProblem(std::move(file));
}

// Three columns per contact mean space.
Index dimension_of(Index columns, Index contacts) { return contacts > 0 && columns == 3 * contacts ? 3 : 2; }

ContactProblem local_problem(const py::object& w, const py::object& q, const py::object& friction) {
  LocalFrictionProblem problem{sparse_matrix(columns_of(w), "W"), vector(q, "q"), vector(friction, "mu")};
  problem.dimension = dimension_of(problem.w.cols(), problem.contacts());
  return checked(std::move(problem));
}

ContactProblem global_problem(const py::object& mass, const py::object& h, const py::object& f, const py::object& w,
                              const py::object& friction) {
  GlobalFrictionProblem problem{sparse_matrix(columns_of(mass), "M"), sparse_matrix(columns_of(h), "H"), vector(f, "f"),
                                vector(w, "w"), vector(friction, "mu")};
  problem.dimension = dimension_of(problem.h.cols(), problem.contacts());
  return checked(std::move(problem));
}

// HDF5 takes one call at a time and h5py uses it, too: the interpreter lock is held.
void write(const ContactProblem& problem, const std::string& path, const FrictionSolution* solution,
           const std::vector<std::pair<std::string, std::string>>& info, bool force) {
  FclibFile file = *problem.file();
  for (const auto& [name, text] : info) {
    if (name == "title") file.info.title = text;
    if (name == "description") file.info.description = text;
    if (name == "math_info") file.info.math_info = text;
  }
  if (solution != nullptr && solution->impulses.size() != file.dimension() * file.contacts())
    fail("solution: expected that of a problem of {} contacts, met {}", file.contacts(),
         solution->impulses.size() / file.dimension());
  if (solution != nullptr && solution->status != FrictionStatus::not_finite &&
      solution->status != FrictionStatus::diverged) {
    constexpr double rounding = 1e-6;
    const auto local = problem.reduced();
    const Vector &u = solution->state.velocities, wr = local->w * solution->impulses;
    if (!((wr + local->q - u).norm() <= rounding * (u.norm() + local->q.norm() + wr.norm())))
      fail("solution: expected u = W r + q of this problem, met that of another one");
  }
  if (has_siconos_name(path)) {
    if (solution != nullptr)
      fail("{}: expected .h5 or .hdf5 for a solution: .dat of Siconos has no place for it", path);
    return write_file(path, siconos_text(file, "nscdd " + version()), force);
  }
  require_ending(path, hdf5_endings);
  if (solution != nullptr) file = with_result(std::move(file), *solution);
  write_file(path, to_hdf5(file, {{"program", "nscdd " + version()}, {"libraries", libraries()}}), force);
}

// A member of a local or of a global problem; None where the problem is of the other kind.
template <class Problem, class Value>
auto member(Value Problem::*value) {
  return [value](const ContactProblem& problem) -> py::object {
    const auto* found = std::get_if<Problem>(&problem.file()->problem);
    if (found == nullptr) return py::none();
    if constexpr (std::is_same_v<Value, Vector>)
      return view(problem.file(), found->*value);
    else
      return sparse_view(problem.file(), found->*value);
  };
}

// Impulses and velocities of a file as a dict of arrays.
py::dict arrays_of(const std::shared_ptr<const FclibFile>& file, const FclibSolution& solution) {
  py::dict found;
  if (std::holds_alternative<GlobalFrictionProblem>(file->problem)) found["v"] = view(file, solution.v);
  found["u"] = view(file, solution.u);
  found["r"] = view(file, solution.r);
  return found;
}

py::dict info_of(const FclibInfo& info) {
  py::dict found;
  if (info.title) found["title"] = printable(*info.title);
  if (info.description) found["description"] = printable(*info.description);
  if (info.math_info) found["math_info"] = printable(*info.math_info);
  return found;
}

}  // namespace

std::shared_ptr<const LocalFrictionProblem> ContactProblem::reduced() const {
  if (const auto* local = std::get_if<LocalFrictionProblem>(&file_->problem)) return {file_, local};
  if (!reduced_)
    reduced_ = LongWork().run(0, [&] {
      return std::make_shared<const LocalFrictionProblem>(reduce(std::get<GlobalFrictionProblem>(file_->problem)));
    });
  return reduced_;
}

void bind_contact_problems(py::module_& module) {
  using P = ContactProblem;
  using Local = LocalFrictionProblem;
  using Global = GlobalFrictionProblem;
  py::class_<P>(module, "ContactProblem")
      .def_property_readonly("contacts", [](const P& p) { return p.file()->contacts(); })
      .def_property_readonly("dimension", [](const P& p) { return p.file()->dimension(); })
      .def_property_readonly("is_global", [](const P& p) { return std::holds_alternative<Global>(p.file()->problem); })
      .def_property_readonly("W", member(&Local::w))
      .def_property_readonly("q", member(&Local::q))
      .def_property_readonly("M", member(&Global::mass))
      .def_property_readonly("H", member(&Global::h))
      .def_property_readonly("f", member(&Global::f))
      .def_property_readonly("w", member(&Global::w))
      .def_property_readonly("mu",
                             [](const P& p) {
                               return std::visit([&](const auto& one) { return view(p.file(), one.friction); },
                                                 p.file()->problem);
                             })
      .def_property_readonly("info", [](const P& p) { return info_of(p.file()->info); })
      .def_property_readonly("solution",
                             [](const P& p) -> std::optional<py::dict> {
                               if (!p.file()->solution) return std::nullopt;
                               return arrays_of(p.file(), *p.file()->solution);
                             })
      .def_property_readonly("guesses",
                             [](const P& p) {
                               py::list all;
                               for (const FclibSolution& one : p.file()->guesses) all.append(arrays_of(p.file(), one));
                               return all;
                             })
      .def("reduced", [](const P& p) {
        const std::shared_ptr<const Local> local = p.reduced();
        FclibFile file;
        file.problem = *local;
        return P(std::move(file));
      });
  module.def("local_problem", &local_problem, py::arg("W"), py::arg("q"), py::arg("mu"));
  module.def("global_problem", &global_problem, py::arg("M"), py::arg("H"), py::arg("f"), py::arg("w"), py::arg("mu"));
  module.def(
      "read_contact_problem", [](const std::string& path) { return P(read_contact_problem(path)); }, py::arg("path"));
  module.def("write_contact_problem", &write, py::arg("problem"), py::arg("path"), py::arg("solution"), py::arg("info"),
             py::arg("force"));
}

}  // namespace nscdd::python
