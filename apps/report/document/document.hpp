// The report between its making and its writing: blocks that the HTML and the PDF both show. Plain text, no markup.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/report/figures/figure.hpp"

namespace pivnp::report {

struct Heading {
  int level = 1;  // 1: section, 2: subsection
  std::string text;
};

struct Paragraph {
  std::string text;
  bool lead = false;  // the verdict: set off from the rest
};

struct List {
  std::vector<std::string> items;
};

struct Code {
  std::string text;
};

/// Terms and what they mean, in small print.
struct Definitions {
  std::vector<std::pair<std::string, std::string>> items;
  bool run_in = false;  // a term runs into its text: no colon
};

struct Table {
  std::string caption;
  std::vector<std::string> head;
  std::vector<double> width;  // share of the measure, one a column
  std::vector<char> align;    // 'l', 'r' or 'c', one a column
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> notes;  // below each row, across the whole width; empty: none
  std::vector<std::optional<std::size_t>> marked;  // the cell of each row that is set off, if any
  bool fine = false;          // small print: an appendix
};

/// For a screen alone: paper has the figures.
struct OnScreen {
  std::string html;
};

/// The case: on a screen as its file, on paper its sections as running text.
struct CaseText {
  std::string toml;
};

using Block = std::variant<Heading, Paragraph, List, Code, Definitions, Table, Figure, OnScreen, CaseText>;

struct Document {
  std::string title, subtitle;
  std::vector<Block> blocks;
};

}  // namespace pivnp::report
