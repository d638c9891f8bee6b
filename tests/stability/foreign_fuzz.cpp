// Files of other programs, changed at random: each is read, or refused with one line that names it. Never a crash, a
// hang, another exception, or memory asked for on the word of a number. The seed is printed; PIVNP_TEST_SEED repeats a
// run, PIVNP_FUZZ_RUNS sets the runs of the long form.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>

#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/imports/curve_file.hpp"
#include "pivnp/io/imports/import_motion.hpp"
#include "pivnp/io/imports/import_vectors.hpp"
#include "tests/unit/io/records/sample.hpp"

namespace pivnp::io {
namespace {

namespace fs = std::filesystem;

unsigned seed() {
  static const unsigned value = [] {
    const char* given = std::getenv("PIVNP_TEST_SEED");
    const unsigned s = given ? unsigned(std::strtoul(given, nullptr, 10)) : std::random_device{}();
    std::printf("seed %u\n", s);
    return s;
  }();
  return value;
}

int long_runs(int usual) {
  const char* given = std::getenv("PIVNP_FUZZ_RUNS");
  return given ? std::atoi(given) : usual;
}

// Numbers and words that readers stumble over.
constexpr std::array words = {"inf", "-inf", "nan", "1e999", "-1e308", "1e-320", "-1", "0", "2147483648", "4294967297",
                              "9223372036854775807", "18446744073709551615", "99999999999999999999999", "1.0-100", ",,,",
                              "\"", "\n", "\r\n", ";", " ", "POINTS 4000000000 float\n", "SCALARS a double 100000000000\n",
                              "CELL_TYPES 18446744073709551615\n", "FIELD f 1000000000\n", "NumberOfComponents=\"2000000000\""};

std::string mutated(std::string text, std::mt19937& random) {
  const auto at = [&] { return text.empty() ? 0 : random() % text.size(); };
  for (int k = 1 + int(random() % 4); k > 0; --k) switch (random() % 6) {
      case 0:
        if (!text.empty()) text[at()] = char(random());
        break;
      case 1:
        text.insert(at(), words[random() % words.size()]);
        break;
      case 2: {  // a word for a word
        const std::size_t begin = text.find_first_of("0123456789.-", at());
        if (begin == text.npos) break;
        const std::size_t end = std::min(text.find_first_not_of("0123456789.-+eE", begin), text.size());
        text.replace(begin, end - begin, words[random() % words.size()]);
        break;
      }
      case 3:
        text.resize(at());
        break;
      case 4:
        text.erase(at(), random() % 30);
        break;
      default: {
        const std::string piece = text.substr(at(), random() % 60);
        text.insert(at(), piece);
      }
    }
  return text;
}

// Not over the old file: one that is cut off and written anew is flushed to the disk, which takes a hundred times as long.
void put(const fs::path& file, const std::string& text) {
  fs::remove(file);
  std::ofstream(file, std::ios::binary) << text;
}

// `read` sees the changed file; what it throws must be one line of InputError that names it.
void attack(const fs::path& file, const std::string& whole, int runs, const std::function<void()>& read,
            const std::function<std::string(std::string, std::mt19937&)>& change = mutated) {
  std::mt19937 random(seed());
  int refused = 0;
  for (int run = 0; run < runs; ++run) {
    const std::string text = change(whole, random);
    put(file, text);
    try {
      read();
    } catch (const InputError& error) {
      ++refused;
      const std::string line = error.what();
      ASSERT_NE(line.find(file.filename().string()), line.npos) << line << "\nrun " << run << " of seed " << seed();
      ASSERT_EQ(line.find('\n'), line.npos) << line << "\nrun " << run << " of seed " << seed();
    } catch (const std::exception& error) {
      FAIL() << error.what() << "\nrun " << run << " of seed " << seed() << ":\n" << text.substr(0, 2000);
    }
  }
  EXPECT_GT(refused, runs / 100);
  EXPECT_LT(refused, runs);
}

void read_motion(const std::string& format, const fs::path& file) {
  const auto motion = open_import(format + "=" + file.string(), {});
  for (std::size_t k = 0; k < motion->times().size(); ++k) motion->frame(k);
}

const std::string tracks = [] {
  std::ostringstream text;
  text << "id,time,x,y,vx,vy,sigma_x,sigma_y,area\n";
  for (int t = 0; t < 3; ++t)
    for (int p = 0; p < 9; ++p)
      text << p << "," << 0.1 * t << "," << p % 3 + 0.1 * t << "," << p / 3 << ",1,0,0.1,0.1,1.0\n";
  return text.str();
}();

const std::string curve = "time (s),front (m)\n0,1.0\n0.5,1.5\n1.0,2.0\n2.0,nan\n";

std::string legacy(bool binary) {
  std::ostringstream text;
  const auto number = [&](float v) {
    if (!binary) {
      text << v << "\n";
      return;
    }
    std::uint32_t bits;
    std::memcpy(&bits, &v, sizeof bits);
    for (int k = 3; k >= 0; --k) text << char(bits >> (8 * k));
  };
  text << "# vtk DataFile Version 3.0\npoints\n" << (binary ? "BINARY" : "ASCII") << "\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 float\n";
  for (int p = 0; p < 9; ++p) number(float(p % 3)), number(float(p / 3)), number(0);
  text << "\nPOINT_DATA 9\nVECTORS displacement_solid float\n";
  for (int p = 0; p < 27; ++p) number(0.1f);
  text << "\nSCALARS material_point_id float 1\nLOOKUP_TABLE default\n";
  for (int p = 0; p < 9; ++p) number(float(p));
  text << "\n";
  return text.str();
}

const std::string xml = [] {
  std::ostringstream text;
  text << "<VTKFile type=\"UnstructuredGrid\">\n<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (int p = 0; p < 9; ++p) text << p % 3 << " " << p / 3 << " 0\n";
  text << "</DataArray>\n</Points>\n<DataArray Name=\"Displacement\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (int p = 0; p < 27; ++p) text << "0.1 ";
  text << "</DataArray>\n<DataArray Name=\"Particle Id\" format=\"ascii\">\n0 1 2 3 4 5 6 7 8\n</DataArray>\n</VTKFile>\n";
  return text.str();
}();

// Vectors at the nodes of a grid of 3 x 3, as each format has them.
std::string rows(const std::string& head, const std::string& separator, const std::string& more) {
  std::ostringstream text;
  text << head;
  for (int n = 0; n < 9; ++n)
    text << 9 + 8 * (n % 3) << separator << 11 + 8 * (n / 3) << separator << 0.1 * n << separator << -1.5e-1 << more << "\n";
  return text.str();
}

const std::string pivlab = rows("PIVlab, ASCII chart output - 23-Feb-2023\r\nFRAME: 1, filenames: A: a.png & B: b.png, conversion "
                                "factor xy (px -> m): 0.01, conversion factor uv (px/frame -> m/s): 0.5\r\n"
                                "x [m],y [m],u [m/s],v [m/s],Vector type [-]\r\n", ",", ",1\r");
const std::string openpiv = rows("# x\ty\tu\tv\tflags\tmask\n", "\t", "\t0.0000e+00\t0.0000e+00");
const std::string dice = rows("***\n*** Reference image: ./a.tif \n*** Deformed image: ./b.tif \n***\n"
                              "COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA,MATCH\n", ",", ",1.0000E-02,0");
const std::string vectors = rows("x_px;y_px;u_px;v_px;status;sigma_u;sigma_v;score\n", ";", ";valid;0.02;0.03;0.9");

void read_vectors(const char* format, const fs::path& file) {
  const VectorFiles files({.path = file.string(), .format = format}, "", {});
  files.read(0);
}

void attack_texts(int runs) {
  const test::Scratch there;
  const auto file = [&](const char* name) { return there.path / name; };
  attack(file("tracks.csv"), tracks, runs, [&] { read_motion("csv", file("tracks.csv")); });
  attack(file("curve.csv"), curve, runs, [&] { read_curve(file("curve.csv"), "", 1); });
  attack(file("p1.vtk"), legacy(false), runs, [&] { read_motion("vtk", file("p1.vtk")); });
  attack(file("p2.vtk"), legacy(true), runs, [&] { read_motion("vtk", file("p2.vtk")); });
  attack(file("v1.txt"), pivlab, runs, [&] { read_vectors("pivlab", file("v1.txt")); });
  attack(file("v2.txt"), openpiv, runs, [&] { read_vectors("openpiv", file("v2.txt")); });
  attack(file("v3.txt"), dice, runs, [&] { read_vectors("dice", file("v3.txt")); });
  attack(file("v4.csv"), vectors, runs, [&] { read_vectors("csv", file("v4.csv")); });
  attack(file("p3.vtu"), xml, runs, [&] { read_motion("vtu", file("p3.vtu")); });
}

// A record as a report reads it: `sealed` with its checksum, else as an older version or another program leaves it.
void attack_record(bool sealed, int runs) {
  const test::Scratch there;
  sample::run(there.path, {}, false);
  const fs::path file = there.path / "record.h5";
  std::ostringstream bytes;
  bytes << std::ifstream(file, std::ios::binary).rdbuf();
  std::string whole = bytes.str();
  if (!sealed) whole.resize(whole.size() - seal_bytes);
  const auto change = [](std::string text, std::mt19937& random) {
    if (random() % 20 == 0) text.resize(random() % text.size());
    if (text.empty()) return text;
    for (std::size_t k = 1 + random() % 16; k > 0; --k)
      text[random() % (random() % 2 ? text.size() : std::min<std::size_t>(text.size(), 8192))] = char(random());
    return text;
  };
  const auto read = [&] {
    const RecordReader record(file);
    for (std::size_t k = 0; k < record.pair_count(); ++k) record.pair(k);
    for (const std::string& name : record.motion_names()) {
      const auto motion = record.motion(name);
      for (std::size_t k = 0; k < motion->times().size(); ++k) motion->frame(k);
      record.strain_note(name);
    }
    record.closure();
    record.energy();
    record.comparison();
  };
  if (!sealed) return attack(file, whole, runs, read, change);
  std::mt19937 random(seed());
  for (int run = 0; run < runs; ++run) {
    const std::string text = change(whole, random);
    put(file, text);
    if (text == whole || seal_of(file) == Seal::none) continue;  // what made it a sealed file is gone: the other kind
    EXPECT_THROW(read(), InputError) << "run " << run << " of seed " << seed();
  }
}

TEST(FuzzSmall, Texts) { attack_texts(3'000); }
TEST(FuzzSmall, Records) {
  attack_record(true, 100);
  attack_record(false, 100);
}
TEST(Fuzz, Texts) { attack_texts(long_runs(1'000'000)); }
TEST(Fuzz, Records) {
  attack_record(true, long_runs(10'000));
  attack_record(false, long_runs(20'000));
}

}  // namespace
}  // namespace pivnp::io
