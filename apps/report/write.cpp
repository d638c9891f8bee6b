#include "apps/report/write.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "apps/plot/canvas.hpp"
#include "apps/plot/files.hpp"
#include "apps/report/content/content.hpp"
#include "apps/report/document/html.hpp"
#include "apps/report/document/pdf.hpp"
#include "apps/report/document/sections.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

namespace {

constexpr double print_dpi = 300;

// Names that a report gives its figures.
bool is_figure(const std::string& name) {
  static const std::set<std::string> fixed = {"displacement", "deviatoric_strain", "histories", "difference", "outline",
                                              "decomposition", "curves",           "quality",   "energy"};
  if (fixed.count(name) > 0) return true;
  const std::string vectors = "vectors_";
  if (name.starts_with(vectors))
    return name.size() > vectors.size() && name.find_first_not_of("0123456789", vectors.size()) == std::string::npos;
  const auto& fields = derived_fields();
  return std::any_of(fields.begin(), fields.end(), [&](const DerivedField& f) { return f.name == name; });
}

// Figures of an earlier report that this one does not have would be taken for its own.
void remove_stale(const std::filesystem::path& folder, const std::map<std::string, std::string>& kept) {
  std::error_code error;
  std::vector<std::filesystem::path> stale;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().stem().string(), kind = entry.path().extension().string();
    if ((kind == ".png" || kind == ".svg") && is_figure(name) && kept.count(name) == 0) stale.push_back(entry.path());
  }
  for (const auto& file : stale) std::filesystem::remove(file, error);
}

std::string bytes_of(const QByteArray& bytes) { return std::string(bytes.constData(), std::size_t(bytes.size())); }

}  // namespace

void write_content(const ReportOptions& options, const Content& content, const std::filesystem::path& directory) {
  start_qt();
  const std::filesystem::path figures = directory / "figures";
  make_folder(figures);
  const Document document = make_document(options, content);

  std::map<std::string, std::string> png;
  for (const Block& block : document.blocks)
    if (const auto* figure = std::get_if<Figure>(&block)) {
      std::string& bytes = png[figure->name];
      bytes = bytes_of(figure->sheet->png(print_dpi));
      write_file(figures / (figure->name + ".png"), bytes);
      write_file(figures / (figure->name + ".svg"), bytes_of(figure->sheet->svg()));
      // A photograph at print resolution would make the page heavy.
      if (bytes.size() > 1'200'000) bytes = bytes_of(figure->sheet->png(190));
    }
  remove_stale(figures, png);
  write_file(directory / "report.pdf", pdf(document));
  write_file(directory / "report.html", html(document, [&](const Figure& f) { return png.at(f.name); }));
}

}  // namespace pivnp::report
