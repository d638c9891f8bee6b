// Names of fields, metrics and frames as a reader expects them.
#pragma once

#include <string>
#include <string_view>

#include "apps/report/content/content.hpp"
#include "apps/report/words/data_sets.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

/// displacement_rms -> "displacement, RMS"; an unknown name keeps its words.
std::string metric_words(const std::string& name, const DataSetNames& names);

/// The label of a computed field, "deviatoric strain" of strain_dev; an unknown name keeps its words.
std::string field_words(std::string_view name);

/// The unit of a field in those of the content: "m/s²".
std::string field_unit(const DerivedField& field, const Content& content);

/// The frame's name, or "frame 7".
std::string frame_words(const Content& content, int frame);

/// The sentence that goes with every measured strain: gauge length and noise floor (the record's own, else that of the
/// comparison), or that it was not measured. Empty where the content has no note.
std::string strain_statement(const Content& content);

}  // namespace pivnp::report
