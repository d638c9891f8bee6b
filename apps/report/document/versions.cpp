#include "apps/report/document/versions.hpp"

#include "apps/plot/canvas.hpp"
#include "pivnp/core/version.hpp"

namespace pivnp::report {

std::string program_version() { return build_info().version; }

std::string versions(const BuildInfo& record) {
  const auto words = [](const BuildInfo& b) {
    return "pivnp " + b.version + " (commit " + b.commit + ") with " + b.libraries;
  };
  const BuildInfo& own = build_info();
  const bool known = !record.version.empty();
  const bool same = record.commit == own.commit && record.version == own.version && record.libraries == own.libraries;
  std::string text;
  if (known && !same) text = "The record was written by " + words(record) + ". ";
  text += (known && same ? "Record and report were written by " : "This report was written by ") + words(own);
  return text + "; figures are drawn by " + plot::drawing_libraries() + ".";
}

}  // namespace pivnp::report
