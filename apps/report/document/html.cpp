#include "apps/report/document/html.hpp"

#include "apps/report/document/text.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <QByteArray>

#include "apps/plot/canvas.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

namespace {

constexpr std::string_view css = R"(
:root { color-scheme: light dark; --ink: #1a1a1a; --faint: #5f6368; --rule: #d0d0d0; --tint: #f4f6f8; --accent: #0b3d91;
  --back: #fff; --row: #ececec; --bad: #a40d24; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e6; --faint: #a3a8ad; --rule: #444a50; --tint: #22262b;
  --accent: #8ab4f8; --back: #15181b; --row: #2f343a; --bad: #ff8a80; } }
html { font-size: 17px; -webkit-text-size-adjust: 100%; }
body { margin: 0; color: var(--ink); background: var(--back); line-height: 1.55;
  font-family: Charter, "Bitstream Charter", "Source Serif 4", Georgia, "DejaVu Serif", serif; }
main { max-width: 46rem; margin: 0 auto; padding: 3rem 1.5rem 5rem; }
h1, h2, h3, table, figcaption, nav, dl, .subtitle, #player, footer {
  font-family: "Helvetica Neue", Helvetica, Arial, "Liberation Sans", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.75rem; line-height: 1.2; margin: 0 0 .3rem; font-weight: 600; overflow-wrap: anywhere; }
.subtitle { color: var(--faint); margin: 0 0 2rem; font-size: .95rem; }
h2 { font-size: 1.2rem; margin: 3rem 0 .8rem; padding-top: .9rem; border-top: 1px solid var(--rule); font-weight: 600; }
h3 { font-size: 1rem; margin: 1.8rem 0 .5rem; font-weight: 600; }
p { margin: 0 0 1rem; overflow-wrap: anywhere; }
p.lead { background: var(--tint); border-left: 3px solid var(--accent); padding: 1rem 1.2rem; margin: 0 0 1.8rem; }
nav { font-size: .85rem; margin: 0 0 2rem; color: var(--faint); }
nav a { color: var(--accent); text-decoration: none; margin-right: 1.1rem; white-space: nowrap; }
nav a:hover, nav a:focus { text-decoration: underline; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
.skip { position: absolute; left: -99rem; } .skip:focus { left: 1rem; top: 1rem; }
ul { padding-left: 1.2rem; } li { margin: .35rem 0; overflow-wrap: anywhere; }
figure { margin: 2rem 0 2.2rem; }
.picture { overflow-x: auto; background: #fff; }
figure img { display: block; width: 100%; height: auto; background: #fff; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 0 1rem; align-items: end; } .pair figure { align-self: start; }
figcaption, caption { font-size: .82rem; line-height: 1.45; text-align: left; overflow-wrap: anywhere; }
figcaption { margin-top: .5rem; } caption { caption-side: top; margin-bottom: .5rem; }
.scroll { overflow-x: auto; margin: 2rem 0; }
table { border-collapse: collapse; width: 100%; font-size: .78rem; line-height: 1.4; border-top: 1.5px solid var(--ink);
  border-bottom: 1.5px solid var(--ink); font-variant-numeric: tabular-nums; }
table.fine { font-size: .7rem; }
th { text-align: left; font-weight: 600; border-bottom: 1px solid var(--ink); vertical-align: bottom; }
th, td { padding: .35rem .9rem .35rem 0; } .fine th, .fine td { padding: .15rem .7rem .15rem 0; }
th:last-child, td:last-child { padding-right: 0; }
td { vertical-align: top; border-bottom: 1px solid var(--row); } tr:last-child td { border-bottom: 0; }
tr.noted td { border-bottom: 0; padding-bottom: 0; }
tr.note td { padding-top: 0; color: var(--faint); font-size: .68rem; overflow-wrap: anywhere; }
.r { text-align: right; white-space: nowrap; } .c { text-align: center; }
.marked { color: var(--bad); font-weight: 600; }
dl { font-size: .7rem; line-height: 1.4; } dt { font-weight: 600; } dd { margin: 0 0 .3rem 1rem; overflow-wrap: anywhere; }
pre { background: var(--tint); padding: .9rem 1.1rem; font-size: .72rem; line-height: 1.45; white-space: pre-wrap;
  overflow-wrap: anywhere; font-family: ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
#player { background: var(--tint); padding: .8rem 1rem; font-size: .82rem; }
#player .controls { display: flex; flex-wrap: wrap; gap: .4rem 1.2rem; align-items: center; }
#player input { width: 14rem; max-width: 60vw; vertical-align: middle; } #player output { min-width: 5rem; }
#player canvas { width: 100%; display: block; touch-action: none; } #player .name { margin: .5rem 0 .2rem; font-weight: 600; }
#player .scale { display: flex; gap: .5rem; align-items: center; margin: .5rem 0; } #player .bar { flex: 1; height: .7rem; }
#player .said { margin: 0; min-height: 2.6em; }
@page { size: A4; margin: 20mm; }
@media (max-width: 640px) {
  html { font-size: 16px; } main { padding: 1.2rem .8rem 3rem; } .pair { grid-template-columns: 1fr; }
  .picture.wide img { min-width: 38rem; } #verdict .picture.wide img, #motion .picture.wide img { min-width: 0; } caption > span { display: block; position: sticky; left: 0; max-width: calc(100vw - 1.6rem); }
  table.pairs tr { display: block; border-bottom: 1px solid var(--row); } table.pairs thead, table.pairs col { display: none; }
  table.pairs td { display: inline-block; width: 46%; border: 0; vertical-align: top; } table.pairs td:empty { display: none; }
  table.cards thead { position: absolute; left: -99rem; } table.cards col { display: none; }
  table.cards, table.cards tbody, table.cards tr, table.cards td, table.cards caption { display: block; width: 100%; }
  table.cards td, table.cards td:last-child { border: 0; padding: .1rem 0; text-align: left; white-space: normal; }
  table.cards td:first-child { font-weight: 600; padding-top: .5rem; }
  table.cards td[data-label]:not(:empty)::before { content: attr(data-label) ": "; color: var(--faint); }
  table.cards tr { border-bottom: 1px solid var(--row); }
}
@media print {
  :root { --ink: #1a1a1a; --back: #fff; --tint: #f4f6f8; --faint: #5f6368; --rule: #d0d0d0; --row: #ececec; }
  html { font-size: 10.5pt; } main { max-width: none; padding: 0; } nav, #player { display: none; }
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
            "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#main\">To the report</a>\n<main id=\"main\">\n";
    out_ += "<h1>" + escape_html(document_.title) + "</h1>\n<p class=\"subtitle\">" + escape_html(document_.subtitle) +
            "</p>\n";
    contents();
    // Half figures that follow each other stand in pairs, as on paper.
    const auto half = [&](std::size_t k) {
      const Figure* f = k < document_.blocks.size() ? std::get_if<Figure>(&document_.blocks[k]) : nullptr;
      return f != nullptr && f->canvas->width_mm() <= half_figure_mm ? f : nullptr;
    };
    for (std::size_t k = 0; k < document_.blocks.size(); ++k) {
      if (half(k) && half(k + 1)) {
        out_ += "<div class=\"pair\">\n";
        add(*half(k));
        add(*half(++k));
        out_ += "</div>\n";
      } else {
        std::visit([this](const auto& b) { add(b); }, document_.blocks[k]);
      }
    }
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
  void add(const CaseText& c) { out_ += "<pre>" + escape_html(c.toml) + "</pre>\n"; }
  void add(const OnScreen& screen) { out_ += screen.html; }
  void add(const Definitions& d) {
    out_ += "<dl>\n";
    for (const auto& [name, text] : d.items) out_ += "<dt>" + escape_html(name) + "</dt><dd>" + escape_html(text) + "</dd>\n";
    out_ += "</dl>\n";
  }
  void add(const Table& t) {
    const bool pairs = std::all_of(t.head.begin(), t.head.end(), [](const std::string& text) { return text.empty(); });
    const bool cards = t.head.size() > 3 && t.head[0].size() + t.head[1].size() > 0 && !t.fine;
    out_ += "<div class=\"scroll\" tabindex=\"0\"><table class=\"" + std::string(pairs ? "fine pairs" : t.fine ? "fine" : cards ? "cards" : "plain") + "\">\n<caption><span><b>Table " + std::to_string(++table_) + ".</b> " +
            escape_html(t.caption) + "</span></caption>\n<colgroup>";
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
        out_ += "<td" + cell_class(t, k, r < t.marked.size() && t.marked[r] == k) +
                (cards && k > 0 ? " data-label=\"" + escape_html(t.head[k]) + "\"" : "") + ">" + escape_html(row[k]) + "</td>";
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
    out_ += "<figure id=\"" + escape_html(f.name) + "\"><div class=\"picture" + (f.canvas->width_mm() > half_figure_mm ? " wide\" tabindex=\"0" : "") + "\"><img alt=\"" + escape_html(label + " " + capitalised(f.shows)) +
            "\" width=\"" + std::to_string(std::lround(f.canvas->width_mm() / 25.4 * 96)) + "\" height=\"" +
            std::to_string(std::lround(f.canvas->height_mm() / 25.4 * 96)) + "\" src=\"data:image/png;base64,";
    out_.append(base64.constData(), std::size_t(base64.size()));
    out_ += "\"></div>\n<figcaption><b>" + label + "</b> " + escape_html(f.caption) + "</figcaption></figure>\n";
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
