#include "apps/report/write.hpp"

#include <cmath>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include "apps/plot/canvas.hpp"
#include "apps/plot/files.hpp"
#include "apps/report/document/html.hpp"
#include "apps/report/document/pdf.hpp"
#include "apps/report/document/sections.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::report {

namespace {

namespace fs = std::filesystem;

constexpr double print_dpi = 300;

std::string quoted(std::string text) {
  for (std::size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at + 2)) text.insert(at, 1, '"');
  return "\"" + text + "\"";
}

std::string metrics_csv(const std::vector<Metric>& metrics) {
  std::string text = "name,value,unit,standard uncertainty,verdict,lost in,limit,definition\n";
  const auto cell = [](double v) { return std::isfinite(v) ? number(v, 12) : std::string(); };
  for (const Metric& m : metrics)
    text += m.name + "," + cell(m.value) + "," + m.unit + "," + cell(m.uncertainty) + "," + quoted(std::string(name_of(m.verdict))) +
            "," + std::string(name_of(m.lost_in)) + "," + std::string(name_of(m.limit)) + "," + quoted(m.definition) + "\n";
  return text;
}

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
  const fs::path metrics = directory / "metrics.csv";
  std::error_code error;
  if (content.comparison) plot::write_file(metrics, metrics_csv(content.comparison->metrics));
  else fs::remove(metrics, error);
  plot::write_file(directory / "report.pdf", pdf(document));
  plot::write_file(directory / "report.html", html(document, [&](const Figure& f) { return png.at(f.name); }));
}

}  // namespace pivnp::report
