// Particles through many frames, written while they are tracked: how fast, in how much memory, against the disk's own
// speed in the same run.
#pragma once

#include <filesystem>

/// A folder is made in `directory` and removed. `side`: elements a side, 4 particles each. Returns the exit code: 1 where
/// the record is written at less than half the disk's own speed, or memory is more than a few frames.
int stream(const std::filesystem::path& directory, int side, int frames);
