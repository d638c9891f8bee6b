#include "apps/study/synth/drawn_frames.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <utility>

#include "apps/plot/files.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/core/version.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

const char *const note_name = "drawn.txt", *const journal_name = "drawing.txt";
const std::string case_line = "case\n";

bool named_like_ours(const std::string& name) { return name.starts_with("frame_") && name.ends_with(".png"); }

std::vector<fs::path> frames_in(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (named_like_ours(entry.path().filename().string())) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

std::string note_of(const fs::path& file) { return fs::exists(file) ? text_of_file(file) : ""; }

// Wherever the frames come to lie, and whether or not the case speaks of them, they are drawn alike.
std::string drawn_from(Case c) {
  if (!c.frames) c.frames = image::FrameOptions{};
  c.frames->path.clear();
  if (!c.frames->rate_hz) c.frames->rate_hz = 1.0;
  // What is measured of them, simulated beside them and reported is no part of the drawing.
  Case drawn;
  drawn.frames = c.frames;
  drawn.camera = c.camera;
  drawn.grid = c.grid;
  drawn.regions = c.regions;
  drawn.masks = c.masks;
  drawn.synth = c.synth;
  drawn.texture = c.texture;
  drawn.synth_camera = c.synth_camera;
  if (c.synth->motion == SynthMotion::mpm) {  // carried by a simulation of its own, in the scene of the case
    drawn.synth_materials = c.synth_materials;
    drawn.synth_mpm = c.synth_mpm;
    drawn.initial = c.initial;
    drawn.boundaries = c.boundaries;
    drawn.bodies = c.bodies;
    drawn.contacts = c.contacts;
    drawn.centrifuge = c.centrifuge;
    drawn.water = c.water;
    drawn.heat = c.heat;
    drawn.piv = c.piv;  // whose window the spacing of the nodes is a part of
    if (c.mpm) drawn.mpm.emplace().domain_m = c.mpm->domain_m;
  }
  return write_case(drawn);
}

std::string line_of(const io::FileIdentity& file) {
  return file.name + " " + std::to_string(file.size) + " " + file.hash + "\n";
}

}  // namespace

DrawnFrames::DrawnFrames(const Case& c, fs::path folder)
    : folder_(std::move(folder)), count_(c.synth->frames), case_text_(drawn_from(c)) {}

std::string DrawnFrames::name(int frame) {
  char text[32];
  std::snprintf(text, sizeof text, "frame_%05d.png", frame);
  return text;
}

std::string DrawnFrames::head() const {
  return "frames drawn by pivnp " + build_info().version + " (" + build_info().commit + ")\n";
}

bool DrawnFrames::complete() const {
  const std::string note = note_of(folder_ / note_name);
  if (note.empty()) return false;
  const std::string advice = "; run without --resume to draw them again";
  if (!note.starts_with(head()))
    throw InputError((folder_ / note_name).string() + ": another program drew these frames: '" +
                     note.substr(0, note.find('\n')) + "'" + advice);
  const std::size_t at = note.find("\n" + case_line);
  const std::string there = at == std::string::npos ? "" : note.substr(at + 1 + case_line.size());
  if (const std::string difference = io::difference_of_cases(there, case_text_); !difference.empty())
    throw InputError((folder_ / note_name).string() + ": these frames were drawn from another case, " + difference +
                     advice);
  std::string now = head();
  for (const fs::path& frame : frames_in(folder_)) now += line_of(io::identity_of(frame, frame.filename().string()));
  return now + case_line + case_text_ == note && frames_in(folder_).size() == std::size_t(count_);
}

void DrawnFrames::begin() const {
  fs::create_directories(folder_);
  const std::vector<fs::path> frames = frames_in(folder_);
  const std::string note = note_of(folder_ / note_name);
  std::string journal = "\n";
  journal += note_of(folder_ / journal_name);
  const auto named = [&](const std::string& name) {
    return note.find("\n" + name + " ") != std::string::npos || journal.find("\n" + name + "\n") != std::string::npos;
  };
  for (const fs::path& frame : frames)
    if (!named(frame.filename().string()))
      throw InputError(frame.string() + ": there before, and not drawn by this program (" +
                       (note.empty() ? folder_.string() + " holds no " + note_name
                                     : (folder_ / note_name).string() + " does not name it") +
                       "); expected a folder without such frames: choose another --out, or move them away");
  std::string old;
  for (const fs::path& frame : frames) old += frame.filename().string() + "\n";
  plot::write_file(folder_ / journal_name, old);
  plot::write_file(folder_ / note_name, head() + case_line + case_text_);  // none is finished yet
  for (const fs::path& frame : frames) fs::remove(frame);
  fs::remove(folder_ / journal_name);
}

void DrawnFrames::draws(int frame) const {
  std::ofstream out(folder_ / journal_name, std::ios::binary | std::ios::app);
  out << name(frame) << '\n' << std::flush;
  if (!out) throw RunError((folder_ / journal_name).string() + ": cannot be written");
}

void DrawnFrames::finish() const {
  std::string note = head();
  for (int k = 0; k < count_; ++k) note += line_of(io::identity_of(folder_ / name(k), name(k)));
  plot::write_file(folder_ / note_name, note + case_line + case_text_);
  fs::remove(folder_ / journal_name);
}

}  // namespace pivnp::app
