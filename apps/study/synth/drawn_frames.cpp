#include "apps/study/synth/drawn_frames.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/version.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

const char* const note_name = "drawn.txt";
const std::string case_line = "case\n";

bool named_like_ours(const std::string& name) { return name.starts_with("frame_") && name.ends_with(".png"); }

std::vector<fs::path> frames_in(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (named_like_ours(entry.path().filename().string())) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (in.peek() != std::ifstream::traits_type::eof()) text << in.rdbuf();
  return text.str();
}

// All of it or nothing, whenever the program is killed.
void write_note(const fs::path& file, const std::string& text) {
  const fs::path temporary = file.string() + ".tmp";
  std::ofstream out(temporary, std::ios::binary);
  out << text << std::flush;
  if (!out) throw RunError(file.string() + ": cannot be written");
  out.close();
  fs::rename(temporary, file);
}

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

// Whether a note speaks of a frame: names it, or, where the drawing was not finished, would have come to draw it.
bool speaks_of(const std::string& note, const std::string& name) {
  if (note.find("\n" + name + " ") != std::string::npos) return true;
  const std::size_t head_end = note.find('\n');
  const bool unfinished = head_end != std::string::npos && note.compare(head_end + 1, case_line.size(), case_line) == 0;
  const std::string number = name.size() > 10 ? name.substr(6, name.size() - 10) : "";  // frame_NUMBER.png
  return unfinished && number.size() >= 5 && number.find_first_not_of("0123456789") == std::string::npos;
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
  const std::string note = text_of(folder_ / note_name);
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
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) throw RunError(folder_.string() + ": " + failed.message());
  const std::vector<fs::path> frames = frames_in(folder_);
  const std::string note = text_of(folder_ / note_name);
  for (const fs::path& frame : frames)
    if (!speaks_of(note, frame.filename().string()))
      throw InputError(frame.string() + ": there before, and not drawn by this program (" +
                       (note.empty() ? folder_.string() + " holds no " + note_name
                                     : (folder_ / note_name).string() + " does not name it") +
                       "); expected a folder without such frames: choose another --out, or move them away");
  write_note(folder_ / note_name, head() + case_line + case_text_);  // none is finished yet
  for (const fs::path& frame : frames) fs::remove(frame);
}

void DrawnFrames::finish() const {
  std::string note = head();
  for (int k = 0; k < count_; ++k) note += line_of(io::identity_of(folder_ / name(k), name(k)));
  write_note(folder_ / note_name, note + case_line + case_text_);
}

}  // namespace pivnp::app
