#include "../common/catch.hpp"
#include "stickslip/base/text.hpp"

#include <cmath>

using stickslip::error_text;
using stickslip::kInfinity;
using stickslip::number_text;
using stickslip::parse_number;
using stickslip::parse_numbers;
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
  CHECK(number_text(-kNan, 1) == "nan");
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

TEST_CASE("numbers: decimal and finite, nothing before or after") {
  CHECK(parse_number("0.25") == 0.25);
  CHECK(parse_number("-1e-3") == -1e-3);
  CHECK(parse_number("+2") == 2.0);
  for (const char* bad : {"", "abc", "2.5xyz", "nan", "inf", "1e400", "1,5", " 1", "1 ", "0x10",
                          "--1", "+-1", "1e", "+"}) {
    INFO(bad);
    CHECK_FALSE(parse_number(bad));
  }
}

TEST_CASE("number lists: as they are, or evenly spaced") {
  using Numbers = std::vector<double>;
  CHECK(parse_numbers("0.1") == Numbers{0.1});
  CHECK(parse_numbers("0.1,1,10") == Numbers{0.1, 1, 10});
  CHECK(parse_numbers(" 3 , -1e-2 ") == Numbers{3, -0.01});
  CHECK(parse_numbers("1:2:3") == Numbers{1, 1.5, 2});
  CHECK(parse_numbers("-1:1:2") == Numbers{-1, 1});
  CHECK(parse_numbers("1:16:5:log").value() == Numbers{1, 2, 4, 8, 16});
  const auto many = parse_numbers("0.001:0.1:31:log");
  REQUIRE(many);
  CHECK(many->size() == 31);
  CHECK(many->front() == 0.001);
  CHECK((*many)[15] == Approx(0.01).epsilon(1e-14));
  // Ends are as written, where 0.3 + (0.9 - 0.3) and 0.3 (0.9/0.3) are not 0.9.
  CHECK(parse_numbers("0.3:0.9:4")->back() == 0.9);
  CHECK(parse_numbers("0.3:0.9:4:log")->back() == 0.9);
}

TEST_CASE("number lists: anything else is refused") {
  for (const char* bad :
       {"",          "a",           "1,b",        "1;2",     "1,inf",  "1:2",     "1:2:3:4",
        "1:2:3:lin", "1:2:3:log:5", "1:2:1",      "1:2:0",   "1:2:-3", "1:2:2.5", "2:1:3",
        "1:1:3",     "0:1:3:log",   "-1:1:3:log", "1:2:1e7", "1:x:3",  "nan:1:2", "1:2:3,4"}) {
    INFO(bad);
    CHECK_FALSE(parse_numbers(bad));
  }
}
