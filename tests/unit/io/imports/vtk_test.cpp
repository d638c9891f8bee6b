// Legacy VTK of Anura3D and VTU of MPM-Geomechanics.
#include <cstdio>
#include <sstream>

#include "import_sample.hpp"

namespace pivnp::io {
namespace {

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

TEST_F(ImportTest, NumbersThatAreTooLargeAreRefusedAndThoseTooSmallAreZero) {
  const auto file = [&](const std::string& x) {
    write("b_MPVector_000.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n" + x + " 2 0\n");
  };
  for (const char* large : {"3e412", "-7.5E+399", "2.0+999", "1d5000"}) {
    file(large);
    EXPECT_NE(refusal("vtk", "b_MPVector_000.vtk").find("expected a finite number"), std::string::npos) << large;
  }
  for (const char* small : {"3e-412", "-7.5E-399", "2.0-999", "1d-5000"}) {
    file(small);
    EXPECT_EQ(open("vtk", "b_MPVector_000.vtk")->particles().x0[0].x(), 0) << small;
  }
  write("c.csv", "id,x,y\n1,4e-420,2\n");
  EXPECT_EQ(open("csv", "c.csv")->particles().x0[0].x(), 0);
  write("c.csv", "id,x,y\n1,4e420,2\n");
  EXPECT_NE(refusal("csv", "c.csv").find("expected a finite number"), std::string::npos);
}

TEST_F(ImportTest, PiecesFollowOneAnother) {
  const auto piece = [](int from, int to, const std::string& name) {
    std::string points, ids;
    for (int k = from; k < to; ++k) points += std::to_string(0.1 * k) + " " + std::to_string(3 - 0.2 * k) + " 0 ", ids += std::to_string(70 + k) + " ";
    return "<Piece NumberOfPoints=\"" + std::to_string(to - from) + "\">\n<Points><DataArray NumberOfComponents=\"3\" format=\"ascii\">" + points +
           "</DataArray></Points>\n<PointData><DataArray Name=\"" + name + "\" format=\"ascii\">" + ids + "</DataArray></PointData></Piece>\n";
  };
  const auto file = [&](const std::string& pieces) {
    write("p_0.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>\n" + pieces + "</UnstructuredGrid></VTKFile>\n");
  };
  file(piece(0, 4, "Particle Id") + piece(4, 5, "Particle Id") + piece(5, 9, "Particle Id"));
  const auto m = open("vtu", "p_0.vtu");
  ASSERT_EQ(m->particles().size(), 9u);
  for (std::size_t k = 0; k < 9; ++k) {
    EXPECT_EQ(m->particles().id[k], std::int64_t(70 + k));
    EXPECT_NEAR(m->particles().x0[k].x(), 0.1 * double(k), 1e-6);
  }
  file(piece(0, 4, "Particle Id") + piece(4, 9, "Material Id"));
  EXPECT_NE(refusal("vtu", "p_0.vtu").find("in every piece"), std::string::npos) << refusal("vtu", "p_0.vtu");
}

TEST_F(ImportTest, CountsAreNotBelieved) {
  const std::string head = "# vtk DataFile Version 3.0\nx\n";
  for (const char* kind : {"ASCII", "BINARY"})
    for (const char* count : {"4000000000000", "6148914691236517206", "18446744073709551615"}) {
      write("a1.vtk", head + kind + "\nDATASET UNSTRUCTURED_GRID\nPOINTS " + count + " float\n0 0 0\n");
      EXPECT_NE(refusal("vtk", "a1.vtk").find(count), std::string::npos) << refusal("vtk", "a1.vtk");
    }
}

}  // namespace
}  // namespace pivnp::io
