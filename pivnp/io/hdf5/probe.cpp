#include "pivnp/io/hdf5/probe.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/hdf5/hdf5_internal.hpp"

namespace pivnp::io {

namespace {

constexpr std::size_t block_bytes = std::size_t{16} << 20, most_objects = 10'000'000;
constexpr double bytes_per_second = 5e6, least_seconds = 20;
// A deflated byte holds 1032 at most; beyond both of these a shape is a damaged number.
constexpr double most_ratio = 2000, least_limit = double(std::size_t{1} << 30);
// What the child may ask for beyond what it has from the start: values are read in blocks, so a sound file needs little.
constexpr double least_memory = double(std::size_t{2} << 30), memory_ratio = 4;

struct Walk {
  double limit = 0;  // bytes of one dataset
  std::size_t objects = 0;
  std::string why;    // where HDF5 does not say it
  std::string fault;  // of the first that cannot be read

  bool refuse(const std::string& cause) {
    why = cause;
    return false;
  }
};

const char too_large[] = "its size is beyond what the file can hold";

// Bytes of a value in memory; 0 for kinds that are not read, here or by anyone.
std::size_t value_bytes(hid_t type) {
  if (!h5::reads(type)) return 0;
  return H5Tis_variable_str(type) > 0 ? sizeof(char*) : H5Tget_size(type);
}

bool within(hid_t space, std::size_t bytes, double limit) {
  h5::Shape shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  double total = double(bytes);
  for (const hsize_t n : shape) total *= double(n);
  return total <= limit;
}

bool read_attribute(hid_t object, const char* name, Walk& walk) {
  const h5::Handle id(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!id) return false;
  const h5::Handle type(H5Aget_type(id.get()), H5Tclose), space(H5Aget_space(id.get()), H5Sclose);
  const std::size_t bytes = value_bytes(type.get());
  if (bytes == 0) return true;
  if (!within(space.get(), bytes, walk.limit)) return walk.refuse(too_large);
  const h5::Handle memory(H5Tget_native_type(type.get(), H5T_DIR_ASCEND), H5Tclose);
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space.get())));
  std::vector<char> values(count * std::max(bytes, H5Tget_size(memory.get())));
  if (values.empty()) return true;
  if (H5Aread(id.get(), memory.get(), values.data()) < 0) return false;
  if (H5Tis_variable_str(type.get()) > 0) H5Dvlen_reclaim(memory.get(), space.get(), H5P_DEFAULT, values.data());
  return true;
}

// Values that are in another file, which nobody has looked at and nobody named.
bool refuse_elsewhere(hid_t properties, Walk& walk) {
  std::array<char, 200> name{};
  if (H5Pget_external_count(properties) > 0) {
    H5Pget_external(properties, 0, name.size() - 1, name.data(), nullptr, nullptr);
    return walk.refuse("its values are in another file, '" + std::string(name.data()) + "'");
  }
  if (H5Pget_layout(properties) != H5D_VIRTUAL) return true;
  std::size_t count = 0;
  if (H5Pget_virtual_count(properties, &count) < 0) return false;
  for (std::size_t k = 0; k < count; ++k) {
    if (H5Pget_virtual_filename(properties, k, name.data(), name.size()) < 0) return false;
    if (std::strcmp(name.data(), ".") != 0)
      return walk.refuse("a virtual dataset that shows another file, '" + std::string(name.data()) + "'");
  }
  return true;
}

// Filters of which the library itself undoes any, and none is loaded from elsewhere.
bool refuse_filters(hid_t properties, Walk& walk) {
  for (int k = 0; k < H5Pget_nfilters(properties); ++k) {
    std::array<char, 100> name{};
    std::size_t values = 0;
    unsigned flags = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(properties, unsigned(k), &flags, &values, nullptr, name.size() - 1, name.data(), nullptr);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
      return walk.refuse("packed by filter " + std::to_string(filter) + (name[0] ? " (" + printable_part(name.data(), 60) + ")" : "") +
                         ", expected deflate, shuffle or fletcher32");
  }
  return true;
}

