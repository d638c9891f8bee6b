// Writes the reference of a case's keys and their JSON schema to the files given: a build tool, not part of the program.
#include <fstream>
#include <iostream>
#include <string>

#include "apps/case/case.hpp"

namespace {

bool written(const char* name, const std::string& text) {
  std::ofstream file(name, std::ios::binary);
  file << text << std::flush;
  if (!file) std::cerr << "cannot write " << name << "\n";
  return bool(file);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: pivnp_case_reference REFERENCE SCHEMA\n";
    return 2;
  }
  return written(argv[1], pivnp::app::case_reference()) && written(argv[2], pivnp::app::case_schema()) ? 0 : 1;
}
