// CB-Geo MPM's particle tables, particles<step>.h5: a compound data set /table whose members are read by name. Of an
// MPI run all ranks' files of a step belong together.
#include <cmath>

#include "pivnp/core/error.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "pivnp/io/hdf5/probe.hpp"
#include "pivnp/io/imports/import_format.hpp"

namespace pivnp::io {

namespace {

// One member of every row; empty if the table has no such member.
template <class T>
std::vector<T> member(const h5::Dataset& table, const std::string& name, hid_t native) {
  table.expect_values();
  const h5::Handle type(H5Dget_type(table.id()), H5Tclose);
  if (H5Tget_class(type.get()) != H5T_COMPOUND)
    throw InputError(table.label() + ": not a table of named columns (compound), expected CB-Geo's particle table");
  if (H5Tget_member_index(type.get(), name.c_str()) < 0) return {};
  const h5::Handle one(H5Tcreate(H5T_COMPOUND, sizeof(T)), H5Tclose);
  H5Tinsert(one.get(), name.c_str(), 0, native);
  std::vector<T> values(h5::product(table.shape()));
  if (!values.empty() && H5Dread(table.id(), one.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw InputError(table.label() + ": column '" + name + "' cannot be read");
  return values;
}

std::vector<double> numbers(const h5::Dataset& table, const std::string& name) {
  return member<double>(table, name, H5T_NATIVE_DOUBLE);
}

void append(std::vector<std::array<double, 2>>& to, const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() != y.size()) return;
  for (std::size_t k = 0; k < x.size(); ++k) to.push_back({x[k], y[k]});
}

}  // namespace

ImportedState read_cbgeo(const std::vector<std::filesystem::path>& files) {
  ImportedState s;
  std::vector<double> stress;
  for (const std::filesystem::path& file : files) {
    probe_file(file);
    const h5::Source source(file);
    const h5::Dataset table = source.dataset("/table");
    const std::vector<double> x = numbers(table, "coord_x"), y = numbers(table, "coord_y");
    const auto id = member<std::int64_t>(table, "id", H5T_NATIVE_INT64);
    if (x.empty() != y.empty() || (x.empty() && h5::product(table.shape()) > 0) || id.size() != x.size())
      throw InputError(table.label() + ": columns id, coord_x and coord_y are missing");
    append(s.x, x, y);
    s.id.insert(s.id.end(), id.begin(), id.end());
    append(s.u, numbers(table, "displacement_x"), numbers(table, "displacement_y"));
    append(s.v, numbers(table, "velocity_x"), numbers(table, "velocity_y"));
    const std::vector<double> volume = numbers(table, "volume");
    s.area.insert(s.area.end(), volume.begin(), volume.end());
    const std::vector<double> xx = numbers(table, "stress_xx"), yy = numbers(table, "stress_yy"),
                              zz = numbers(table, "stress_zz"), xy = numbers(table, "tau_xy");
    if (xx.size() == x.size() && yy.size() == x.size() && zz.size() == x.size() && xy.size() == x.size())
      for (std::size_t k = 0; k < x.size(); ++k) stress.insert(stress.end(), {xx[k], yy[k], zz[k], xy[k]});
  }
  // What only some ranks' files know is not known.
  if (s.u.size() != s.x.size()) s.u.clear();
  if (s.v.size() != s.x.size()) s.v.clear();
  if (s.area.size() != s.x.size()) s.area.clear();
  if (!s.x.empty() && stress.size() == 4 * s.x.size()) s.fields.push_back({"stress", std::move(stress)});
  return s;
}

}  // namespace pivnp::io
