// CB-Geo: a compound table with the columns of its particles, more than are read here, in its order.
#include <hdf5.h>

#include <cstdio>

#include "import_sample.hpp"

namespace pivnp::io {
namespace {

struct Row {
  unsigned long long id;
  double mass, volume, coord_x, coord_y, coord_z, displacement_x, displacement_y, displacement_z, velocity_x,
      velocity_y, velocity_z, stress_xx, stress_yy, stress_zz, tau_xy;
  unsigned char status;
};

void write_cbgeo(const fs::path& file, int k, int from, int to) {
  std::vector<Row> rows;
  for (int p = to - 1; p >= from; --p) {  // backwards: ids count, not the order
    const Vec2 x = material(p) + displacement(p, k), u = displacement(p, k);
    rows.push_back({std::uint64_t(100 + p), 1, h * h, x.x(), x.y(), 0, u.x(), u.y(), 0, velocity(p).x(), -1, 0,
                    -1.0 * p, -2, -3, 4, 1});
  }
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Row));
  H5Tinsert(type, "id", HOFFSET(Row, id), H5T_NATIVE_ULLONG);
  const auto column = [&](const char* name, std::size_t offset) { H5Tinsert(type, name, offset, H5T_NATIVE_DOUBLE); };
  column("mass", HOFFSET(Row, mass));
  column("volume", HOFFSET(Row, volume));
  column("coord_x", HOFFSET(Row, coord_x));
  column("coord_y", HOFFSET(Row, coord_y));
  column("coord_z", HOFFSET(Row, coord_z));
  column("displacement_x", HOFFSET(Row, displacement_x));
  column("displacement_y", HOFFSET(Row, displacement_y));
  column("displacement_z", HOFFSET(Row, displacement_z));
  column("velocity_x", HOFFSET(Row, velocity_x));
  column("velocity_y", HOFFSET(Row, velocity_y));
  column("velocity_z", HOFFSET(Row, velocity_z));
  column("stress_xx", HOFFSET(Row, stress_xx));
  column("stress_yy", HOFFSET(Row, stress_yy));
  column("stress_zz", HOFFSET(Row, stress_zz));
  column("tau_xy", HOFFSET(Row, tau_xy));
  H5Tinsert(type, "status", HOFFSET(Row, status), H5T_NATIVE_UCHAR);
  const hid_t out = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t size = rows.size();
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  const hid_t table = H5Dcreate2(out, "table", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(table, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data());
  H5Dclose(table);
  H5Sclose(space);
  H5Fclose(out);
  H5Tclose(type);
}

TEST_F(ImportTest, CbGeo) {
  for (int k = 0; k < steps; ++k) {
    char name[32];
    std::snprintf(name, sizeof name, "particles%04d.h5", k * every);
    write_cbgeo(folder / name, k, 0, nx * ny);
  }
  const auto m = open("cbgeo", "particles*.h5");
  expect_motion(*m, true, true, 1e-6);
  EXPECT_EQ(m->name(), "cbgeo");
  EXPECT_NEAR(double(m->particles().area[3]), h * h, 1e-7);
  const MotionFrame f = m->frame(1);
  EXPECT_NEAR(double(f.field("stress")(0, 0)), -double(m->particles().id[0] - 100), 1e-6);
  EXPECT_NEAR(double(f.field("stress")(0, 3)), 4, 1e-6);
}

TEST_F(ImportTest, CbGeoOfSeveralRanks) {
  for (int k = 0; k < steps; ++k)
    for (int rank = 0; rank < 2; ++rank)
      write_cbgeo(folder / ("particles-" + std::to_string(rank) + "_2-" + std::to_string(k * every) + ".h5"), k,
                  rank == 0 ? 0 : 11, rank == 0 ? 11 : nx * ny);
  expect_motion(*open("cbgeo", "particles-*.h5"), true, true, 1e-6);
}

}  // namespace
}  // namespace pivnp::io
