// Tracker's state as bytes. Layout: Header, then per particle x (2), F (4, row-major), cov (3), bias (2), cov_F (3), end (1), all double,
// then status and end_reason, one byte each, arrays one after the other; then the checksum of all that, 64 bits.
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "pivnp/core/error.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::np {

namespace {

constexpr char magic[8] = {'P', 'I', 'V', 'N', 'P', 'n', 'p', '\0'};
constexpr std::uint32_t version = 3;
constexpr std::uint32_t byte_order = 0x01020304;
constexpr std::size_t bytes_per_particle = 15 * sizeof(double) + 2;

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t byte_order;
  std::uint64_t count;
  std::uint64_t particles;  // checksum of what the particles are
  double time;
  double error_correlation;
  std::uint8_t centre_gradient;
  std::uint8_t cov_known;
  std::uint8_t unused[2];
  std::uint32_t shape;  // checksum of its name
  std::int64_t steps;   // taken
};
static_assert(sizeof(Header) == 64);

// FNV-1a, 64 bits: finds damage and mix-ups, not malice.
std::uint64_t checksum(const void* data, std::size_t size, std::uint64_t hash = 0xcbf29ce484222325u) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t k = 0; k < size; ++k) hash = (hash ^ bytes[k]) * 0x100000001b3u;
  return hash;
}

std::uint64_t identity(const ParticleSet& set) {
  std::uint64_t hash = checksum(set.id.data(), set.id.size() * sizeof(set.id[0]));
  hash = checksum(set.label.data(), set.label.size() * sizeof(set.label[0]), hash);
  hash = checksum(set.born.data(), set.born.size() * sizeof(set.born[0]), hash);
  return checksum(set.x0.data(), set.x0.size() * sizeof(set.x0[0]), hash);
}

std::uint32_t code_of(ShapeFunctions shape) {
  const std::string_view name = name_of(shape);
  return std::uint32_t(checksum(name.data(), name.size()));
}

class Writer {
 public:
  explicit Writer(std::size_t size) { bytes_.reserve(size); }
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof(T));
  }
  std::vector<std::byte> finish() {
    put(checksum(bytes_.data(), bytes_.size()));
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
};

class Reader {
 public:
  explicit Reader(const std::vector<std::byte>& bytes) : at_(bytes.data()) {}
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }

 private:
  const std::byte* at_;
};

[[noreturn]] void refuse(const std::string& found, const std::string& expected) {
  throw InputError("np: saved state: found " + found + ", expected " + expected);
}

// Everything that can be known before the arrays are read.
Header checked_header(const std::vector<std::byte>& bytes) {
  if (bytes.size() < sizeof(Header) + 8)
    refuse(std::to_string(bytes.size()) + " bytes", "at least " + std::to_string(sizeof(Header) + 8));
  Header h;
  std::memcpy(&h, bytes.data(), sizeof h);
  if (std::memcmp(h.magic, magic, sizeof magic) != 0) refuse("other data", "a state of numerical particles");
  if (h.byte_order != byte_order) refuse("another byte order", "this machine's");
  if (h.version != version) refuse("version " + std::to_string(h.version), "version " + std::to_string(version));
  const std::size_t body = bytes.size() - sizeof(Header) - 8;
  if (body % bytes_per_particle != 0 || body / bytes_per_particle != h.count)
    refuse(std::to_string(bytes.size()) + " bytes", "a header, " + std::to_string(h.count) + " particles of " +
                                                        std::to_string(bytes_per_particle) + " bytes and a checksum");
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + bytes.size() - 8, 8);
  if (sum != checksum(bytes.data(), bytes.size() - 8)) refuse("a wrong checksum", "undamaged bytes");
  return h;
}

}  // namespace

std::vector<std::byte> Tracker::save() const {
  Header h{};
  std::memcpy(h.magic, magic, sizeof magic);
  h.version = version;
  h.byte_order = byte_order;
  h.count = x_.size();
  h.particles = identity(particles_);
  h.time = time_;
  h.error_correlation = options_.error_correlation;
  h.centre_gradient = options_.gradient == GradientPlace::element;
  h.cov_known = cov_known_;
  h.shape = code_of(options_.shape);
  h.steps = steps_;
  Writer out(sizeof(Header) + x_.size() * bytes_per_particle + 8);
  out.put(h);
  for (const Vec2& x : x_)
    for (int k = 0; k < 2; ++k) out.put(x[k]);
  for (const Mat2& F : F_)
    for (int k = 0; k < 4; ++k) out.put(F(k / 2, k % 2));
  for (const auto& c : cov_) out.put(c);
  for (const Vec2& b : bias_)
    for (int k = 0; k < 2; ++k) out.put(b[k]);
  for (const auto& c : cov_F_) out.put(c);
  for (const double end : particles_.end) out.put(end);
  for (const ParticleStatus s : status_) out.put(s);
  for (const EndReason r : particles_.end_reason) out.put(r);
  return out.finish();
}

void Tracker::load(const std::vector<std::byte>& bytes) {
  const Header h = checked_header(bytes);
  if (h.count != x_.size()) refuse(std::to_string(h.count) + " particles", std::to_string(x_.size()));
  if (h.particles != identity(particles_)) refuse("other particles", "those of this run");
  if (bool(h.centre_gradient) != (options_.gradient == GradientPlace::element))
    refuse("gradient " + std::string(h.centre_gradient ? "element" : "particle"), std::string(name_of(options_.gradient)));
  if (h.shape != code_of(options_.shape)) refuse("other shape functions", std::string(name_of(options_.shape)));
  if (h.error_correlation != options_.error_correlation)
    refuse("error_correlation " + std::to_string(h.error_correlation), std::to_string(options_.error_correlation));

  Tracker next = *this;  // so that a refusal below leaves this one untouched
  Reader in(bytes);
  in.get<Header>();
  next.time_ = h.time;
  next.cov_known_ = h.cov_known != 0;
  next.steps_ = std::int32_t(h.steps);
  for (Vec2& x : next.x_)
    for (int k = 0; k < 2; ++k) x[k] = in.get<double>();
  for (Mat2& F : next.F_)
    for (int k = 0; k < 4; ++k) F(k / 2, k % 2) = in.get<double>();
  for (auto& c : next.cov_) c = in.get<std::array<double, 3>>();
  for (Vec2& b : next.bias_)
    for (int k = 0; k < 2; ++k) b[k] = in.get<double>();
  for (auto& c : next.cov_F_) c = in.get<std::array<double, 3>>();
  for (double& end : next.particles_.end) end = in.get<double>();
  for (ParticleStatus& s : next.status_) {
    const auto code = in.get<std::uint8_t>();
    if (code > std::uint8_t(ParticleStatus::ended)) refuse("status " + std::to_string(code), "0 to 3");
    s = ParticleStatus(code);
  }
  for (EndReason& r : next.particles_.end_reason) {
    r = EndReason(in.get<std::uint8_t>());
    if (find(r) == nullptr) refuse("end reason " + std::to_string(int(r)), "one of those in docs/format.md");
  }
  *this = std::move(next);
}

}  // namespace pivnp::np
