#include "apps/study/pipeline/record/sources.hpp"

#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace fs = std::filesystem;

std::vector<io::FileIdentity> sources_of(const Case& c, const image::FrameSource* source, const io::VectorFiles* vectors,
                                         Progress& progress) {
  std::vector<io::FileIdentity> sources;
  const std::vector<fs::path> files = source ? source->files() : std::vector<fs::path>{};
  for (std::size_t k = 0; k < files.size(); ++k) {
    const bool one_each = files.size() == source->frames().size();
    sources.push_back(io::identity_of(files[k], one_each ? source->frames()[k].name : files[k].filename().string(), progress));
    progress.update("content of the frames", std::int64_t(k) + 1, std::int64_t(files.size()));
  }
  if (source)
    for (const auto& [name, mask] : c.masks)
      for (const std::string& file : {mask.image, mask.motion})
        if (!file.empty()) sources.push_back(io::identity_of(c.folder / file, file, progress));
  if (vectors)
    for (const fs::path& file : vectors->files())
      sources.push_back(io::identity_of(file, file.filename().string(), progress));
  return sources;
}

}  // namespace pivnp::app
