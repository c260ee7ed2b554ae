#include "stickslip/support/readable.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace stickslip {

void require_readable(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error) && std::ifstream(file).good()) return;
  throw std::invalid_argument("cannot be read");
}

}  // namespace stickslip
