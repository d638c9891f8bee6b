// Compares two HDF5 files object by object.
#pragma once

#include <hdf5.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace pivnp::io::sample {

/// Every object, attribute, type, shape and value of `file`, one a line, values as a checksum or as text; without the
/// root's attribute `created`. Two records are equal if these are.
inline std::vector<std::string> describe(const std::string& file) {
  struct State {
    hid_t file;
    std::vector<std::string> lines;
  } state{H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), {}};
  const auto values = [](hid_t type, hid_t space, const auto& read) {
    std::ostringstream line;
    hsize_t dims[8] = {};
    const int rank = H5Sget_simple_extent_dims(space, dims, nullptr);
    line << " class " << H5Tget_class(type) << " size " << H5Tget_size(type) << " shape";
    for (int k = 0; k < rank; ++k) line << ' ' << dims[k];
    const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
    if (H5Tis_variable_str(type) > 0) {
      std::vector<char*> raw(count + 1, nullptr);
      read(type, raw.data());
      for (std::size_t k = 0; k < count; ++k) line << " '" << (raw[k] ? raw[k] : "") << "'";
      if (count > 0) H5Dvlen_reclaim(type, space, H5P_DEFAULT, raw.data());
    } else {
      std::string raw(count * H5Tget_size(type) + 1, '\0');
      if (count > 0) read(type, raw.data());
      line << " hash " << std::hash<std::string>{}(raw);
    }
    return line.str();
  };
  const auto visit = [](hid_t, const char* name, const H5O_info_t* info, void* data) -> herr_t {
    State& s = *static_cast<State*>(data);
    using Values = decltype(values);
    const Values show{};
    const hid_t object = H5Oopen(s.file, name, H5P_DEFAULT);
    std::string line = name;
    if (info->type == H5O_TYPE_DATASET) {
      const hid_t type = H5Dget_type(object), space = H5Dget_space(object);
      line +=
          show(type, space, [&](hid_t t, void* out) { return H5Dread(object, t, H5S_ALL, H5S_ALL, H5P_DEFAULT, out); });
      H5Tclose(type);
      H5Sclose(space);
    }
    s.lines.push_back(line);
    for (int k = 0; k < H5Aget_num_attrs(object); ++k) {
      const hid_t a =
          H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, static_cast<hsize_t>(k), H5P_DEFAULT, H5P_DEFAULT);
      char attribute[128];
      H5Aget_name(a, sizeof attribute, attribute);
      const hid_t type = H5Aget_type(a), space = H5Aget_space(a);
      if (std::string(attribute) != "created")
        s.lines.push_back(std::string(name) + "@" + attribute +
                          show(type, space, [&](hid_t t, void* out) { return H5Aread(a, t, out); }));
      H5Tclose(type);
      H5Sclose(space);
      H5Aclose(a);
    }
    H5Oclose(object);
    return 0;
  };
  H5Ovisit(state.file, H5_INDEX_NAME, H5_ITER_INC, visit, &state);
  H5Fclose(state.file);
  return state.lines;
}

}  // namespace pivnp::io::sample
