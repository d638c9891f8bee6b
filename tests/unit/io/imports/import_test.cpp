// What all formats share: the list they stand in, and what is said of files that are wrong.
#include <sstream>

#include "import_sample.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "tests/support/added.hpp"

namespace pivnp::io {
namespace {

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
  std::istringstream in(text_of_file(files.at(0)));
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

}  // namespace
}  // namespace pivnp::io
