#include "../common/catch.hpp"
#include "stickslip/support/infinity.hpp"
#include "stickslip/support/number_text.hpp"

#include <cmath>

using stickslip::error_text;
using stickslip::kInfinity;
using stickslip::number_text;
using stickslip::seconds_text;

namespace {
const double kNan = std::nan("");
}  // namespace

TEST_CASE("numbers: down to the place of the leading digit of the error") {
  CHECK(number_text(0.15648616853236219, 3.0e-10) == "0.1564861685");
  CHECK(number_text(-3.7919060943043013, 8.5e-08) == "-3.79190609");
  CHECK(number_text(12.5, 0.03) == "12.50");
  CHECK(number_text(12.5, 9.0) == "12");
  CHECK(number_text(63.999999999999943, 2.2e-13) == "63.9999999999999");
}

TEST_CASE("numbers: an error counts as it is printed, and rounding may carry") {
  CHECK(error_text(9.96e-4) == "1.0e-03");
  CHECK(number_text(0.12345678, 9.96e-4) == "0.123");
  CHECK(number_text(0.12345678, 9.94e-4) == "0.1235");
  CHECK(number_text(0.99999, 1e-3) == "1.000");
  CHECK(number_text(9999.6, 2.0) == "10000");
  CHECK(number_text(9.99e-8, 2e-10) == "9.99e-08");
  CHECK(number_text(9.999e-8, 2e-10) == "1.00e-07");
}

TEST_CASE("numbers: tiny and huge ones have an exponent, and no zeros that nobody knows") {
  CHECK(number_text(5.227964067791376e-08, 1.5e-15) == "5.2279641e-08");
  CHECK(number_text(0.00012344, 1e-7) == "0.0001234");
  CHECK(number_text(0.000012344, 1e-8) == "1.234e-05");
  CHECK(number_text(52341234, 3e4) == "5.234e+07");
  CHECK(number_text(123456.7, 2.0) == "123457");
  CHECK(number_text(1e300, 1e290) == "1.0000000000e+300");
  CHECK(number_text(-2.5e-310, 1e-311) == "-2.5e-310");
}

TEST_CASE("numbers: what is exact comes in the shortest form, zero without a sign") {
  CHECK(number_text(0, 0) == "0");
  CHECK(number_text(-0.0, 0) == "0");
  CHECK(number_text(0, 1e-3) == "0");
  CHECK(number_text(1, 0) == "1");
  CHECK(number_text(0.1, 0) == "0.1");
  CHECK(number_text(0.0001220703125, 0) == "0.0001220703125");
  // Beyond the last bit an error takes no digit away, nor adds any.
  CHECK(number_text(0.1, 1e-30) == "0.1");
  CHECK(std::stod(number_text(0.15648616853236219, 1e-18)) == 0.15648616853236219);
}

TEST_CASE("numbers: of a value below its error the leading digit stays") {
  CHECK(number_text(-6.98e-16, 2.2e-15) == "-7e-16");
  CHECK(number_text(0.3, 5) == "0.3");
  CHECK(number_text(7, 50) == "7");
  CHECK(number_text(71, 500) == "7e+01");
}

TEST_CASE("numbers: none, and infinite ones") {
  CHECK(number_text(kNan, 1) == "nan");
  CHECK(number_text(kInfinity, kNan) == "inf");
  CHECK(number_text(-kInfinity, 0) == "-inf");
  CHECK(number_text(0.25, kInfinity) == "0.2");
  CHECK(number_text(0.25, kNan) == "0.2");
  CHECK(error_text(0) == "0");
  CHECK(error_text(kNan) == "-");
  CHECK(error_text(kInfinity) == "-");
}

TEST_CASE("seconds: milliseconds, of long times fewer decimals") {
  CHECK(seconds_text(0) == "0.000");
  CHECK(seconds_text(0.0416) == "0.042");
  CHECK(seconds_text(9.87654) == "9.877");
  CHECK(seconds_text(98.7654) == "98.77");
  CHECK(seconds_text(987.654) == "987.7");
  CHECK(seconds_text(98765.4) == "98765");
}
