#pragma once
/// Catch2 2 or 3, whichever is installed, under the names of Catch2 2.

#if __has_include(<catch2/catch_all.hpp>)

#include <catch2/catch_all.hpp>

#include <string>

using Catch::Approx;

namespace Catch {

using Matchers::EndsWith;
using Matchers::StartsWith;

// NOLINTNEXTLINE(readability-identifier-naming): the name of Catch2 2
inline auto Contains(const std::string& part) { return Matchers::ContainsSubstring(part); }

}  // namespace Catch

#else

#include <catch2/catch.hpp>

#endif
