// Results of other programs: files written here from their documented layouts read back as the motion they hold.
#include "pivnp/io/import_motion.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "pivnp/core/error.hpp"
#include "pivnp/io/import_format.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/added.hpp"

namespace pivnp::io {
namespace {

namespace fs = std::filesystem;

constexpr double h = 0.5;
constexpr int nx = 6, ny = 5, steps = 3, every = 10;  // files are numbered 0, 10, 20

Vec2 material(int p) { return {2 + h * (p % nx), -1 + h * (p / nx)}; }
// x = X + u, affine: what comes back must be exact for any reader.
Mat2 gradient(int k) {
  Mat2 G;
  G << 0.10, 0.05, -0.04, -0.08;
  return double(k) * G;
}
Vec2 displacement(int p, int k) { return gradient(k) * material(p) + k * Vec2(0.3, -0.2); }
Vec2 velocity(int p) { return Vec2(0.1 * p, -1); }

class ImportTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  std::unique_ptr<MotionSource> open(const std::string& format, const std::string& pattern, double step = 0.01) const {
    return open_import(format + "=" + (folder / pattern).string(), {.step = step});
  }
  std::string refusal(const std::string& format, const std::string& pattern) const {
    try {
      const auto motion = open(format, pattern);
      motion->frame(motion->times().size() - 1);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

  // Ids are 100 + p; `digits`: what the file's numbers are good for.
  void expect_motion(const MotionSource& m, bool ids, bool v, double digits) const {
    ASSERT_EQ(m.particles().size(), std::size_t(nx * ny));
    ASSERT_EQ(m.times().size(), std::size_t(steps));
    EXPECT_NEAR(m.times()[2], 2 * every * 0.01, 1e-12);
    EXPECT_EQ(m.length_unit(), "m");
    for (int k = 0; k < steps; ++k) {
      const MotionFrame f = m.frame(std::size_t(k));
      ASSERT_EQ(f.v.size(), v ? std::size_t(nx * ny) : 0U);
      for (int q = 0; q < nx * ny; ++q) {
        const std::size_t at = std::size_t(q);
        const int p = ids ? int(m.particles().id[at]) - 100 : q;
        EXPECT_NEAR((m.particles().x0[at] - material(p)).norm(), 0, digits);
        EXPECT_EQ(f.status[at], ParticleStatus::active);
        const Vec2 u = displacement(p, k);
        EXPECT_NEAR(double(f.u[at][0]), u.x(), digits);
        EXPECT_NEAR(double(f.u[at][1]), u.y(), digits);
        const Mat2 F = Mat2::Identity() + gradient(k);
        for (int c = 0; c < 4; ++c) EXPECT_NEAR(double(f.F[at][std::size_t(c)]), F(c / 2, c % 2), 20 * digits);
        if (v) {
          EXPECT_NEAR(double(f.v[at][0]), velocity(p).x(), 1e-5);
        }
      }
    }
    EXPECT_TRUE(std::isnan(m.particles().end[0]));
  }
  const test::Scratch scratch;
  const fs::path& folder = scratch.path;
};

// ---- CB-Geo: a compound table with the columns of its particles, more than are read here, in its order.
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

// ---- Anura3D: legacy VTK 3.0, scalars and vectors of a step in files of their own.
template <class T>
void append_big_endian(std::string& out, T value) {
  const char* raw = reinterpret_cast<const char*>(&value);
  for (std::size_t k = sizeof(T); k-- > 0;) out += raw[k];
}

std::string vtk_head(int k, bool binary) {
  const int n = nx * ny;
  std::ostringstream out;
  out.precision(17);
  out << "# vtk DataFile Version 3.0\nslope\n"
      << (binary ? "BINARY" : "ASCII") << "\nDATASET UNSTRUCTURED_GRID\nPOINTS   " << n
      << (binary ? " double\n" : " float\n");
  std::string text = out.str();
  for (int p = 0; p < n; ++p) {
    const Vec2 x = material(p) + displacement(p, k);
    for (double v : {x.x(), x.y(), 0.0}) {
      char number[40];
      std::snprintf(number, sizeof number, " %.15E", v);
      if (binary) append_big_endian(text, v);
      else text += number;
    }
    if (!binary) text += "\n";
  }
  text += (binary ? "\nCELLS " : "CELLS ") + std::to_string(n) + " " + std::to_string(2 * n) + "\n";
  for (int p = 0; p < n; ++p) {
    if (binary) {
      append_big_endian(text, std::int32_t(1));
      append_big_endian(text, std::int32_t(p));
    } else {
      text += "1 " + std::to_string(p) + "\n";
    }
  }
  text += (binary ? "\nCELL_TYPES " : "CELL_TYPES ") + std::to_string(n) + "\n";
  for (int p = 0; p < n; ++p) {
    if (binary) append_big_endian(text, std::int32_t(1));
    else text += "1\n";
  }
  return text + (binary ? "\nPOINT_DATA " : "POINT_DATA ") + std::to_string(n) + "\n";
}

template <class Value>
std::string vtk_array(const std::string& title, bool binary, int components, Value&& value) {
  std::string text = title;
  for (int p = 0; p < nx * ny; ++p)
    for (int c = 0; c < components; ++c) {
      char number[40];
      std::snprintf(number, sizeof number, " %.15E\n", value(p, c));
      if (binary) append_big_endian(text, double(value(p, c)));
      else text += number;
    }
  return text + "\n";
}

class Anura : public ImportTest, public testing::WithParamInterface<bool> {
 protected:
  void write_steps() const {
    const bool binary = GetParam();
    const std::string type = binary ? " double" : " float";
    for (int k = 0; k < steps; ++k) {
      char number[16];
      std::snprintf(number, sizeof number, "%03d", k * every);
      write("slope_MPVector_" + std::string(number) + ".vtk",
            vtk_head(k, binary) +
                vtk_array("VECTORS displacement_solid" + type + "\n", binary, 3,
                          [&](int p, int c) { return c < 2 ? displacement(p, k)[c] : 0.0; }) +
                vtk_array("VECTORS velocity_solid" + type + "\n", binary, 3,
                          [&](int p, int c) { return c < 2 ? velocity(p)[c] : 0.0; }));
      write("slope_MPScalar_" + std::string(number) + ".vtk",
            vtk_head(k, binary) +
                vtk_array("SCALARS pressure_liquid" + type + " 1\nLOOKUP_TABLE default\n", binary, 1,
                          [](int p, int) { return 1e-120 * p; }) +  // three digits of exponent
                vtk_array("SCALARS material_point_id" + type + " 1\nLOOKUP_TABLE default\n", binary, 1,
                          [](int p, int) { return 100.0 + p; }));
      write("slope_MPTensor_" + std::string(number) + ".vtk",
            vtk_head(k, binary) + vtk_array("TENSORS strain" + type + "\n", binary, 9, [](int, int) { return 0.0; }));
    }
  }
};

TEST_P(Anura, StepsWithTheirSiblings) {
  write_steps();
  expect_motion(*open("vtk", "slope_MPVector_*.vtk"), true, true, 1e-6);
  expect_motion(*open("vtk", "slope_MPTensor_*.vtk"), true, true, 1e-6);
}
INSTANTIATE_TEST_SUITE_P(AsciiAndBinary, Anura, testing::Bool());

TEST_F(ImportTest, FortranNumbersWithoutAnE) {
  std::string text = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n"
                     " 1.5-101 2.0D+00 0\nPOINT_DATA 1\nVECTORS displacement_solid float\n-.5 +.25 0\n";
  write("a_MPVector_000.vtk", text);
  const auto m = open("vtk", "a_MPVector_000.vtk");
  EXPECT_EQ(m->particles().x0[0].x(), 0.5);
  EXPECT_EQ(m->particles().x0[0].y(), 1.75);
}

// ---- MPM-Geomechanics: VTU in ASCII, its attributes spelled Format.
TEST_F(ImportTest, MpmGeomechanics) {
  for (int k = 0; k < steps; ++k) {
    std::ostringstream out;
    out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
        << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" << nx * ny << "\" NumberOfCells=\"" << nx * ny
        << "\">\n<Points>\n"
        << "<DataArray type=\"Float64\" NumberOfComponents=\"3\" Format=\"ascii\">\n"
        << std::scientific;
    for (int p = 0; p < nx * ny; ++p) {
      const Vec2 x = material(p) + displacement(p, k);
      out << x.x() << " " << x.y() << " " << 0.25 << "\n";
    }
    out << "</DataArray>\n</Points>\n<PointData>\n<DataArray type=\"UInt64\" Name=\"Particle Id\" Format=\"ascii\">\n";
    for (int p = 0; p < nx * ny; ++p) out << 100 + p << "\n";
    const auto vectors = [&](const char* name, auto&& value) {
      out << "</DataArray>\n<DataArray type=\"Float64\" Name=\"" << name
          << "\" NumberOfComponents=\"3\" Format=\"ascii\">\n";
      for (int p = 0; p < nx * ny; ++p) out << value(p).x() << " " << value(p).y() << " " << 0.0 << "\n";
    };
    vectors("Displacement", [&](int p) { return displacement(p, k); });
    vectors("Velocity", [&](int p) { return velocity(p); });
    for (const char* name : {"Stress_XX", "Stress_YY", "Stress_ZZ", "Stress_XY"}) {
      out << "</DataArray>\n<DataArray type=\"Float64\" Name=\"" << name << "\" Format=\"ascii\">\n";
      for (int p = 0; p < nx * ny; ++p) out << -7.0 << "\n";
    }
    out << "</DataArray>\n</PointData>\n<Cells>\n<DataArray type=\"Int32\" Name=\"connectivity\" Format=\"ascii\">\n";
    for (int p = 0; p < nx * ny; ++p) out << p << "\n";
    out << "</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    write("particles_" + std::to_string(k * every) + ".vtu", out.str());
  }
  const auto m = open("vtu", "particles_*.vtu");
  expect_motion(*m, true, true, 5e-6);  // six decimals
  EXPECT_EQ(m->frame(0).field("stress")(0, 2), -7.0f);
}

// ---- Tables.
TEST_F(ImportTest, TracksInOneTable) {
  std::string text = "\xef\xbb\xbf# tracked by hand\r\nframe; particle; x; y; sigma_x; sigma_y; quality\r\n";
  for (int p = nx * ny - 1; p >= 0; --p)
    for (int k = steps - 1; k >= 0; --k) {
      const Vec2 x = material(p) + displacement(p, k);
      char row[160];
      std::snprintf(row, sizeof row, "%d;%d; %.9f;%.9f;0.02;0.03;good\r\n", k * every, 100 + p, x.x(), x.y());
      text += row;
    }
  write("tracks.csv", text);
  const auto m = open("csv", "tracks.csv");
  expect_motion(*m, true, false, 1e-6);
  EXPECT_NEAR(double(m->frame(1).cov_u[4][1]), 0.0009, 1e-8);
}

TEST_F(ImportTest, OneTableAStep) {
  for (int k = 0; k < steps; ++k) {
    std::string text = "Particle Id,Points:0,Points:1,Displacement:0,Displacement:1,Velocity:0,Velocity:1\n";
    for (int p = 0; p < nx * ny; ++p) {
      const Vec2 u = displacement(p, k), x = material(p) + u;
      char row[200];
      std::snprintf(row, sizeof row, "%d,%.9g,%.9g,%.9g,%.9g,%.9g,-1\n", 100 + p, x.x(), x.y(), u.x(), u.y(),
                    velocity(p).x());
      text += row;
    }
    write("p" + std::to_string(k * every) + ".csv", text);
  }
  expect_motion(*open("csv", "p*.csv"), true, true, 1e-6);
}

TEST_F(ImportTest, TracksBeginAndEnd) {
  write("t.csv", "t,id,x,y\n0,1,0,0\n1,1,1,0\n2,1,2,0\n0,2,5,5\n1,2,5,6\n1,3,9,9\n2,3,9,8\n");
  const auto m = open("csv", "t.csv");
  ASSERT_EQ(m->particles().size(), 3U);
  EXPECT_TRUE(std::isnan(m->particles().end[0]));
  EXPECT_EQ(m->particles().end[1], 1);
  EXPECT_EQ(m->particles().born[2], 1);
  EXPECT_EQ(m->frame(0).status[2], ParticleStatus::unborn);
  EXPECT_EQ(m->frame(2).status[1], ParticleStatus::ended);
  EXPECT_NEAR(double(m->frame(2).u[2][1]), -1, 1e-6);  // from its first place
  EXPECT_TRUE(std::isnan(m->frame(1).F[0][0]));        // too few neighbours to say
}

// Without ids the place in the file tells particles apart, and that holds only while none appears or goes.
TEST_F(ImportTest, ParticlesThatCannotBeToldApartAreRefused) {
  write("a1.csv", "x,y\n0,0\n1,0\n2,0\n");
  write("a2.csv", "x,y\n0,0\n2,0\n");
  EXPECT_NE(refusal("csv", "a*.csv").find("a2.csv: found 2 particles without ids, expected 3"), std::string::npos)
      << refusal("csv", "a*.csv");
  write("b_MPVector_1.vtk",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 2 float\n0 0 0 1 1 0\nPOINT_DATA 2\n"
        "SCALARS material_point_id float 1\nLOOKUP_TABLE default\n7 7\n");
  EXPECT_NE(refusal("vtk", "b_MPVector_1.vtk").find("id 7"), std::string::npos);
}

TEST_F(ImportTest, WhatIsWrongIsSaid) {
  EXPECT_FALSE(is_import("out/record.h5:np"));
  EXPECT_TRUE(is_import("csv=a.csv"));
  EXPECT_NE(refusal("csv", "nothing*.csv").find("no such file"), std::string::npos);
  write("a.csv", "id,x\n1,2\n");
  EXPECT_NE(refusal("csv", "a.csv").find("a.csv:1: no column 'y'"), std::string::npos);
  write("b.csv", "id,x,y\n1,2,oops\n");
  EXPECT_NE(refusal("csv", "b.csv").find("b.csv:2: column 'y': found 'oops', expected a number"), std::string::npos);
  write("c.csv", "t,id,x,y\n0,1,0,0\n0,1,1,1\n");
  EXPECT_NE(refusal("csv", "c.csv").find("id 1"), std::string::npos);
  write("d_1.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 2 float\n0 0 0 1 1");
  EXPECT_NE(refusal("vtk", "d_1.vtk").find("ends too early"), std::string::npos);
  write("e_1.vtu",
        "<VTKFile><Points><DataArray NumberOfComponents=\"3\" format=\"appended\">_</DataArray></Points></VTKFile>");
  EXPECT_NE(refusal("vtu", "e_1.vtu").find("format 'appended', expected ascii"), std::string::npos);
  write("f_1.h5", "not HDF5");
  EXPECT_NE(refusal("cbgeo", "f_1.h5").find("f_1.h5"), std::string::npos);
}

// Two numbers a line: one time.
ImportedState read_pairs(const std::vector<fs::path>& files) {
  std::istringstream in(read_text(files.at(0)));
  ImportedState state;
  for (double x, y; in >> x >> y;) state.x.push_back({x, y});
  state.fields.push_back({"plastic_dev", std::vector<double>(state.x.size(), 0.25)});
  return state;
}

TEST_F(ImportTest, AnAddedFormatIsReadAndNamed) {
  write("dots_0.txt", "0 0\n1 0\n0 1\n1 1\n");
  write("dots_1.txt", "0 0\n1.5 0\n0 1\n1.5 1\n");
  EXPECT_FALSE(is_import("dots=a.txt"));
  const test::Added dots(file_formats(), {.name = "dots", .files = "dots_*.txt", .text = "points", .read_time = read_pairs});
  {
    const auto m = open("dots", "dots_*.txt", 0.5);
    EXPECT_EQ(m->name(), "dots");
    EXPECT_EQ(m->times(), (std::vector<double>{0, 0.5}));
    const MotionFrame f = m->frame(1);
    EXPECT_EQ(f.u[3], (std::array<float, 2>{0.5f, 0}));
    EXPECT_NEAR(f.F[3][0], 1.5f, 1e-6f);
    EXPECT_EQ(f.field("plastic_dev")(2), 0.25f);
  }
  EXPECT_TRUE(formats_text(&FileFormat::motion).ends_with(" or dots"));
  EXPECT_EQ(formats_text(&FileFormat::curve).find("dots"), std::string::npos);
  std::string message;
  try {
    open("history", "dots_0.txt");
  } catch (const InputError& e) {
    message = e.what();
  }
  EXPECT_NE(message.find("dots"), std::string::npos) << message;
}

TEST_F(ImportTest, WhatIsNotFiniteIsNamedWithItsLine) {
  write("a.csv", "id,time,x,y\n1,0,0,0\n2,0,inf,0\n");
  EXPECT_NE(refusal("csv", "a.csv").find("a.csv:3: "), std::string::npos) << refusal("csv", "a.csv");
  write("a.csv", "id,time,x,y\n1,0,0,0\n2,0,0,1e300\n");
  EXPECT_NE(refusal("csv", "a.csv").find("a.csv:3: "), std::string::npos) << refusal("csv", "a.csv");
  const std::string head = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  write("a1.vtk", head + "POINTS 2 float\n0 0 0\n1 -inf 0\n");
  EXPECT_NE(refusal("vtk", "a1.vtk").find("a1.vtk:7: found '-inf'"), std::string::npos) << refusal("vtk", "a1.vtk");
  write("a1.vtu", "<VTKFile>\n<Points>\n<DataArray NumberOfComponents=\"3\">\n0 0 0\n1 inf 0\n</DataArray>\n</Points>\n");
  EXPECT_NE(refusal("vtu", "a1.vtu").find("a1.vtu:5: "), std::string::npos) << refusal("vtu", "a1.vtu");
}

TEST_F(ImportTest, CountsAreNotBelieved) {
  const std::string head = "# vtk DataFile Version 3.0\nx\n";
  for (const char* kind : {"ASCII", "BINARY"})
    for (const char* count : {"4000000000000", "6148914691236517206", "18446744073709551615"}) {
      write("a1.vtk", head + kind + "\nDATASET UNSTRUCTURED_GRID\nPOINTS " + count + " float\n0 0 0\n");
      EXPECT_NE(refusal("vtk", "a1.vtk").find(count), std::string::npos) << refusal("vtk", "a1.vtk");
    }
}

// A tracker that finds a mark later, or loses it for good, writes nan.
TEST_F(ImportTest, ATrackMayBeginAndEndUnknown) {
  std::string text = "id,time,x,y\n";
  for (int t = 0; t < 4; ++t)
    for (int p = 0; p < 9; ++p) {
      const bool unknown = (p == 4 && t < 2) || (p == 7 && t > 1) || p == 8;
      text += std::to_string(p) + "," + std::to_string(t) + "," + (unknown ? "nan" : std::to_string(p % 3 + 0.5 * t)) + "," +
              std::to_string(p / 3) + "\n";
    }
  write("a.csv", text);
  const auto m = open("csv", "a.csv");
  const ParticleSet& set = m->particles();
  ASSERT_EQ(set.size(), 8u);  // the last is never seen
  const auto place = [&](std::int64_t id) {
    return std::size_t(std::find(set.id.begin(), set.id.end(), id) - set.id.begin());
  };
  const std::size_t late = place(4), lost = place(7);
  EXPECT_EQ(set.born[late], 2);
  EXPECT_EQ(set.x0[late], Vec2(2, 1));
  EXPECT_TRUE(std::isnan(set.end[late]));
  EXPECT_EQ(m->frame(1).status[late], ParticleStatus::unborn);
  EXPECT_EQ(m->frame(3).status[late], ParticleStatus::active);
  EXPECT_EQ(set.end[lost], 1);
  EXPECT_EQ(m->frame(2).status[lost], ParticleStatus::ended);
  // All move alike: displacements that count from different times strain nothing.
  const MotionFrame last = m->frame(3);
  EXPECT_EQ(last.F[place(0)], (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_TRUE(std::isnan(last.F[late][0]));
}

}  // namespace
}  // namespace pivnp::io
