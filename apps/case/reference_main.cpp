// Writes the reference of a case's keys to the file given: a build tool, not part of the program.
#include <fstream>
#include <iostream>

#include "apps/case/case.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: pivnp_case_reference FILE\n";
    return 2;
  }
  std::ofstream file(argv[1], std::ios::binary);
  file << pivnp::app::case_reference() << std::flush;
  if (!file) {
    std::cerr << "cannot write " << argv[1] << "\n";
    return 1;
  }
  return 0;
}
