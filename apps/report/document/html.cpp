#include "apps/report/document/html.hpp"

#include "apps/report/document/text.hpp"

#include <cmath>
#include <string_view>

#include <QByteArray>

#include "apps/plot/canvas.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

namespace {

constexpr std::string_view css = R"(
:root { --ink: #1a1a1a; --faint: #5f6368; --rule: #d0d0d0; --tint: #f4f6f8; --accent: #0b3d91; }
html { font-size: 17px; -webkit-text-size-adjust: 100%; }
body { margin: 0; color: var(--ink); background: #fff; line-height: 1.55;
  font-family: Charter, "Bitstream Charter", "Source Serif 4", Georgia, "DejaVu Serif", serif; }
main { max-width: 46rem; margin: 0 auto; padding: 3rem 1.5rem 5rem; }
h1, h2, h3, table, figcaption, nav, .subtitle, footer {
  font-family: "Helvetica Neue", Helvetica, Arial, "Liberation Sans", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.75rem; line-height: 1.2; margin: 0 0 .3rem; font-weight: 600; overflow-wrap: anywhere; }
.subtitle { color: var(--faint); margin: 0 0 2rem; font-size: .95rem; }
h2 { font-size: 1.2rem; margin: 3rem 0 .8rem; padding-top: .9rem; border-top: 1px solid var(--rule); font-weight: 600; }
h3 { font-size: 1rem; margin: 1.8rem 0 .5rem; font-weight: 600; }
p { margin: 0 0 1rem; overflow-wrap: anywhere; }
p.lead { background: var(--tint); border-left: 3px solid var(--accent); padding: 1rem 1.2rem; margin: 0 0 1.8rem; }
nav { font-size: .85rem; margin: 0 0 2rem; color: var(--faint); }
nav a { color: var(--accent); text-decoration: none; margin-right: 1.1rem; white-space: nowrap; }
nav a:hover { text-decoration: underline; }
ul { padding-left: 1.2rem; } li { margin: .35rem 0; overflow-wrap: anywhere; }
figure { margin: 2rem 0 2.2rem; }
figure img { display: block; width: 100%; height: auto; }
figcaption, caption { font-size: .82rem; line-height: 1.45; color: #333; text-align: left; overflow-wrap: anywhere; }
figcaption { margin-top: .5rem; } caption { caption-side: top; margin-bottom: .5rem; }
figcaption b, caption b { color: var(--ink); }
.scroll { overflow-x: auto; margin: 2rem 0; }
table { border-collapse: collapse; width: 100%; font-size: .78rem; line-height: 1.4; border-top: 1.5px solid var(--ink);
  border-bottom: 1.5px solid var(--ink); font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; border-bottom: 1px solid var(--ink); vertical-align: bottom; }
th, td { padding: .35rem .9rem .35rem 0; } th:last-child, td:last-child { padding-right: 0; }
td { vertical-align: top; border-bottom: 1px solid #ececec; } tr:last-child td { border-bottom: 0; }
tr.noted td { border-bottom: 0; padding-bottom: 0; }
tr.note td { padding-top: 0; color: var(--faint); font-size: .68rem; overflow-wrap: anywhere; }
.r { text-align: right; white-space: nowrap; } .c { text-align: center; }
.marked { color: #a40d24; font-weight: 600; }
pre { background: var(--tint); padding: .9rem 1.1rem; font-size: .72rem; line-height: 1.45; white-space: pre-wrap;
  overflow-wrap: anywhere; font-family: ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
@page { size: A4; margin: 20mm; }
@media print {
  html { font-size: 10.5pt; } main { max-width: none; padding: 0; } nav { display: none; }
  figure, tr { break-inside: avoid; } h2, h3, caption { break-after: avoid; } thead { display: table-header-group; }
  p.lead, pre { -webkit-print-color-adjust: exact; print-color-adjust: exact; } .scroll { overflow: visible; }
}
)";

class Writer {
 public:
  Writer(const Document& document, const std::function<std::string(const Figure&)>& png_of)
      : document_(document), png_of_(png_of) {}

  std::string write() {
    out_ += "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
    out_ +=
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"generator\" "
        "content=\"pivnp\">\n";
    out_ += "<title>" + escape_html(document_.title) + "</title>\n<style>" + std::string(css) +
            "</style>\n</head>\n<body>\n<main>\n";
    out_ += "<h1>" + escape_html(document_.title) + "</h1>\n<p class=\"subtitle\">" + escape_html(document_.subtitle) +
            "</p>\n";
    contents();
    for (const Block& block : document_.blocks) std::visit([this](const auto& b) { add(b); }, block);
    out_ += "</main>\n</body>\n</html>\n";
    return std::move(out_);
  }

 private:
  void contents() {
    std::string links;
    int n = 0;
    for (const Block& block : document_.blocks)
      if (const auto* h = std::get_if<Heading>(&block); h != nullptr && h->level == 1)
        links += "<a href=\"#s" + std::to_string(++n) + "\">" + escape_html(h->text) + "</a> ";
    if (n > 1) out_ += "<nav>" + links + "</nav>\n";
  }
  void add(const Heading& h) {
    if (h.level == 1) out_ += "<h2 id=\"s" + std::to_string(++section_) + "\">" + escape_html(h.text) + "</h2>\n";
    else out_ += "<h3>" + escape_html(h.text) + "</h3>\n";
  }
  void add(const Paragraph& p) {
    out_ += std::string(p.lead ? "<p class=\"lead\">" : "<p>") + escape_html(p.text) + "</p>\n";
  }
  void add(const List& list) {
    out_ += "<ul>\n";
    for (const std::string& item : list.items) out_ += "<li>" + escape_html(item) + "</li>\n";
    out_ += "</ul>\n";
  }
  void add(const Code& code) { out_ += "<pre>" + escape_html(code.text) + "</pre>\n"; }
  void add(const Definitions& d) {
    out_ += "<dl>\n";
    for (const auto& [name, text] : d.items) out_ += "<dt>" + escape_html(name) + "</dt><dd>" + escape_html(text) + "</dd>\n";
    out_ += "</dl>\n";
  }
  void add(const Table& t) {
    out_ += "<div class=\"scroll\"><table>\n<caption><b>Table " + std::to_string(++table_) + ".</b> " +
            escape_html(t.caption) + "</caption>\n<colgroup>";
    for (double w : t.width) out_ += "<col style=\"width:" + std::to_string(int(std::lround(100 * w))) + "%\">";
    out_ += "</colgroup>\n<thead><tr>";
    for (std::size_t k = 0; k < t.head.size(); ++k)
      out_ += "<th" + cell_class(t, k, false) + ">" + escape_html(t.head[k]) + "</th>";
    out_ += "</tr></thead>\n<tbody>\n";
    for (std::size_t r = 0; r < t.rows.size(); ++r) {
      const auto& row = t.rows[r];
      const bool noted = r < t.notes.size() && !t.notes[r].empty();
      out_ += noted ? "<tr class=\"noted\">" : "<tr>";
      for (std::size_t k = 0; k < row.size(); ++k)
        out_ += "<td" + cell_class(t, k, r < t.marked.size() && t.marked[r] == k) + ">" + escape_html(row[k]) + "</td>";
      out_ += "</tr>\n";
      if (noted)
        out_ += "<tr class=\"note\"><td colspan=\"" + std::to_string(row.size()) + "\">" + escape_html(t.notes[r]) +
                "</td></tr>\n";
    }
    out_ += "</tbody>\n</table></div>\n";
  }
  void add(const Figure& f) {
    const std::string png = png_of_(f);
    const QByteArray base64 = QByteArray::fromRawData(png.data(), qsizetype(png.size())).toBase64();
    const std::string label = std::string("Figure ") + std::to_string(++figure_) + ".";
    out_ += "<figure id=\"" + escape_html(f.name) + "\"><img alt=\"" + escape_html(label + " " + capitalised(f.shows)) +
            "\" width=\"" + std::to_string(std::lround(f.canvas->width_mm() / 25.4 * 96)) + "\" height=\"" +
            std::to_string(std::lround(f.canvas->height_mm() / 25.4 * 96)) + "\" src=\"data:image/png;base64,";
    out_.append(base64.constData(), std::size_t(base64.size()));
    out_ += "\">\n<figcaption><b>" + label + "</b> " + escape_html(f.caption) + "</figcaption></figure>\n";
  }
  static std::string cell_class(const Table& t, std::size_t k, bool marked) {
    if (marked) return " class=\"marked\"";
    if (k < t.align.size() && t.align[k] != 'l') return std::string(" class=\"") + t.align[k] + "\"";
    return "";
  }

  const Document& document_;
  const std::function<std::string(const Figure&)>& png_of_;
  std::string out_;
  int section_ = 0, table_ = 0, figure_ = 0;
};

}  // namespace

std::string html(const Document& document, const std::function<std::string(const Figure&)>& png_of) {
  return Writer(document, png_of).write();
}

}  // namespace pivnp::report
