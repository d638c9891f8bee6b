// The figures of a report. Each returns nothing where the content has nothing to show.
#pragma once

#include <optional>
#include <vector>

#include "apps/report/content/analysis.hpp"
#include "apps/report/content/content.hpp"
#include "apps/report/figures/figure.hpp"

namespace pivnp::report {

constexpr double figure_width_mm = 170;   // the measure of an A4 page
constexpr double figure_height_mm = 205;  // at most, so that a caption fits below

/// "vectors_1", "vectors_2" ...: a picture under the vectors of the pair that starts (or ends) with it.
std::vector<Figure> vector_figures(const Content& content, const std::vector<PairQuality>& pairs);

/// "displacement", "deviatoric_strain" ...: one field, a row a time, a column a side and one for the difference.
std::optional<Figure> field_figure(const Content& content, const std::string& field, const std::vector<double>& times,
                                   bool central);

/// "histories": displacement of material points against time, and where they are.
std::optional<Figure> history_figure(const Content& content, const std::vector<Vec2>& points);

/// "difference": RMS difference against time beside the measurement's own uncertainty.
std::optional<Figure> difference_figure(const Content& content, const DifferenceHistory& history);

/// "outline": final outlines overlaid.
std::optional<Figure> outline_figure(const Content& content);

/// "decomposition": coefficients of both sides and the band within which they agree.
std::optional<Figure> decomposition_figure(const Content& content);

/// "curves": the two histories of a comparison of curves, from its tables history_first and history_second.
std::optional<Figure> compared_curves_figure(const Content& content);

/// "quality": status and score of the vectors, pair by pair.
std::optional<Figure> quality_figure(const Content& content, const std::vector<PairQuality>& pairs);

/// "energy": the balance of the simulation.
std::optional<Figure> energy_figure(const Content& content);

}  // namespace pivnp::report
