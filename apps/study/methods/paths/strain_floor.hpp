// What is stated with the measured strains of a run: gauge length and noise floor.
#pragma once

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/record/strain_note.hpp"

namespace pivnp::app {

/// Gauge length: the cells that np.shape spans times the spacing, plus the PIV's window (the virtual strain gauge of
/// the iDICs guide, 2018: span of the data points plus subset); that of other programs' vectors is not known, and is
/// left out.
/// Noise floor: RMS of the strains of particles that start in np.still_zone_px or _m and live, at the last frame; or,
/// with np.still_frames = n, of all particles at frame n - 1, times sqrt((frames - 1)/(n - 1)) for strain_dev and
/// strain_vol (random errors of the steps) and times that number itself for strain_dev_path (a sum of norms). Else it
/// is "not measured", as it is where no particle of the zone lives to the end.
StrainNote strain_note(const Case& c, const Setting& setting, const MotionSource& motion, bool central);

/// Before anything is measured: throws InputError for a zone given twice or without any particle, a zone and still
/// frames both, fewer than two still frames or more than there are.
void check_strain_floor(const Case& c, const Setting& setting, std::size_t frames);

}  // namespace pivnp::app
