// The comparison of two motions.
#include <pybind11/stl.h>

#include <cmath>

#include "apps/study/pipeline/record/outcome.hpp"
#include "compare/compare.hpp"
#include "python/src/guard.hpp"
#include "python/src/parts.hpp"

namespace pivnp::python {

namespace {

template <class T>
py::array copied(const std::vector<T>& values, Shape shape) {
  return taken<T>(std::vector<T>(values), std::move(shape));
}

}  // namespace

py::dict in_python(const Comparison& c) {
  py::list metrics, fields, tables, limits;
  for (const Metric& m : c.metrics)
    metrics.append(
        py::make_tuple(m.name, m.value, m.unit, m.uncertainty, m.definition, std::string(name_of(m.verdict)), m.within(), m.seen(),
                       std::string(name_of(m.limit)), std::string(name_of(m.lost_in)), m.numerical, m.input));
  for (const ComparisonField& f : c.fields)
    fields.append(py::make_tuple(f.name, f.unit, f.definition, copied(f.time, {py::ssize_t(f.time.size())}),
                                 copied(f.id, {py::ssize_t(f.id.size())}),
                                 copied(f.values, {py::ssize_t(f.time.size()), py::ssize_t(f.id.size())})));
  for (const ComparisonTable& t : c.tables) {
    py::list columns;
    for (const auto& column : t.columns)
      columns.append(
          py::make_tuple(column.name, column.unit, copied(column.values, {py::ssize_t(column.values.size())})));
    tables.append(py::make_tuple(t.name, t.definition, columns));
  }
  for (const LimitResult& l : c.limits) limits.append(py::make_tuple(l.key, l.limit, l.reached, l.met));
  py::dict out;
  out["metrics"] = metrics;
  out["fields"] = fields;
  out["tables"] = tables;
  out["limits"] = limits;
  out["remarks"] = c.remarks;
  return out;
}

namespace {

py::dict compare(const Motion& first, const Motion& second, const std::string& toml,
                 const std::vector<std::shared_ptr<Motion>>& coarser, double ratio) {
  const app::Case c = case_of(toml);
  compare::CompareOptions options = c.compare;
  app::add_camera(std::hypot(first.residual, second.residual), options);
  compare::Refinement refinement{{}, ratio};
  for (const auto& motion : coarser) refinement.coarser.push_back(motion->source.get());
  const Comparison found = unlocked([&](Progress& progress) {
    const std::lock_guard lock(hdf5_mutex());
    return compare::compare(*first.source, *second.source, options, c.limits, progress, refinement,
                            {first.note, second.note});
  });
  return in_python(found);
}

}  // namespace

void bind_comparison(py::module_& m) {
  m.def("compare", &compare, py::arg("first"), py::arg("second"), py::arg("toml"), py::arg("coarser"),
        py::arg("ratio"));
}

}  // namespace pivnp::python