// A block of items at a time.
bool read_values(hid_t id, Walk& walk) {
  const h5::Handle properties(H5Dget_create_plist(id), H5Pclose);
  if (!properties || !refuse_elsewhere(properties.get(), walk) || !refuse_filters(properties.get(), walk)) return false;
  const h5::Handle type(H5Dget_type(id), H5Tclose), space(H5Dget_space(id), H5Sclose);
  if (!type || !space) return false;
  const std::size_t bytes = value_bytes(type.get());
  if (bytes == 0 || H5Pget_layout(properties.get()) == H5D_VIRTUAL) return true;  // nobody reads the latter (Dataset::expect_values)
  if (!within(space.get(), bytes, walk.limit)) return walk.refuse(too_large);
  const h5::Handle memory_type(H5Tget_native_type(type.get(), H5T_DIR_ASCEND), H5Tclose);
  h5::Shape extent(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.get()))));
  H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
  const hsize_t items = extent.empty() ? 1 : extent[0];
  const std::size_t item_bytes = h5::product(extent, 1) * std::max(bytes, H5Tget_size(memory_type.get()));
  if (items == 0 || item_bytes == 0) return true;
  const hsize_t block = std::clamp<hsize_t>(block_bytes / item_bytes, 1, items);
  std::vector<char> values(block * item_bytes);
  for (hsize_t first = 0; first < items; first += block) {
    h5::Shape start(extent.size(), 0), some = extent;
    h5::Handle memory(H5Screate(H5S_SCALAR), H5Sclose);
    if (!extent.empty()) {
      start[0] = first;
      some[0] = std::min(block, items - first);
      memory = h5::Handle(H5Screate_simple(int(some.size()), some.data(), nullptr), H5Sclose);
      if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, some.data(), nullptr) < 0) return false;
    }
    if (H5Dread(id, memory_type.get(), memory.get(), space.get(), H5P_DEFAULT, values.data()) < 0) return false;
    if (H5Tis_variable_str(type.get()) > 0)
      H5Dvlen_reclaim(memory_type.get(), memory.get(), H5P_DEFAULT, values.data());
  }
  return true;
}

herr_t visit_attribute(hid_t object, const char* name, const H5A_info_t*, void* data) {
  return read_attribute(object, name, *static_cast<Walk*>(data)) ? 0 : -1;
}

herr_t visit(hid_t root, const char* name, const H5O_info_t* info, void* data) {
  Walk& walk = *static_cast<Walk*>(data);
  const h5::Handle object(H5Oopen(root, name, H5P_DEFAULT), H5Oclose);
  const bool read = ++walk.objects <= most_objects && object &&
                    H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, visit_attribute, data) >= 0 &&
                    (info->type != H5O_TYPE_DATASET || read_values(object.get(), walk));
  if (!read && walk.fault.empty())
    walk.fault.append("/").append(std::strcmp(name, ".") == 0 ? "" : printable_part(name, 200)).append(" cannot be read (")
        .append(walk.why.empty() ? h5::last_cause() : walk.why).append(")");
  return read ? 0 : -1;
}

// Links to other files are followed by whoever opens an object by its path.
herr_t visit_link(hid_t, const char* name, const H5L_info_t* info, void* data) {
  if (info->type == H5L_TYPE_HARD || info->type == H5L_TYPE_SOFT) return 0;
  static_cast<Walk*>(data)->fault.append("/").append(printable_part(name, 200)).append(" is a link to another file, which is not followed");
  return -1;
}

const std::string readable = "readable";  // what the child says of a file that it could read
constexpr int shortage_code = 3;           // its exit code where the process, not the file, is to blame

// The child's whole life: what is wrong with the file, or nothing.
std::string fault_of(const std::string& file, double size) {
  h5::silence();
  H5PLset_loading_state(0);  // groups too may name filters of their own
  const h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
#if H5_VERSION_GE(1, 10, 7)
  H5Pset_file_locking(access.get(), false, true);
#endif
  open_regular_file(file);  // HDF5 does not tell what it is short of from what is damaged
  const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!id) return "a truncated or damaged HDF5 file (" + h5::last_cause() + ")";
  Walk walk;
  walk.limit = std::max(least_limit, most_ratio * size);
  if (H5Lvisit(id.get(), H5_INDEX_NAME, H5_ITER_NATIVE, visit_link, &walk) < 0 && !walk.fault.empty()) return walk.fault;
#if H5_VERSION_GE(1, 12, 0)
  const herr_t visited = H5Ovisit(id.get(), H5_INDEX_NAME, H5_ITER_NATIVE, visit, &walk, H5O_INFO_BASIC);
#else
  const herr_t visited = H5Ovisit(id.get(), H5_INDEX_NAME, H5_ITER_NATIVE, visit, &walk);
