// Displacement vectors of other programs: places, signs and status of each format, and what is said of files that hold
// no such grid.
#include <cmath>
#include <sstream>

#include "import_sample.hpp"
#include "pivnp/io/imports/import_vectors.hpp"

namespace pivnp::io {
namespace {

class VectorsTest : public ImportTest {
 protected:
  VectorFiles open_vectors(const std::string& format, const std::string& pattern, std::optional<double> rate = {},
                           VerticalAxis y = VerticalAxis::format) const {
    return VectorFiles({.path = pattern, .format = format, .y_axis = y}, folder, rate);
  }
  std::string vectors_refusal(const std::string& format, const std::string& pattern, std::optional<double> rate = {}) const {
    try {
      open_vectors(format, pattern, rate);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  void expect_refusal(const std::string& format, const std::string& text, const std::string& said,
                      std::optional<double> rate = {}) const {
    write("bad_1.txt", text);
    const std::string found = vectors_refusal(format, "bad_1.txt", rate);
    EXPECT_NE(found.find(said), std::string::npos) << "expected " << said << "\nfound " << found;
  }
};

void expect_vector(const VectorField& f, int i, int j, double dx, double dy) {
  const auto& d = f.displacement[f.grid.node(i, j)];
  EXPECT_NEAR(double(d[0]), dx, 1e-6) << i << " " << j;
  EXPECT_NEAR(double(d[1]), dy, 1e-6) << i << " " << j;
}

const char* const pivlab_head =
    "PIVlab by W.Th. & E.J.S., ASCII chart output - 23-Feb-2023\r\n"
    "FRAME: 1, filenames: A: a_1.jpg & B: a_2.jpg, conversion factor xy (px -> m): 1, conversion factor uv (px/frame -> m/s): 1\r\n";

TEST_F(VectorsTest, PivlabInPixels) {
  // Column by column, y downward from pixel (1, 1).
  write("p_0001.txt", std::string(pivlab_head) + "x [px],y [px],u [px/frame],v [px/frame],Vector type [-]\r\n"
                      "9,11,1,2,1\r\n9,19,3,4,2\r\n17,11,NaN,NaN,0\r\n17,19,NaN,NaN,2\r\n");
  const VectorFiles files = open_vectors("pivlab", "p_*.txt");
  EXPECT_TRUE(files.pixels());
  EXPECT_EQ(files.grid(), (Grid{{8, -18}, {8, 8}, 2, 2}));
  EXPECT_EQ(files.frame_names(), (std::vector<std::string>{"a_1.jpg", "a_2.jpg"}));
  EXPECT_FALSE(files.states_uncertainty());
  const VectorField f = files.read(0);
  EXPECT_EQ(f.anchor, Anchor::forward);
  expect_vector(f, 0, 1, 1, -2);  // the upper row
  expect_vector(f, 0, 0, 3, -4);
  EXPECT_EQ(f.status[f.grid.node(0, 1)], VectorStatus::valid);
  EXPECT_EQ(f.status[f.grid.node(0, 0)], VectorStatus::replaced);
  EXPECT_EQ(f.status[f.grid.node(1, 1)], VectorStatus::masked);
  EXPECT_EQ(f.status[f.grid.node(1, 0)], VectorStatus::failed);
  EXPECT_TRUE(std::isnan(f.cov[0][0]) && std::isnan(f.displacement[f.grid.node(1, 1)][0]));
}

// Blanks, earlier versions without the types, lengths, velocities: the file's factors or the case's rate give the time.
TEST_F(VectorsTest, PivlabCalibrated) {
  const std::string names = "x [m] y [m] u [m/s] v [m/s] vorticity [1/s]\r\n", rows =
      "0.1 0.3 2 0 5\r\n0.2 0.3 2 1 5\r\n0.1 0.4 2 0 5\r\n0.2 0.4 2 0 NaN\r\n";
  write("q_1.txt", "PIVlab, ASCII chart output\r\nFRAME: 1, filenames: a & b, conversion factor xy (px -> m): 0.001, conversion "
                   "factor uv (px/frame -> m/s): 0.05\r\n" + names + rows);
  for (const std::optional<double> rate : {std::optional<double>(), std::optional<double>(50.0)}) {
    const VectorFiles files = open_vectors("pivlab", "q_1.txt", rate);
    EXPECT_FALSE(files.pixels());
    EXPECT_NEAR((files.grid().origin - Vec2(0.1, 0.3)).norm(), 0, 1e-12);
    expect_vector(files.read(0), 1, 1, 0.04, -0.02);  // y downward: the first row is the upper one
  }
  expect_vector(open_vectors("pivlab", "q_1.txt", {}, VerticalAxis::up).read(0), 1, 0, 0.04, 0.02);
  EXPECT_NE(vectors_refusal("pivlab", "q_1.txt", 25).find("q_1.txt:3: found a time between the frames of 0.02 s"),
            std::string::npos);
  expect_refusal("pivlab", names + rows, "bad_1.txt:1: u is a velocity");
}

TEST_F(VectorsTest, OpenPivPointsUpwardOrDownward) {
  const std::string names = "# x\ty\tu\tv\tflags\tmask\n";
  write("up_1.txt", names + "16\t40\t1\t2\t0\t0\n32\t40\t1\t2\t1\t0\n16\t24\t3\t4\t2\t0\n32\t24\t0\t0\t0\t1\n");
  write("down_1.txt", names + "16\t24\t1\t-2\t0\t0\n32\t24\t1\t-2\t1\t0\n16\t40\t3\t-4\t2\t0\n32\t40\t0\t0\t0\t1\n");
  for (const char* name : {"up_1.txt", "down_1.txt"}) {
    const VectorFiles files = open_vectors("openpiv", name);
    EXPECT_EQ(files.grid(), (Grid{{16, -40}, {16, 16}, 2, 2})) << name;
    const VectorField f = files.read(0);
    EXPECT_EQ(f.anchor, Anchor::central);
    expect_vector(f, 0, 1, 1, 2);
    expect_vector(f, 0, 0, 3, 4);
    EXPECT_EQ(f.status[f.grid.node(0, 1)], VectorStatus::valid);
    EXPECT_EQ(f.status[f.grid.node(1, 1)], VectorStatus::rejected);
    EXPECT_EQ(f.status[f.grid.node(0, 0)], VectorStatus::replaced);
    EXPECT_EQ(f.status[f.grid.node(1, 0)], VectorStatus::masked);
  }
  write("old_1.txt", "# x y u v mask\n1 2 0 0 1\n2 2 0 0 0\n1 1 0 0 0\n2 1 0 0 0\n");
  EXPECT_EQ(open_vectors("openpiv", "old_1.txt").read(0).status[2], VectorStatus::rejected);
}

TEST_F(VectorsTest, DiceStatesUncertaintyAndLeavesSubsetsOut) {
  write("DICe_solution_1.txt",
        "***\n*** Reference image: ./images/r.tif \n*** Deformed image: ./images/d.tif \n***\n"
        "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA,MATCH\n"
        "0,6.1E+01,9.6E+01,1.0E+00,-2.0E+00,2.0E-02,0.0E+00\n1,6.1E+01,6.1E+01,1.5E+00,0,-1.0E+00,-1.0E+00\n"
        "2,9.6E+01,9.6E+01,5.0E-01,0,1.0E-02,0.0E+00\n");
  const VectorFiles files = open_vectors("dice", "DICe_solution_*.txt");
  EXPECT_EQ(files.frame_names(), (std::vector<std::string>{"r.tif", "d.tif"}));
  EXPECT_TRUE(files.states_uncertainty());
  const VectorField f = files.read(0);
  EXPECT_EQ(f.grid, (Grid{{61, -96}, {35, 35}, 2, 2}));
  expect_vector(f, 0, 0, 1, 2);
  EXPECT_NEAR(double(f.cov[0][1]), 4e-4, 1e-9);
  EXPECT_EQ(f.status[f.grid.node(0, 1)], VectorStatus::failed);
  EXPECT_EQ(f.status[f.grid.node(1, 1)], VectorStatus::masked);  // no row
}

TEST_F(VectorsTest, TablesInPixelsAndInLengths) {
  write("t_1.csv", "x_px;y_px;u_px;v_px;status;sigma_u;sigma_v;score\n0;0;1;2;valid;0.1;0.2;0.9\n4;0;1;2;3;nan;nan;nan\n"
                   "0;4;nan;nan;1;0.1;0.1;0\n4;4;1;0;2;0.1;0.1;0.5\n");
  const VectorField f = open_vectors("csv", "t_1.csv").read(0);
  expect_vector(f, 0, 1, 1, -2);
  EXPECT_NEAR(double(f.cov[f.grid.node(0, 1)][1]), 0.04, 1e-7);
  EXPECT_EQ(f.score[f.grid.node(0, 1)], 0.9f);
  EXPECT_EQ(f.status, (std::vector{VectorStatus::failed, VectorStatus::replaced, VectorStatus::valid, VectorStatus::rejected}));
  write("l_1.csv", "u_m, v_m, x_m, y_m\n1,2,0.5,0\n1,3,1.0,0\n1,2,0.5,1\n1,2,1.0,1\n");
  const VectorFiles lengths = open_vectors("csv", "l_1.csv");
  EXPECT_EQ(lengths.grid(), (Grid{{0.5, 0}, {0.5, 1}, 2, 2}));
  expect_vector(lengths.read(0), 1, 0, 1, 3);
}

TEST_F(VectorsTest, WhatIsNoGridIsRefusedWithItsLine) {
  const std::string names = "x_px,y_px,u_px,v_px\n";
  expect_refusal("csv", names + "0,0,1,1\n8,0,1,1\n17,0,1,1\n0,8,1,1\n", "bad_1.txt:4: found x = 17, expected an even spacing");
  expect_refusal("csv", names + "0,0,1,1\n8,0,1,1\n0,8,1,1\n8,0,1,1\n", "bad_1.txt:5: found a second vector at (8, 0)");
  expect_refusal("csv", names + "0,0,1,1\n8,0,1,1\n", "bad_1.txt:2: all vectors have y = 0");
  expect_refusal("csv", names + "0,0,1,1\n8,0,1,1\n0,8,1\n", "bad_1.txt:4: found 3 values, expected 4");
  expect_refusal("csv", names + "0,0,1,1\n8,zero,1,1\n", "bad_1.txt:3: column 'y_px': found 'zero', expected a number");
  expect_refusal("csv", names + "0,0,1,1\n1,1,1,1\n90000,90000,1,1\n", "expected one at every twentieth");
  expect_refusal("csv", "x_px,y_px,u_px\n", "no column 'v_px'");
  expect_refusal("csv", "x_px,y_px,u_px,v_px,status\n0,0,1,1,7\n", "bad_1.txt:2: column 'status': found '7', expected 0 to 4");
  expect_refusal("pivlab", "9,11,0.5,0.5\n", "bad_1.txt:1: found '9,11,0.5,0.5', expected the line of column names");
  expect_refusal("pivlab", "x [px],y [px],u [m/s],v [m/s]\n", "bad_1.txt:1: found units");
  expect_refusal("openpiv", "1 2 3 4\n", "bad_1.txt:1: found '1 2 3 4', expected the line of column names");
  expect_refusal("dice", "***\nX,Y\n", "bad_1.txt:2: no field 'COORDINATE_X'");
  EXPECT_NE(vectors_refusal("vtk", "bad_1.txt").find("expected csv, pivlab, openpiv or dice"), std::string::npos);
}

TEST_F(VectorsTest, AllFilesHaveTheGridOfTheFirstAndFollowEachOther) {
  const std::string names = "x_px,y_px,u_px,v_px\n", rows = "0,0,1,1\n8,0,1,1\n0,8,1,1\n8,8,1,1\n";
  write("s_1.csv", names + rows);
  write("s_2.csv", names + "1,0,1,1\n9,0,1,1\n1,8,1,1\n9,8,1,1\n");
  EXPECT_NE(vectors_refusal("csv", "s_*.csv").find("s_2.csv:2: found a vector at (1, 0), expected the places of s_1.csv"),
            std::string::npos);
  write("s_2.csv", names + rows + "16,0,1,1\n16,8,1,1\n");
  EXPECT_NE(vectors_refusal("csv", "s_*.csv").find("s_2.csv:2: found 6 vectors, expected 4 as in s_1.csv"), std::string::npos);
  write("s_2.csv", names + rows);
  EXPECT_EQ(open_vectors("csv", "s_*.csv").frame_names(), (std::vector<std::string>{"frame 1", "frame 2", "frame 3"}));
  const auto pivlab = [&](const char* file, const char* images) {
    write(file, "FRAME: 1, filenames: " + std::string(images) + ", conversion factor xy (px -> m): 1\r\n"
                "x [px]\ty [px]\tu [px/frame]\tv [px/frame]\r\n1\t1\t0\t0\r\n5\t1\t0\t0\r\n1\t5\t0\t0\r\n5\t5\t0\t0\r\n");
  };
  pivlab("n_1.txt", "A: a & B: b");
  pivlab("n_2.txt", "A: c & B: d");
  EXPECT_NE(vectors_refusal("pivlab", "n_*.txt").find("n_2.txt:1: found vectors from 'c' to 'd', expected them from 'b'"),
            std::string::npos);
}

}  // namespace
}  // namespace pivnp::io
