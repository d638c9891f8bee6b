// Names of fields and metrics as a reader expects them.
#pragma once

#include <string>
#include <string_view>

#include "pivnp/core/record/strain_note.hpp"

namespace pivnp::report {

/// displacement_rms -> "Displacement, RMS"; an unknown name keeps its words.
std::string metric_words(const std::string& name);

/// displacement_magnitude -> "displacement", strain_dev -> "deviatoric strain".
std::string field_words(std::string_view name);

/// The sentence that goes with every measured strain: gauge length and noise floor, or that it was not measured.
std::string strain_statement(const StrainNote& note, const std::string& length_unit);

}  // namespace pivnp::report
