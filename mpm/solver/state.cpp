#include "mpm/solver/state.hpp"

#include <cstring>
#include <string_view>

#include "mpm/state/particle_fields.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr char magic[8] = {'p', 'i', 'v', 'm', 'p', 'm', '1', '9'};

class Writer {
 public:
  template <class T>
  void value(const T& v) {
    raw(&v, sizeof v);
  }
  template <class T, class A>
  void array(const std::vector<T, A>& a) {
    value(std::uint64_t(a.size()));
    raw(a.data(), a.size() * sizeof(T));
  }
  template <class T>
  void list(const std::vector<T>& a) {
    array(a);
  }
  void name(std::string_view n) { list(std::vector<char>(n.begin(), n.end())); }
  std::vector<std::byte> bytes;

 private:
  void raw(const void* data, std::size_t n) {
    if (n == 0) return;
    const std::size_t at = bytes.size();
    bytes.resize(at + n);
    std::memcpy(bytes.data() + at, data, n);
  }
};

class Reader {
 public:
  explicit Reader(const std::vector<std::byte>& b) : bytes_(b) {}
  template <class T>
  void value(T& v) {
    raw(&v, sizeof v);
  }
  template <class T, class A>
  void array(std::vector<T, A>& a) {
    std::uint64_t n = 0;
    value(n);
    if (n != a.size()) throw InputError("checkpoint: it holds another number of particles than the scene");
    raw(a.data(), a.size() * sizeof(T));
  }
  /// Of any length.
  template <class T>
  void list(std::vector<T>& a) {
    std::uint64_t n = 0;
    value(n);
    if (n > (bytes_.size() - at_) / sizeof(T)) throw InputError("checkpoint: it ends too early");
    a.resize(n);
    raw(a.data(), n * sizeof(T));
  }
  void name(std::string_view n) {
    std::vector<char> found;
    list(found);
    if (std::string_view(found.data(), found.size()) != n)
      throw InputError("checkpoint: it holds another history than the laws of the scene");
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  void raw(void* data, std::size_t n) {
    if (n > bytes_.size() - at_) throw InputError("checkpoint: it ends too early");
    if (n > 0) std::memcpy(data, bytes_.data() + at_, n);
    at_ += n;
  }
  const std::vector<std::byte>& bytes_;
  std::size_t at_ = 0;
};

template <class Archive, class State>
void visit(Archive& a, State& s) {
  auto& p = s.particles;
  for_each_particle_field([&](const ParticleField& field, const auto&... column) {
    if (field.state) (a.array(p.*column.values), ...);
  });
  for (const auto& variable : p.history.variables) a.name(variable.is.name);
  for (auto& values : p.history.numbers) a.array(values);
  for (auto& values : p.history.flags) a.array(values);
  a.value(p.density);
  a.list(s.ended);
  a.value(s.balance);
  a.value(s.time);
  a.value(s.last_step);
  a.value(s.fastest);
  a.value(s.wave_speed);
  a.value(s.own_frequency2);
  a.value(s.diffusivity);
  a.value(s.peak_kinetic);
  a.value(s.calm_since);
  a.value(s.calm_looks);
  a.value(s.peak_excess);
  a.value(s.calm_excess);
  a.value(s.at_rest);
  a.value(s.far);
  a.list(s.pressure_change);
  a.list(s.touched);
  a.list(s.water_inertia);
  a.array(s.body_motion);
  a.array(s.impulses);
  a.array(s.sleep.asleep);
  for (auto* of_block : {&s.sleep.quiet_since, &s.sleep.speed, &s.sleep.foregone, &s.sleep.pressure}) a.array(*of_block);
  a.value(s.sleep.held_back);
  a.value(s.sleep.energy);
  a.value(s.sleep.skipped);
  a.value(s.sleep.all);
  a.list(s.heat.band_of);
  a.list(s.heat.bands);
  a.list(s.heat.turning);
  a.value(s.heat.since);
  a.value(s.heat.darcy);
  a.value(s.heat.crossing);
  a.value(s.heat.steps);
  a.value(s.heat.passes);
  a.value(s.steps);
  a.value(s.not_stepped);
  a.value(s.since_sort);
}

}  // namespace

std::vector<std::byte> to_bytes(const SolverState& state) {
  Writer w;
  w.value(magic);
  visit(w, state);
  return std::move(w.bytes);
}

void from_bytes(const std::vector<std::byte>& bytes, SolverState& state) {
  Reader r(bytes);
  char found[8];
  r.value(found);
  if (std::memcmp(found, magic, sizeof magic) != 0) throw InputError("checkpoint: not one of this solver");
  SolverState read = state;
  visit(r, read);
  if (!r.at_end()) throw InputError("checkpoint: it is longer than the scene's state");
  state = std::move(read);
}

}  // namespace pivnp::mpm
