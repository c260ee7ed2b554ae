#pragma once
/// PETSc options for the length of a test.

#include <petscsys.h>

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/linalg/petsc.hpp"

namespace stickslip::test {

/// PETSc options for the life of the object.
class Given {
 public:
  Given(std::initializer_list<std::pair<std::string, std::string>> options)
      : Given(std::vector(options)) {}
  explicit Given(std::vector<std::pair<std::string, std::string>> options)
      : options_(std::move(options)) {
    for (const auto& [name, value] : options_) {
      linalg::check(PetscOptionsSetValue(nullptr, name.c_str(), value.c_str()));
    }
  }
  ~Given() {
    for (const auto& option : options_) (void)PetscOptionsClearValue(nullptr, option.first.c_str());
  }
  Given(const Given&) = delete;
  Given& operator=(const Given&) = delete;

 private:
  std::vector<std::pair<std::string, std::string>> options_;
};

}  // namespace stickslip::test
