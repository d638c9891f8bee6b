#include "apps/study/frontier/written_pages.hpp"

#include <map>

#include "apps/plot/canvas.hpp"
#include "apps/plot/files.hpp"
#include "apps/report/document/html.hpp"
#include "apps/report/document/pdf.hpp"

namespace pivnp::app {

std::vector<std::filesystem::path> write_pages(const report::Document& document, const std::string& name,
                                               const std::vector<std::pair<std::string, std::string>>& texts,
                                               const std::vector<io::NamedTable>& tables, const std::filesystem::path& folder) {
  constexpr double screen_dpi = 200;
  plot::start_qt();
  plot::make_folder(folder);
  std::vector<std::filesystem::path> files;
  const auto write = [&](const std::string& file, const std::string& bytes) {
    plot::write_file(folder / file, bytes);
    files.push_back(folder / file);
  };
  std::map<std::string, std::string> png;
  for (const report::Block& block : document.blocks)
    if (const auto* figure = std::get_if<report::Figure>(&block)) png[figure->name] = figure->canvas->png(screen_dpi);
  write(name + ".html", report::html(document, [&](const report::Figure& f) { return png.at(f.name); }));
  write(name + ".pdf", report::pdf(document));
  for (const report::Block& block : document.blocks)
    if (const auto* figure = std::get_if<report::Figure>(&block)) {
      write(figure->name + ".png", png.at(figure->name));
      write(figure->name + ".svg", figure->canvas->svg());
    }
  for (const auto& [file, bytes] : texts) write(file, bytes);
  io::write_tables(folder / (name + ".h5"), tables);
  files.push_back(folder / (name + ".h5"));
  return files;
}

}  // namespace pivnp::app
