// Rewrites the part of docs/troubleshooting.md that explains remarks: a build tool, not part of the program.
#include <fstream>
#include <iostream>
#include <string>

#include "apps/study/pipeline/record/remarks.hpp"
#include "pivnp/core/regular_file.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: pivnp_remark_reference PAGE\n";
    return 2;
  }
  std::string text = pivnp::text_of_file(argv[1]);
  const std::string head(pivnp::app::remark_head);
  const std::size_t begin = text.find(head), end = text.find("\n## ", begin);
  if (begin == text.npos || end == text.npos) {
    std::cerr << argv[1] << ": no section of remarks\n";
    return 1;
  }
  text.replace(begin, end + 1 - begin, head + pivnp::app::remark_reference());
  std::ofstream out(argv[1], std::ios::binary);
  out << text << std::flush;
  return out ? 0 : 1;
}
