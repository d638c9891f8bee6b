#include "apps/report/write.hpp"

#include <map>
#include <string>
#include <system_error>
#include <vector>

#include "apps/plot/canvas.hpp"
#include "apps/plot/files.hpp"
#include "apps/report/document/html.hpp"
#include "apps/report/document/pdf.hpp"
#include "apps/report/document/sections.hpp"

namespace pivnp::report {

namespace {

namespace fs = std::filesystem;

constexpr double print_dpi = 300;

// Figures of an earlier report that this one does not have would be taken for its own.
void remove_stale(const fs::path& folder, const std::map<std::string, std::string>& kept) {
  std::error_code error;
  std::vector<fs::path> stale;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().stem().string(), kind = entry.path().extension().string();
    if ((kind == ".png" || kind == ".svg" || kind == ".csv") && row_of(name) != nullptr && !kept.contains(name))
      stale.push_back(entry.path());
  }
  for (const fs::path& file : stale) fs::remove(file, error);
}

}  // namespace

void write_content(const ReportOptions& options, const Content& content, const fs::path& directory) {
  plot::start_qt();
  const fs::path folder = directory / "figures";
  plot::make_folder(folder);
  const Document document = make_document(options, content);

  std::map<std::string, std::string> png;
  for (const Block& block : document.blocks)
    if (const auto* figure = std::get_if<Figure>(&block)) {
      std::string& bytes = png[figure->name];
      bytes = figure->canvas->png(print_dpi);
      plot::write_file(folder / (figure->name + ".png"), bytes);
      plot::write_file(folder / (figure->name + ".svg"), figure->canvas->svg());
      plot::write_file(folder / (figure->name + ".csv"), csv(figure->data));
      // A photograph at print resolution would make the page heavy.
      if (bytes.size() > 1'200'000) bytes = figure->canvas->png(190);
    }
  remove_stale(folder, png);
  plot::write_file(directory / "report.pdf", pdf(document));
  plot::write_file(directory / "report.html", html(document, [&](const Figure& f) { return png.at(f.name); }));
}

}  // namespace pivnp::report
