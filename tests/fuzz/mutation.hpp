#pragma once
/// Random damage to texts and files, the same for the same seed.

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::fuzz {

/// Words that readers treat in a way of their own.
inline const std::vector<std::string>& words() {
  static const std::vector<std::string> all{"0",
                                            "-0",
                                            "-1",
                                            "1e308",
                                            "1e-320",
                                            "1e999",
                                            "-1e999",
                                            "nan",
                                            "inf",
                                            "NaN",
                                            "null",
                                            "true",
                                            "2147483648",
                                            "-9223372036854775808",
                                            "18446744073709551616",
                                            "1e5",
                                            "0x1p3",
                                            "1,2",
                                            "1:2:3",
                                            "0.1:10:5:log",
                                            "1:2:1000000",
                                            ":",
                                            ",",
                                            ";",
                                            "\"",
                                            "'",
                                            "#",
                                            "\\",
                                            "{",
                                            "}",
                                            "[",
                                            "]",
                                            "(",
                                            ")",
                                            "[[[[[[[[",
                                            "((((((((",
                                            "\n",
                                            "\r\n",
                                            "\t",
                                            " ",
                                            "  ",
                                            "-",
                                            "--",
                                            "-help",
                                            "-mu_s",
                                            "-mu_d",
                                            "-delta",
                                            "-tau",
                                            "-drag",
                                            "-drag_expression",
                                            "-quantities",
                                            "-observable",
                                            "-lambda",
                                            "-time",
                                            "-route",
                                            "monte_carlo",
                                            "-sweep_mu_d",
                                            "-sweep_tau",
                                            "-study",
                                            "-bias",
                                            "-noise_levels",
                                            "full",
                                            "expression",
                                            "cubic",
                                            "-options_file",
                                            "-prefix_push",
                                            "-prefix_pop",
                                            "-slide_ksp_type",
                                            "-slide_pc_type",
                                            "-slide_mat_mumps_icntl_14",
                                            "quantity",
                                            "value",
                                            "error",
                                            "low",
                                            "high",
                                            "ci95",
                                            "results",
                                            "lambda",
                                            "format",
                                            "run",
                                            "rounds",
                                            "tally",
                                            "point",
                                            "status",
                                            "v",
                                            "x",
                                            "y",
                                            "abs",
                                            "sqrt(",
                                            "exp(",
                                            "^",
                                            "?",
                                            "==",
                                            "=",
                                            "&&",
                                            "||",
                                            "!",
                                            "1/0",
                                            "e",
                                            "_pi",
                                            "sum()",
                                            "min(",
                                            "\xff\xfe",
                                            "\xc3\x28",
                                            "\xef\xbb\xbf"};
  return all;
}

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  /// From 0 to count - 1.
  std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }
  bool one_in(std::size_t count) { return below(count) == 0; }

  /// Damages a text by bytes, words and pieces; `other` gives pieces, too.
  std::string text(std::string text, const std::string& other) {
    for (std::size_t n = 1 + (one_in(2) ? below(one_in(4) ? 12 : 3) : 0); n > 0; --n)
      text = once(text, other);
    return text.substr(0, kLongest);
  }

  /// Damages a binary file: single bits and bytes, numbers, its end; never much longer.
  std::string binary(std::string file) {
    for (std::size_t n = 1 + below(one_in(4) ? 40 : 4); n > 0 && !file.empty(); --n) {
      const std::size_t area = one_in(2) ? std::min<std::size_t>(file.size(), 2000) : file.size();
      overwrite(file, below(area));
    }
    if (one_in(10)) file.resize(below(file.size() + 1));
    return file;
  }

 private:
  static constexpr std::size_t kLongest = 1 << 16;

  std::string once(const std::string& text, const std::string& other) {
    const std::size_t at = below(text.size() + 1),
                      end = at + below(std::min<std::size_t>(text.size() - at + 1, 40));
    const std::string head = text.substr(0, at), tail = text.substr(end);
    switch (below(9)) {
    case 0: return bit(text);
    case 1: return head + tail;
    case 2: return head + std::string(1, static_cast<char>(below(256))) + text.substr(at);
    case 3: return head + words()[below(words().size())] + text.substr(at);
    case 4: return head + words()[below(words().size())] + tail;
    case 5: return text.substr(0, end) + text.substr(at);  // a piece twice
    case 6: return head + other.substr(below(other.size() + 1), below(60)) + text.substr(at);
    case 7: return number(text);
    default: return one_in(8) ? head : swapped(text);
    }
  }

  std::string bit(std::string text) {
    if (!text.empty()) {
      char& c = text[below(text.size())];
      c = static_cast<char>(c ^ (1 << below(8)));
    }
    return text;
  }

  // A number, from a digit on, becomes another one.
  std::string number(const std::string& text) {
    const std::size_t at = text.find_first_of("0123456789", below(text.size() + 1));
    if (at == text.npos) return text;
    const std::size_t end = std::min(text.find_first_not_of("0123456789.eE+-", at), text.size());
    return text.substr(0, at) + words()[below(20)] + text.substr(end);
  }

  // Two lines change places.
  std::string swapped(const std::string& text) {
    const std::size_t a = text.find('\n', below(text.size() + 1));
    if (a == text.npos) return text + text;
    return text.substr(a + 1) + text.substr(0, a + 1);
  }

  void overwrite(std::string& file, std::size_t at) {
    static const std::array<std::string_view, 5> fields{
        std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff", 8), std::string_view("\0\0\0\0", 4),
        std::string_view("\xff\xff\xff\xff\xff\xff\xff\x7f", 8), std::string_view("\x01\0\0\0", 4),
        std::string_view("\0\0\0\x80", 4)};
    if (one_in(2)) {
      file[at] = static_cast<char>(one_in(2) ? below(256) : file[at] ^ (1 << below(8)));
      return;
    }
    const std::string_view field = fields[below(fields.size())];
    file.replace(at, std::min(field.size(), file.size() - at), field.substr(0, file.size() - at));
  }

  std::mt19937_64 random_;
};

}  // namespace stickslip::fuzz
