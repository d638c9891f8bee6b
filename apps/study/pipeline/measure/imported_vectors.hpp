// Vectors of other programs in place of the PIV stage: from their files to the world, pair by pair into the record.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/io/imports/import_vectors.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// Opens the files of [vectors], and fills in c.vectors with their full path. nullptr if the case has none. `source`: the
/// frames that the case names beside them, nullptr without. Throws as io::VectorFiles does, and InputError where the
/// frames are not as many as the pairs have, or np.drift needs frames that are not there.
std::unique_ptr<io::VectorFiles> case_vectors(Case& c, const image::FrameSource* source);

/// The frames of those pairs, where the case names none itself.
std::vector<Frame> frames_of(const io::VectorFiles& vectors, const Case& c);

/// True if their times are in s.
bool has_rate(const Case& c, const image::FrameSource* source);

/// Before anything is computed: a simulation beside a measurement needs the frames' rate (their times are the
/// simulation's) and their scale. Throws InputError naming the key.
void require_time_and_scale(const Case& c, const Setting& setting, const image::FrameSource* source);

/// One pair in the world; nodes under a mask are masked.
VectorField imported_pair(const io::VectorFiles& vectors, const Setting& setting, std::size_t index);

/// Reads every pair that `writer` does not hold yet.
void import_vectors(const io::VectorFiles& vectors, const Setting& setting, io::RecordWriter& writer, Progress& progress);

/// What the files leave open, one sentence each.
std::vector<std::string> remarks_on_import(const io::VectorFiles& vectors, const Case& c);

}  // namespace pivnp::app
