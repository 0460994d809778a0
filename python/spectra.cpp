// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "core/fail.hpp"
#include "long_work.hpp"
#include "module.hpp"
#include "options.hpp"
#include "study/linear/sweep_points.hpp"
#include "study/linear/values.hpp"

namespace nscdd::python {
namespace {

// One flexibility in 1/kg from its text, such as "0.1" or "0.1W".
double one_value(const FlexibilityValues& values, double scale, std::string_view name) {
  if (values.first.size() != 1) fail("{}: expected one value, met {}", name, values.first.size());
  return values.second ? values.first.front() * scale : values.first.front();
}

Contraction contraction_of(const std::shared_ptr<Model>& model, const std::string& epsilon_text,
                           const std::string& eta_text, const std::string& contacts, double relaxation,
                           const std::string& scheme_text) {
  const double scale = flexibility_scale(*model);
  const double epsilon = one_value(parse_epsilon(epsilon_text), scale, "epsilon");
  const double eta = one_value(parse_eta(eta_text), scale, "eta");
  check_bounds(relaxation, Field{.above = 0}, "relaxation");
  const ContactSet set = Choice<ContactSet>::parse(contacts, "contacts");
  const auto scheme_asked = Choice<DecompositionScheme>::parse(scheme_text, "scheme");
  const SweepParameters point{.epsilon = {epsilon}, .eta = {eta}, .relaxation = {relaxation}, .scheme = scheme_asked};
  check_sweep(point);
  warn_of(remarks_on(*model, point));
  LongWork work;
  return work.run(0, [&] {
    const Enriched scheme{eta};  // eta = infinity is the generic algorithm
    const LinearViscous law{epsilon};
    if (scheme_asked == DecompositionScheme::schwarz) {
      Contraction j =
          set == ContactSet::all
              ? schwarz_contraction(model->parts, law)
              : schwarz_contraction(restrict_contacts(model->parts, choose_contacts(*model, set).active), law);
      j.relaxation = relaxation;
      return j;
    }
    Contraction b = set == ContactSet::all
                        ? contraction(model->parts, scheme, law)
                        : contraction(model->parts, scheme, law, choose_contacts(*model, set).active);
    b.relaxation = relaxation;
    return b;
  });
}

// The vector of an operator's domain. Throws Error for one of another length.
Vector argument(const py::object& f, Index size) {
  Vector given = vector(f, "vector");
  if (given.size() != size) fail("vector: expected {} entries, met {}", size, given.size());
  return given;
}

template <class Operator, class Apply>
auto applied(Apply apply) {
  return [apply](const Operator& x, const py::object& f) {
    const Vector given = argument(f, x.rows());
    const py::gil_scoped_release released;
    return Vector(apply(x, given));
  };
}

py::array_t<double> dense(const InterfaceOperator& x) {
  const auto kept = std::make_shared<const InterfaceOperator>(x);
  LongWork work;
  const Matrix* matrix = work.run(0, [&] { return &kept->dense(); });
  return matrix_view(kept, *matrix);
}

void bind_operators(py::module_& module) {
  using X = InterfaceOperator;
  py::class_<X>(module, "InterfaceOperator")
      .def_property_readonly("eta", &X::flexibility)
      .def_property_readonly("rows", &X::rows)
      .def_property_readonly("nullity", [](const X& x) { return LongWork().run(0, [&] { return x.nullity(); }); })
      .def("apply", applied<X>([](const X& x, const Vector& f) { return x.apply(f); }), py::arg("f"))
      .def("solve", applied<X>([](const X& x, const Vector& g) { return x.solve(g); }), py::arg("g"))
      .def("dense", &dense);
  using B = Contraction;
  py::class_<B, std::shared_ptr<B>>(module, "Contraction")
      .def_property_readonly("preconditioner", [](const B& b) { return b.preconditioner; })
      .def_property_readonly("system", [](const B& b) { return b.system; })
      .def_readonly("relaxation", &B::relaxation)
      .def_property_readonly("scheme", [](const B& b) { return std::string(to_string(b.scheme)); })
      .def_property_readonly("rows", &B::rows)
      .def("apply", applied<B>([](const B& b, const Vector& f) { return b.apply(f); }), py::arg("f"));
  module.def("contraction", &contraction_of, py::arg("parts"), py::arg("epsilon"), py::arg("eta"), py::arg("contacts"),
             py::arg("relaxation"), py::arg("scheme"));
}

std::string shown_radius(const SpectralRadius& radius) {
  std::string text = fmt::format("SpectralRadius(value={}, eigenvalue_min={}, eigenvalue_max={}", radius.value,
                                 radius.eigenvalue_min, radius.eigenvalue_max);
  if (radius.unit_multiplicity > 0)
    text += fmt::format(", unit_multiplicity={}, subdominant={}", radius.unit_multiplicity, radius.subdominant);
  return text + fmt::format(", solver='{}', residual={:.1e}, converged={}, certified={})", radius.solver,
                            radius.residual, radius.converged ? "True" : "False", radius.certified ? "True" : "False");
}

void bind_radius(py::module_& module) {
  using R = SpectralRadius;
  using Shared = std::shared_ptr<R>;
  py::class_<R, Shared>(module, "SpectralRadius",
                        "Spectral radius of a contraction operator B with its certificate. Every eigenvalue of B is "
                        "real, because it is 1 - omega lambda for an eigenvalue lambda of the symmetric pencil (S, P).")
      .def_readonly("value", &R::value, "rho(B), the largest modulus of an eigenvalue; 0 for an empty interface")
      .def_readonly("eigenvalue_min", &R::eigenvalue_min, "smallest eigenvalue of B (nan for an empty interface)")
      .def_readonly("eigenvalue_max", &R::eigenvalue_max, "largest eigenvalue of B")
      .def_readonly("unit_multiplicity", &R::unit_multiplicity,
                    "of the eigenvalue 1 in the rigid limit epsilon = 0, n_Gamma - rank X_0; else 0")
      .def_readonly("subdominant", &R::subdominant,
                    "largest modulus among the other eigenvalues: the rate on the complement of ker S")
      .def_readonly("subdominant_min", &R::subdominant_min, "smallest eigenvalue of B without the unit eigenvalues")
      .def_readonly("subdominant_max", &R::subdominant_max, "largest eigenvalue of B without the unit eigenvalues")
      .def_readonly("solver", &R::solver,
                    "dense, arpack, shift-invert, or none for an empty interface; if no solver has the answer that was "
                    "asked for, all that were tried, such as 'shift-invert+dense+arpack'")
      .def_readonly("failure", &R::failure, "if no solver has the answer that was asked for: why each failed")
      .def_readonly("applications", &R::applications, "products with interface operators, or solves")
      .def_readonly("factorisations", &R::factorisations, "of the shifted pencil")
      .def_readonly("residual", &R::residual, "an eigenvalue of B lies within this distance of each end given")
      .def_readonly("converged", &R::converged,
                    "the solver says so, and the residual is at most the tolerance times max(1, value)")
      .def_readonly("certified", &R::certified, "inertia counts leave no eigenvalue outside of the intervals")
      .def_property_readonly(
          "interval_min", [](const R& r) { return std::pair(r.interval_min[0], r.interval_min[1]); },
          "holds subdominant_min where certified")
      .def_property_readonly(
          "interval_max", [](const R& r) { return std::pair(r.interval_max[0], r.interval_max[1]); },
          "holds subdominant_max where certified")
      .def_readonly("within_min", &R::within_min, "eigenvalues in interval_min, with multiplicity")
      .def_readonly("within_max", &R::within_max, "eigenvalues in interval_max, with multiplicity")
      .def_property_readonly(
          "low", [](const Shared& r) { return view(r, r->low); },
          "smallest eigenvalues of B, ascending, without the unit eigenvalues")
      .def_property_readonly(
          "high", [](const Shared& r) { return view(r, r->high); },
          "largest eigenvalues of B, descending, without the unit eigenvalues")
      .def_property_readonly(
          "mode_min", [](const Shared& r) { return view(r, r->mode_min); },
          "interface impulses of subdominant_min; empty where unknown")
      .def_property_readonly(
          "mode_max", [](const Shared& r) { return view(r, r->mode_max); },
          "interface impulses of subdominant_max; empty where unknown")
      .def("__float__", [](const R& r) { return r.value; })
      .def("__repr__", &shown_radius);
}

}  // namespace

SpectralOptions spectral_options(const py::dict& given) {
  auto options = with_fields<SpectralOptions>(given);
  if (options.solver == SpectralSolver::slepc)
    fail("solver: expected auto, dense, arpack or shift-invert, met slepc, which nscdd-mpi has");
  check(options);
  return options;
}

void bind_spectra(py::module_& module) {
  bind_operators(module);
  bind_radius(module);
  module.attr("spectral_options") = described_fields<SpectralOptions>();
  module.def(
      "spectral_radius",
      [](const Contraction& b, const py::dict& given, Index threads) {
        LongWork work;
        const SpectralOptions options = work.watched(spectral_options(given));
        return std::make_shared<SpectralRadius>(work.run(threads, [&] { return spectral_radius(b, options); }));
      },
      py::arg("b"), py::arg("options"), py::arg("threads"));
}

}  // namespace nscdd::python
