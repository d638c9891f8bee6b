#include "pivnp/io/hdf5/hdf5_driver.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

namespace pivnp::io::h5 {

namespace {

struct Access {
  WriteStatus* status;
};

struct DriverFile {
  H5FD_t base;  // first: HDF5 knows us by it
  int descriptor;
  haddr_t allocated;  // end of what HDF5 has given out
  haddr_t end;        // end of what was written
  WriteStatus* status;
};

DriverFile& self(H5FD_t* file) { return *reinterpret_cast<DriverFile*>(file); }
const DriverFile& self(const H5FD_t* file) { return *reinterpret_cast<const DriverFile*>(file); }

void note(DriverFile& f) {
  if (f.status->error == 0) f.status->error = errno;
}

H5FD_t* open_file(const char* name, unsigned, hid_t access, haddr_t) {
  const void* info = H5Pget_driver_info(access);
  if (!info) return nullptr;
  WriteStatus* status = static_cast<const Access*>(info)->status;
  // A link that somebody left under a temporary name is not written through.
  const int descriptor = ::open(name, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) {
    status->error = errno;
    return nullptr;
  }
  return reinterpret_cast<H5FD_t*>(new DriverFile{{}, descriptor, 0, 0, status});
}

herr_t close_file(H5FD_t* file) {
  DriverFile& f = self(file);
  if (f.status->error == 0 && ::fsync(f.descriptor) != 0) note(f);
  if (::close(f.descriptor) != 0) note(f);
  delete &f;
  return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t get_allocated(const H5FD_t* file, H5FD_mem_t) { return self(file).allocated; }
herr_t set_allocated(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  self(file).allocated = address;
  return 0;
}
haddr_t get_end(const H5FD_t* file, H5FD_mem_t) { return self(file).end; }

herr_t read_file(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, void* buffer) {
  DriverFile& f = self(file);
  auto* out = static_cast<char*>(buffer);
  while (size > 0) {
    const ssize_t got = ::pread(f.descriptor, out, size, static_cast<off_t>(address));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) note(f);
    if (got <= 0) {  // beyond the end: zeros, as HDF5's own driver does
      std::memset(out, 0, size);
      return 0;
    }
    out += got;
    address += static_cast<haddr_t>(got);
    size -= static_cast<size_t>(got);
  }
  return 0;
}

herr_t write_file(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, const void* buffer) {
  DriverFile& f = self(file);
  const auto* in = static_cast<const char*>(buffer);
  while (size > 0 && f.status->error == 0) {
    const ssize_t put = ::pwrite(f.descriptor, in, size, static_cast<off_t>(address));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      note(f);
      break;
    }
    in += put;
    address += static_cast<haddr_t>(put);
    size -= static_cast<size_t>(put);
  }
  f.end = std::max(f.end, address + size);  // as if written, so that HDF5 closes the file in peace
  return 0;
}

herr_t truncate_file(H5FD_t* file, hid_t, hbool_t) {
  DriverFile& f = self(file);
  if (f.end == f.allocated) return 0;
  if (f.status->error == 0 && ::ftruncate(f.descriptor, static_cast<off_t>(f.allocated)) != 0) note(f);
  f.end = f.allocated;
  return 0;
}

hid_t driver() {
  static const hid_t id = [] {
    static H5FD_class_t c{};
#if H5_VERSION_GE(1, 13, 0)
    c.version = H5FD_CLASS_VERSION;
    c.value = static_cast<H5FD_class_value_t>(600);
#endif
    c.name = "pivnp";
    c.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
    c.fc_degree = H5F_CLOSE_WEAK;
    c.fapl_size = sizeof(Access);
    c.open = open_file;
    c.close = close_file;
    c.query = query;
    c.get_eoa = get_allocated;
    c.set_eoa = set_allocated;
    c.get_eof = get_end;
    c.read = read_file;
    c.write = write_file;
    c.truncate = truncate_file;
    const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(map), std::end(map), c.fl_map);
    return H5FDregister(&c);
  }();
  return id;
}

}  // namespace

bool use_checked_driver(hid_t access, WriteStatus* status) {
  const Access info{status};
  return driver() >= 0 && H5Pset_driver(access, driver(), &info) >= 0;
}

}  // namespace pivnp::io::h5
