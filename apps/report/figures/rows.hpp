// The rows of the figures' list, by their source files in this folder.
#pragma once

#include "apps/report/figures/figure.hpp"

namespace pivnp::report {

FigureRow summary_row();
FigureRow fields_row();
FigureRow point_curves_row();
FigureRow point_pressures_row();
FigureRow point_strains_row();
FigureRow differences_row();
FigureRow outlines_row();
FigureRow decomposition_row();
FigureRow histories_row();
FigureRow camera_motion_row();
FigureRow quality_row();
FigureRow vectors_row();
FigureRow uncertainty_row();
FigureRow geometry_row();
FigureRow bands_row();
FigureRow lines_row();
FigureRow runs_row();
FigureRow energy_row();
FigureRow reactions_row();

}  // namespace pivnp::report
