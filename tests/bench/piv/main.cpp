// Accuracy and speed of the PIV methods on synthetic pairs of known displacement, against what is asked of the default.
#include <cstdio>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/piv/methods.hpp"
#include "tests/bench/piv/bench.hpp"

namespace {

using namespace pivnp;
using namespace pivnp::bench;

const char* usage =
    "usage: piv_table [options]\n"
    "  --side PX (1024)  --spacing PX (8)  --margin PX (48)  --threads N (1)  --repeats N (3)  --seeds A,B,.. (101)\n"
    "  --method NAME[:KEY=VALUE..],.. (default)  --window PX (32)  --anchor central|forward (central)\n"
    "  --rows NAME,.. (all; part of a name, ^ its start, $ its end)  --more (fields beside the table)  --csv FILE  "
    "--clock wall|cpu (wall)\n"
    "  --map (instead of the table: flags against errors over a map of images)\n"
    "  --outliers (instead of the table: outliers put into fields, found and false alarms of the validation)\n"
    "  --real (instead of the table: real and published images, folder in the environment's PIVNP_TEST_DATA)\n"
    "  --speed (instead of the table: threads, masks, sizes, memory, instruction sets, 12-megapixel pairs, the "
    "machine)\n"
    "  --stages (instead of the table: operations and bytes of the methods' stages against the machine's roofline)\n"
    "  --subsets (instead of the table: direct correlation, by which drift is corrected)\n"
    "  --texture blobs|soil  --blob PX (3)  --density N (0.05; soil 0.2)  --blur PX (0)  --bits 8|12|16\n";

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

template <class Number>
Number number(const std::string& key, const std::string& value) {
  std::istringstream stream(value);
  Number n{};
  if (!(stream >> n) || !stream.eof()) throw InputError("--" + key + ": found '" + value + "', expected a number");
  return n;
}

int run(int argc, char** argv) {
  BenchOptions options;
  piv::PivOptions base;
  std::vector<std::string> methods = {"default"};
  int (*part)(const BenchOptions&) = table;
  std::string blob, density, blur, bits;
  const std::map<std::string, std::function<void(const std::string&)>> with_value = {
      {"side", [&](const std::string& v) { options.side = number<int>("side", v); }},
      {"spacing", [&](const std::string& v) { options.spacing = number<int>("spacing", v); }},
      {"margin", [&](const std::string& v) { options.margin = number<int>("margin", v); }},
      {"threads", [&](const std::string& v) { options.threads = number<int>("threads", v); }},
      {"repeats", [&](const std::string& v) { options.repeats = number<int>("repeats", v); }},
      {"seeds",
       [&](const std::string& v) {
         options.seeds.clear();
         for (const std::string& seed : split(v)) options.seeds.push_back(number<int>("seeds", seed));
       }},
      {"method", [&](const std::string& v) { methods = split(v); }},
      {"window", [&](const std::string& v) { base.window_px = number<int>("window", v); }},
      {"anchor", [&](const std::string& v) { base.anchor = choice<Anchor>("--anchor", v); }},
      {"clock",
       [&](const std::string& v) {
         if (v != "wall" && v != "cpu") throw InputError("--clock: found '" + v + "', expected wall or cpu");
         options.cpu_clock = v == "cpu";
       }},
      {"rows", [&](const std::string& v) { options.rows = split(v); }},
      {"csv", [&](const std::string& v) { options.csv = v; }},
      {"texture",
       [&](const std::string& v) {
         if (v == "soil")
           options.texture = image::soil_texture();
         else if (v != "blobs" && v != "sparse")
           throw InputError("--texture: found '" + v + "', expected blobs or soil");
       }},
      {"blob", [&](const std::string& v) { blob = v; }},
      {"density", [&](const std::string& v) { density = v; }},
      {"blur", [&](const std::string& v) { blur = v; }},
      {"bits", [&](const std::string& v) { bits = v; }},
  };
  const std::map<std::string, std::function<void()>> flags = {
      {"more", [&] { options.more = true; }}, {"map", [&] { part = map; }},     {"outliers", [&] { part = outliers; }},
      {"real", [&] { part = real; }},         {"speed", [&] { part = speed; }}, {"stages", [&] { part = stages; }},
      {"subsets", [&] { part = subsets; }},
  };
  for (int a = 1; a < argc; ++a) {
    const std::string text = argv[a], key = text.starts_with("--") ? text.substr(2) : "";
    if (key == "help") {
      std::printf("%smethods:\n", usage);
      for (const piv::PivMethod& method : piv::piv_methods())
        std::printf("  %-8s %s\n", method.name.c_str(), method.text.c_str());
      return 0;
    }
    if (const auto flag = flags.find(key); flag != flags.end()) {
      flag->second();
    } else if (const auto option = with_value.find(key); option != with_value.end()) {
      if (a + 1 == argc) throw InputError(text + ": found nothing after it, expected a value");
      option->second(argv[++a]);
    } else {
      throw InputError("found '" + text + "', expected one of the options of --help");
    }
  }
  if (!blob.empty()) options.texture.blob_diameter_px = number<double>("blob", blob);
  if (!density.empty()) options.texture.density_per_px = number<double>("density", density);
  if (!blur.empty()) options.texture.blur_px = number<double>("blur", blur);
  if (!bits.empty()) options.texture.bits = number<int>("bits", bits);
  if (options.side < 4 * options.margin || options.spacing < 1 || options.repeats < 1 || options.threads < 1 ||
      options.seeds.empty())
    throw InputError("found a side below four margins, or a count below 1, expected a field to measure");
  for (const std::string& method : methods) options.settings.push_back(parse_setting(method, base));
  return part(options);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "piv_table: %s\n", e.what());
  }
  return 2;
}
