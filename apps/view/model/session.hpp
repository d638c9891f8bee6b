// What is open in the window: frames, the text of a case, and the steps back from each change to it. No screen is needed.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/view/model/frames.hpp"
#include "apps/view/model/shapes.hpp"
#include "pivnp/image/camera/camera.hpp"

namespace pivnp::view {

/// What a path turned out to be. Safe to make in any thread, then taken by a session.
struct Opened {
  std::filesystem::path record;          // not empty: a record, which RecordLook opens
  std::string text;                      // of the case, or of a first case for the frames
  std::filesystem::path file;            // of the case; empty: not saved yet
  std::filesystem::path folder;          // what paths in the case are relative to
  std::shared_ptr<SharedFrames> frames;  // nullptr: the case has none, or they are not there
  std::string complaint;                 // why not; empty: none
};
/// A record, a case (file, or folder with case.toml), a folder of images, a video, an image, a pattern. Throws InputError with the
/// command line's words.
Opened open_path(const std::filesystem::path& path);

/// One fault of the text.
struct Fault {
  int line = 0;      // 0: of no line
  std::string text;  // with its place, as the command line says it
};

class Session {
 public:
  void take(Opened opened);

  bool empty() const { return !frames_ && text_.empty(); }
  const std::string& text() const { return text_; }
  const std::filesystem::path& file() const { return file_; }
  const std::filesystem::path& folder() const { return folder_; }
  const std::shared_ptr<SharedFrames>& frames() const { return frames_; }
  const std::string& complaint() const { return complaint_; }  // about the frames
  bool modified() const { return text_ != saved_; }

  /// The case that the text is; nullptr while it has faults.
  const app::Case* valid() const { return case_ ? &*case_ : nullptr; }
  /// All that is wrong with the text, by line.
  const std::vector<Fault>& faults() const { return faults_; }
  /// The case as far as it can be read, lengths in the text's unit; that of the last text which was TOML.
  const app::Case& seen() const { return seen_; }
  const image::Camera& camera() const { return camera_; }  // of seen()
  const std::vector<Shape>& shapes() const { return shapes_; }

  /// Replaces the text. `typing`: steps that follow each other become one step of undo().
  void set_text(const std::string& text, bool typing = false);
  bool can_undo() const { return at_ > 0; }
  bool can_redo() const { return at_ + 1 < steps_.size(); }
  void undo();
  void redo();

  // Each of these is one change of the text. They throw InputError, and change nothing, where it cannot be made.
  void set_key(const app::KeyPath& key, const std::string& toml);  // an empty value removes it
  /// Returns the name that it was given: "soil", "soil_2" ...
  std::string add_shape(ShapeKind kind, const std::vector<Vec2>& points_px, const std::string& name = {});
  void set_points(std::size_t shape, const std::vector<Vec2>& points_px);
  void remove_shape(std::size_t shape);
  void copy_shape(std::size_t shape, ShapeKind to);
  void rename_shape(std::size_t shape, const std::string& name);
  /// Two places that are `length` apart, in the unit of the text. The first scale leaves all shapes where they are in the image.
  void set_scale(const Vec2& one_px, const Vec2& other_px, double length);
  void set_origin(const Vec2& px);
  /// The x axis runs from the first place to the second; needs a scale.
  void set_horizontal(const Vec2& from_px, const Vec2& to_px);

  /// Frames that the text names, if they are others than those that are open: to be opened by open_frames_of().
  bool frames_stale() const;
  /// A copy to open them with, in any thread.
  std::function<Opened()> reopening() const;
  void take_frames(Opened opened);

  /// Writes the text; paths to frames below the file's folder become relative. Throws RunError.
  void save(const std::filesystem::path& file);

 private:
  void read_text();
  void change(std::string text, bool typing = false);
  std::string label() const { return file_.empty() ? "case" : file_.string(); }
  std::string free_name(const std::string& section, const std::string& wanted) const;
  void require_text() const;

  std::string text_, saved_;
  std::filesystem::path file_, folder_ = ".";
  std::shared_ptr<SharedFrames> frames_;
  std::string frames_opened_, complaint_;
  std::optional<app::Case> case_;
  app::Case seen_;
  std::vector<Fault> faults_;
  image::Camera camera_;
  std::vector<Shape> shapes_;
  std::vector<std::string> steps_;  // texts; at_: the present one
  std::size_t at_ = 0;
  bool typing_ = false;
};

}  // namespace pivnp::view