#endif
  return visited >= 0 ? "" : "a damaged HDF5 file: " + (walk.fault.empty() ? h5::last_cause() : walk.fault);
}

// Bytes of this process that count against RLIMIT_DATA: what it has from its parent (much, under a sanitizer).
double data_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmData:") {
      double kilobytes = 0;
      status >> kilobytes;
      return 1024 * kilobytes;
    }
  return 0;
}

// Quietly: whatever goes wrong in there is told by the parent. Whether it was held to less memory than a sound file may need.
bool settle_child(double seconds, double size) {
  const int nowhere = ::open("/dev/null", O_RDWR);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    if (nowhere > STDERR_FILENO) ::close(nowhere);
  }
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM, SIGINT, SIGTERM}) ::signal(signal, SIG_DFL);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // it holds the folder's lock as the parent does
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  ::alarm(static_cast<unsigned>(seconds));
  rlimit memory{}, addresses{};
  ::getrlimit(RLIMIT_DATA, &memory);
  ::getrlimit(RLIMIT_AS, &addresses);
  const auto enough = static_cast<rlim_t>(data_bytes() + least_memory + memory_ratio * size);
  const bool held = memory.rlim_cur < enough || addresses.rlim_cur != RLIM_INFINITY;
  memory.rlim_cur = std::min(memory.rlim_cur, enough);
  ::setrlimit(RLIMIT_DATA, &memory);
  return held;
}

std::string rest_of(int descriptor) {
  std::string text;
  std::array<char, 512> block{};
  for (;;) {
    const ssize_t got = ::read(descriptor, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(block.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace

void probe_file(const std::filesystem::path& file) { probe_files({file}); }

void probe_files(std::vector<std::filesystem::path> files) {
  h5::silence();
  std::error_code ignored;
  std::erase_if(files, [&](const std::filesystem::path& file) {
    return !std::filesystem::is_regular_file(file, ignored) || H5Fis_hdf5(file.c_str()) <= 0;
  });
  if (files.empty()) return;
  const std::string name = files.size() == 1 ? files[0].string() : files[0].parent_path().string();
  double size = 0;
  for (const std::filesystem::path& file : files) size += double(std::filesystem::file_size(file, ignored));
  const double seconds = least_seconds + size / bytes_per_second;
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw RunError(name + ": " + std::strerror(errno));
  const pid_t child = ::fork();
  if (child < 0) {
    const std::string cause = std::strerror(errno);
    ::close(pipe[0]);
    ::close(pipe[1]);
    throw RunError(name + ": cannot be looked at in a process of its own: " + cause);
  }
  if (child == 0) {
    int code = 1;
    try {
      const bool held = settle_child(seconds, size);
      std::string fault;
      bool shortage = false;
      try {
        for (const std::filesystem::path& file : files)
          if (fault.empty()) fault = fault_of(file.string(), double(std::filesystem::file_size(file)));
        if (held && fault.find("alloc") != std::string::npos) throw std::bad_alloc();  // HDF5: "memory allocation failed"
      } catch (const std::bad_alloc&) {
        shortage = held;
        fault = held ? name + ": out of memory" : "a damaged HDF5 file: it asks for more memory than its size can need";
      } catch (const RunError& error) {
        shortage = true;
        fault = error.what();
      }
      const std::string& said = fault.empty() ? readable : fault;
      if (::write(pipe[1], said.data(), said.size()) >= 0) code = fault.empty() ? 0 : shortage ? shortage_code : 2;
    } catch (...) {
    }
    ::_exit(code);  // nothing of the parent's is shut down
  }
  ::close(pipe[1]);
  const std::string fault = rest_of(pipe[0]);
  ::close(pipe[0]);
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(child, &status, 0)) < 0 && errno == EINTR) {
  }
  if (fault == readable && (ended < 0 || (WIFEXITED(status) && WEXITSTATUS(status) == 0))) return;
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM)) throw Interrupted();
  if (WIFEXITED(status) && WEXITSTATUS(status) == shortage_code) throw RunError(fault);
  if (!fault.empty() && fault != readable) throw InputError(name + ": " + fault);
  const bool late = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
  throw InputError(name + ": a damaged HDF5 file: " +
                   (late                  ? "not read within " + std::to_string(int(seconds)) + " s"
                    : WIFSIGNALED(status) ? "the HDF5 library crashes on it (signal " + std::to_string(WTERMSIG(status)) + ")"
                                          : std::string("the HDF5 library fails on it")));
}

}  // namespace pivnp::io
