#include "apps/study/pipeline/measure/imported_vectors.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/np/options.hpp"

namespace pivnp::app {

namespace fs = std::filesystem;

bool has_rate(const Case& c, const image::FrameSource* source) {
  return source ? source->has_rate() : c.vectors && c.vectors->rate_hz;
}

void require_time_and_scale(const Case& c, const Setting& setting, const image::FrameSource* source) {
  if (!has_rate(c, source))
    throw InputError(of_file(c) + (source ? ": frames.rate_hz" : ": vectors.rate_hz") +
                     ": missing, expected the frames per second: a simulation runs in seconds");
  if (setting.camera.length_unit() == "px")
    throw InputError(of_file(c) + ": camera.metres_per_pixel: missing, expected the scale of the frames: a simulation runs "
                                  "in metres");
}

std::unique_ptr<io::VectorFiles> case_vectors(Case& c, const image::FrameSource* source) {
  if (!c.vectors) return nullptr;
  c.vectors->path = fs::absolute(c.folder / c.vectors->path).lexically_normal().string();
  std::optional<double> rate = c.vectors->rate_hz;
  if (source && source->has_rate() && source->frames().size() > 1)
    rate = 1 / (source->frames()[1].time - source->frames()[0].time);
  auto vectors = std::make_unique<io::VectorFiles>(*c.vectors, c.folder, rate);
  const std::size_t frames = vectors->frame_names().size();
  if (source && source->frames().size() != frames)
    throw InputError("frames.path: found " + std::to_string(source->frames().size()) + " frames, expected " +
                     std::to_string(frames) + ", as vectors.path has " + std::to_string(frames - 1) + " files");
  const np::DriftScheme drift = c.np.value_or(np::NpOptions{}).drift;
  if (!source && drift != np::DriftScheme::none)
    throw InputError("np.drift: found \"" + std::string(name_of(drift)) +
                     "\", expected \"none\", as there are no frames to correlate directly");
  return vectors;
}

std::vector<Frame> frames_of(const io::VectorFiles& vectors, const Case& c) {
  std::vector<Frame> frames;
  const double rate = c.vectors->rate_hz.value_or(1.0);
  for (const std::string& name : vectors.frame_names()) frames.push_back({name, double(frames.size()) / rate});
  return frames;
}

VectorField imported_pair(const io::VectorFiles& vectors, const Setting& setting, std::size_t index) {
  VectorField field = vectors.read(index);
  const double scale = setting.grid.spacing.x() / field.grid.spacing.x();  // 1 for lengths of the world
  field.grid = setting.grid;
  const MaskView mask = setting.mask.view();
  const std::size_t row = std::size_t(setting.grid.nx);
  for (std::size_t n = 0; n < field.status.size(); ++n) {
    for (float& d : field.displacement[n]) d = float(scale * double(d));
    for (float& v : field.cov[n]) v = float(scale * scale * double(v));
    if (mask.data == nullptr) continue;
    const Vec2 px = setting.camera.to_pixel(setting.grid.position(int(n % row), int(n / row)));
    const int c = int(std::lround(px.x())), r = int(std::lround(px.y()));
    if (c >= 0 && r >= 0 && c < mask.width && r < mask.height && mask.usable(c, r)) continue;
    field.status[n] = VectorStatus::masked;
    field.displacement[n].fill(std::numeric_limits<float>::quiet_NaN());
  }
  return field;
}

void import_vectors(const io::VectorFiles& vectors, const Setting& setting, io::RecordWriter& writer, Progress& progress) {
  const io::StageState done = writer.stage("piv");
  if (done.complete) return;
  const std::size_t pairs = vectors.files().size();
  for (std::size_t k = done.items; k < pairs; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    writer.add_pair(imported_pair(vectors, setting, k));
    if (writer.segment_full("piv")) writer.close_segment("piv", {});
    progress.update("vectors", std::int64_t(k) + 1, std::int64_t(pairs));
  }
  writer.end_stage("piv", nullptr);
}

std::vector<std::string> remarks_on_import(const io::VectorFiles& vectors, const Case& c) {
  std::vector<std::string> remarks;
  std::string measured = "The vectors were measured by another program (";
  measured += c.vectors->format;
  measured += "): nothing here validated them, and the strains' gauge length does not hold its window.";
  remarks.push_back(std::move(measured));
  if (!vectors.states_uncertainty())
    remarks.emplace_back("The files of the vectors state no uncertainty: that of the particles is not known.");
  return remarks;
}

}  // namespace pivnp::app
