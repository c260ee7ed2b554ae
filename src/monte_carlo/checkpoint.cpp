#include "checkpoint.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "stickslip/petsc/session.hpp"
#include "stickslip/support/atomic_file.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/seal.hpp"

namespace stickslip::monte_carlo {
namespace {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::pair<std::string, std::string>>;

constexpr const char* kFormat = "stickslip checkpoint 2";

std::string contents_on_all(MPI_Comm comm, const std::string& file) {
  std::string text;
  if (petsc::rank(comm) == 0) {
    std::ifstream stream(file, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(stream), {});
  }
  return petsc::first_text(comm, text);
}

[[noreturn]] void refuse(const std::string& file, const std::string& why) {
  throw BadInput(fmt::format("-checkpoint = {}: {}; name another file, or remove it", file, why));
}

Checkpoint parse(const std::string& file, const std::string& text) {
  Checkpoint checkpoint;
  const auto object = unsealed(text.substr(0, text.find('\n')));
  if (!object) refuse(file, "is no checkpoint of this program, or a damaged one");
  try {
    const Json json = Json::parse(*object);
    if (json.at("format") != kFormat) refuse(file, "is no checkpoint of this program");
    for (const auto& [name, value] : json.at("run").items()) {
      checkpoint.run.emplace_back(name, value.get<std::string>());
    }
    const Json& rounds = json.at("rounds");
    if (!rounds.is_number_integer()) refuse(file, "is damaged");
    checkpoint.rounds = rounds.get<long>();
    checkpoint.tally = json.at("tally").get<std::vector<double>>();
  } catch (const Json::exception&) {
    refuse(file, "is no checkpoint, or a damaged one");
  }
  if (checkpoint.rounds < 0) refuse(file, "is damaged");
  return checkpoint;
}

void require_same(const std::string& file, const Names& found, const Names& wanted) {
  if (found.size() != wanted.size()) refuse(file, "belongs to another version of the program");
  for (std::size_t n = 0; n < wanted.size(); ++n) {
    if (found[n] == wanted[n]) continue;
    refuse(file, fmt::format("belongs to a run with -{} {}, not {}", found[n].first,
                             found[n].second, wanted[n].second));
  }
}

}  // namespace

std::optional<Checkpoint> read_checkpoint(MPI_Comm comm, const std::string& file,
                                          const Names& run) {
  const std::string text = contents_on_all(comm, file);
  if (text.empty()) return std::nullopt;
  Checkpoint checkpoint = parse(file, text);
  require_same(file, checkpoint.run, run);
  return checkpoint;
}

void write_checkpoint(const std::string& file, const Checkpoint& checkpoint) {
  Json json{{"format", kFormat}};
  for (const auto& [name, value] : checkpoint.run) json["run"][name] = value;
  json["rounds"] = checkpoint.rounds;
  json["tally"] = checkpoint.tally;
  write_text(file, sealed(json.dump()) + "\n");
}

}  // namespace stickslip::monte_carlo
