#include "tests/bench/piv/bench.hpp"

#include <cstdio>
#include <ctime>
#include <fstream>
#include <thread>
#include <type_traits>

#include "pivnp/piv/methods.hpp"

namespace pivnp::bench {

double BenchOptions::slack() const {
  const bool usual = texture.kind == image::TextureKind::blobs && texture.blob_diameter_px == 3 && texture.density_per_px == 0.05 &&
                     texture.blur_px == 0;
  return usual ? 1 : 2;
}

void BenchOptions::print_head() const {
  std::printf("machine: %s, %u processors\nthreads %d, frames %d x %d px, %d bit, nodes %d px apart, margin %d px\n",
              machine().c_str(), std::thread::hardware_concurrency(), threads, side, side, texture.bits, spacing,
              margin);
  std::printf("texture %s, blobs %.1f px, %.3f per px, blur %.1f px; seeds", std::string(name_of(texture.kind)).c_str(),
              texture.blob_diameter_px, texture.density_per_px, texture.blur_px);
  for (const int seed : seeds) std::printf(" %d", seed);
  std::printf(cpu_clock ? "\nspeed by the process's time, not by the wall clock\n" : "\n");
}

double now(const BenchOptions& options) {
  if (!options.cpu_clock) return seconds_since({});
  timespec t{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

namespace {

void set(piv::PivOptions& options, const std::string& key, const std::string& value) {
  bool known = false;
  piv::PivOptions::fields(options, [&](const char* name, auto& field, const OptionInfo&) {
    if (key != name) return;
    known = true;
    using Field = std::remove_reference_t<decltype(field)>;
    try {
      if constexpr (std::is_same_v<Field, std::string>)
        field = value;
      else if constexpr (std::is_same_v<Field, bool>)
        field = value == "true" || value == "1";
      else if constexpr (std::is_same_v<Field, int>)
        field = std::stoi(value);
      else if constexpr (std::is_same_v<Field, double>)
        field = std::stod(value);
      else if constexpr (Choice<Field>)
        field = choice<Field>("--method: " + key, value);
      else
        known = false;
    } catch (const InputError&) {
      throw;
    } catch (const std::exception&) {
      throw InputError("--method: " + key + ": found '" + value + "', expected a number");
    }
  });
  if (!known) throw InputError("--method: found '" + key + "', expected an option of [piv]");
}

}  // namespace

Setting parse_setting(const std::string& text, const piv::PivOptions& base) {
  Setting setting{text, base};
  for (std::size_t from = 0, n = 0; from <= text.size(); ++n) {
    const std::size_t to = std::min(text.find(':', from), text.size());
    const std::string part = text.substr(from, to - from);
    const std::size_t equals = part.find('=');
    if (n == 0)
      setting.options.method = piv::piv_methods().at(part, "--method").name;
    else if (equals == std::string::npos)
      throw InputError("--method: found '" + part + "', expected KEY=VALUE");
    else
      set(setting.options, part.substr(0, equals), part.substr(equals + 1));
    from = to + 1;
  }
  return setting;
}

}  // namespace pivnp::bench
