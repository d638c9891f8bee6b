#include "pivnp/io/files/file_identity.hpp"

#include <algorithm>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/hash.hpp"
#include "pivnp/core/regular_file.hpp"

namespace pivnp::io {

FileIdentity identity_of(const std::filesystem::path& file, std::string name, const Progress& progress) {
  FileIdentity identity{std::move(name), 0, ""};
  std::ifstream in = open_regular_file(file);
  Hash64 hash;
  std::vector<char> block(std::size_t{1} << 18);
  while (in) {
    if (progress.stop_requested()) throw Interrupted();
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add(block.data(), static_cast<std::size_t>(in.gcount()));
    identity.size += static_cast<std::uint64_t>(in.gcount());
  }
  if (!in.eof()) throw InputError(file.string() + ": cannot be read");
  identity.hash = hexadecimal(hash.value());
  return identity;
}

std::string first_difference(const std::vector<FileIdentity>& there, const std::vector<FileIdentity>& now) {
  for (std::size_t k = 0; k < std::min(there.size(), now.size()); ++k) {
    const FileIdentity &a = there[k], &b = now[k];
    if (a.name != b.name) return "'" + a.name + "' there, '" + b.name + "' in its place now";
    if (a.size != b.size)
      return "'" + a.name + "' has " + std::to_string(a.size) + " bytes there, " + std::to_string(b.size) + " now";
    if (a.hash != b.hash) return "'" + a.name + "' has other content now";
  }
  if (there.size() > now.size()) return "'" + there[now.size()].name + "' is not there any more";
  if (there.size() < now.size()) return "'" + now[there.size()].name + "' is new";
  return "";
}

}  // namespace pivnp::io
