// The extension module pivnp._core: engines on arrays. What users see is made of it in python/pivnp/.
#include <omp.h>
#include <pthread.h>

#include "pivnp/core/error.hpp"
#include "pivnp/core/version.hpp"
#include "pivnp/image/files/image_file.hpp"
#include "python/src/guard.hpp"
#include "python/src/parts.hpp"

namespace pivnp::python {

app::Case case_of(const std::string& toml, const std::vector<std::string>& given) {
  const std::string name = "options";
  try {
    app::Case c = app::parse_case(toml, name, ".", given);
    if (c.name.empty()) c.name = "the case";  // as later messages call it
    return c;
  } catch (const InputError& error) {
    const std::string text = error.what();
    const std::size_t end = text.starts_with(name + ":") ? text.find(": ") : std::string::npos;
    throw InputError(end == std::string::npos ? text : text.substr(end + 2));
  }
}

}  // namespace pivnp::python

PYBIND11_MODULE(_core, m) {
  namespace py = pybind11;
  using namespace pivnp;
  pthread_atfork(nullptr, nullptr, [] {
    python::forked() = true;
    omp_set_num_threads(1);
  });
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    } catch (const Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    } catch (const RunError& error) {
      PyErr_SetString(PyExc_RuntimeError, error.what());
    }
  });
  image::silence_vendor_messages();
  m.attr("__version__") = build_info().version;
  m.attr("commit") = build_info().commit;
  m.attr("libraries") = build_info().libraries;
  python::bind_vectors(m);
  python::bind_motions(m);
  python::bind_tracker(m);
  python::bind_simulation(m);
  python::bind_comparison(m);
}
