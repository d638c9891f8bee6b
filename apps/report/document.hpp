// The report between its making and its writing: blocks that the HTML and the PDF both show. Plain text, no markup.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace pivnp::report {

class Sheet;  // a drawn figure (sheet.hpp, Qt)

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

struct Table {
  std::string caption;
  std::vector<std::string> head;
  std::vector<double> width;  // share of the measure, one a column
  std::vector<char> align;    // 'l', 'r' or 'c', one a column
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> notes;  // below each row, across the whole width; empty: none
};

struct Figure {
  std::string name;  // of its files
  std::string caption;
  std::shared_ptr<const Sheet> sheet;
};

using Block = std::variant<Heading, Paragraph, List, Code, Table, Figure>;

struct Document {
  std::string title, subtitle;
  std::vector<Block> blocks;
};

}  // namespace pivnp::report
