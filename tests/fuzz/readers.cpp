/// Damaged input for every reader: options files and lines, references (CSV, JSON, HDF5),
/// checkpoints of simulations and of sweeps, expressions. A reader takes it or refuses it with the
/// exception that ends the program with status 2; whatever else happens is a fault, and the input
/// is kept. Meant to run under sanitizers.
///
///     fuzz_readers [inputs] [seed]

#include <fmt/format.h>
#include <petscsys.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <string_view>

#include "../common/temporary.hpp"
#include "mutation.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/base/files.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/cli/hdf5_file.hpp"
#include "stickslip/cli/output.hpp"
#include "stickslip/cli/reports.hpp"
#include "stickslip/cli/request.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/model/drag.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/run/campaign.hpp"

using namespace stickslip;
using Json = nlohmann::ordered_json;

namespace {

/// PETSc options of one input.
class Options {
 public:
  Options() {
    linalg::check(PetscOptionsCreate(&options_));
    linalg::check(PetscOptionsPush(options_));
  }
  ~Options() {
    (void)PetscOptionsPop();
    (void)PetscOptionsDestroy(&options_);
  }
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

 private:
  PetscOptions options_ = nullptr;
};

/// What PETSc itself refuses as the program starts, which then ends with status 2.
void at_start(PetscErrorCode code) {
  try {
    linalg::check(code);
  } catch (const linalg::PetscFailure& failure) {
    throw BadInput(failure.what());
  }
}

cli::Request request_of_file(const std::string& file) {
  const Options options;
  cli::check_options_files({"-options_file", file});
  const PetscErrorCode code =
      PetscOptionsInsertFile(PETSC_COMM_SELF, nullptr, file.c_str(), PETSC_TRUE);
  at_start(code);
  return cli::read_request({});
}

// A word in each line of the text.
cli::Request request_of_line(const std::string& line) {
  std::vector<std::string> words = split(line.substr(0, line.find('\0')), '\n');
  if (!words.empty() && words.back().empty()) words.pop_back();
  words.insert(words.begin(), {"program", "-skip_petscrc"});
  cli::shield_formulas(words);
  cli::check_options_files(words);
  const Options options;
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  auto count = static_cast<int>(words.size());
  char** values = arguments.data();
  const PetscErrorCode code = PetscOptionsInsert(nullptr, &count, &values, nullptr);
  at_start(code);
  return cli::read_request({words.begin() + 2, words.end()});
}

/// One kind of input. `read` gets it in a file, and returns if it is taken.
struct Target {
  std::string name, ending;
  std::size_t share;  // of a hundred inputs
  std::vector<std::string> corpus;
  std::function<std::string(fuzz::Mutator&, const std::string&, const std::string&)> mutate;
  std::function<void(const std::string& file)> read;
};

std::string by_text(fuzz::Mutator& mutator, const std::string& text, const std::string& other) {
  return mutator.text(text, other);
}

std::string by_byte(fuzz::Mutator& mutator, const std::string& text, const std::string&) {
  return mutator.binary(text);
}

Json some_value(fuzz::Mutator& mutator) {
  static const std::vector<Json> values{nullptr,
                                        true,
                                        "",
                                        "x",
                                        0,
                                        -1,
                                        1e308,
                                        -1e-320,
                                        1.5,
                                        18446744073709551615U,
                                        Json::array(),
                                        Json::object(),
                                        {1, 2, 3},
                                        {{"value", 1}},
                                        {{1, 2}, {3}}};
  return values[mutator.below(values.size())];
}

// Replaces, removes or repeats something inside.
void damage(fuzz::Mutator& mutator, Json& json) {
  if (!json.is_structured() || json.empty() || mutator.one_in(6)) {
    json = some_value(mutator);
    return;
  }
  auto at = json.begin();
  std::advance(at, mutator.below(json.size()));
  if (!mutator.one_in(5)) return damage(mutator, *at);
  const Json copy = *at;
  if (mutator.one_in(2)) {
    json.erase(at);
  } else if (json.is_array()) {
    json.push_back(copy);
  } else {
    json["again"] = copy;
  }
}

std::string by_structure(fuzz::Mutator& mutator, const std::string& text,
                         const std::string& other) {
  if (mutator.one_in(3)) return mutator.text(text, other);
  Json json = Json::parse(text);
  for (std::size_t n = 1 + mutator.below(3); n > 0; --n) damage(mutator, json);
  return json.dump();
}

// With the right checksum two times in three, so that what it protects is damaged, too.
std::string sealed_again(fuzz::Mutator& mutator, const std::string& text,
                         const std::string& other) {
  const auto object = unsealed(text.substr(0, text.size() - 1));
  if (mutator.one_in(3) || !object) return mutator.text(text, other);
  const std::string damaged = by_structure(mutator, *object, other);
  return damaged.ends_with('}') ? sealed(damaged) + "\n" : damaged;
}

// The entries of a checkpoint, each with the right checksum half of the time.
std::string entries_again(fuzz::Mutator& mutator, const std::string& text,
                          const std::string& other) {
  if (mutator.one_in(2)) return mutator.text(text, other);
  auto lines = split(text, '\n');
  std::string& line = lines[1 + mutator.below(lines.size() - 2)];
  line = sealed_again(mutator, line + "\n", other);
  std::string all;
  for (const auto& each : lines) all += each.empty() || each.ends_with('\n') ? each : each + "\n";
  return all;
}

const char* const kScene = "-mu_d\n0.25\n-delta\n0.5\n-accuracy\n1e-2\n-quantities\n";

/// Files to begin with, written by the program's own writers.
class Corpus {
 public:
  explicit Corpus(const test::TemporaryFolder& folder) : folder_(folder) {}

  std::string checkpoint() const {
    const std::string file = folder_ / "seed.checkpoint";
    (void)run::simulate(PETSC_COMM_SELF, simulation(), file, {});
    return test::content(file);
  }
  static cli::Request simulation() {
    return request_of_line(std::string(kScene) +
                           "sticking\n-route\nmonte_carlo\n-excursions\n16384");
  }

  std::string sweep_checkpoint() const {
    cli::Request request = sweep();
    request.files.checkpoint = folder_ / "seed.sweep";
    (void)cli::run_sweep(PETSC_COMM_SELF, request, {});
    return test::content(request.files.checkpoint);
  }
  static cli::Request sweep() {
    return request_of_line(std::string(kScene) +
                           "sticking,laplace\n-lambda\n0.5,2\n-sweep_tau\n0.5,1");
  }
  /// Entries of finished points, without checksums.
  std::vector<std::string> entries() const {
    std::vector<std::string> found;
    const auto lines = split(sweep_checkpoint(), '\n');
    for (std::size_t n = 1; n + 1 < lines.size(); ++n) found.push_back(*unsealed(lines[n]));
    return found;
  }

  std::string hdf5() const {
    const std::string file = folder_ / "seed.h5";
    cli::Hdf5File out(PETSC_COMM_SELF, file);
    for (const char* group : {"/results", "/results/P_stick", "/results/F_slide"}) {
      out.make_group(group);
    }
    out.write_scalar("/results/P_stick/value", 0.25);
    out.write_scalar("/results/P_stick/error", 1e-9);
    for (const char* name : {"lambda", "value", "error"}) {
      out.write_array(fmt::format("/results/F_slide/{}", name), std::vector<double>{0.5, 1, 2});
    }
    out.attribute("/results/P_stick", "unit", "none");
    out.commit();
    return test::content(file);
  }

 private:
  const test::TemporaryFolder& folder_;
};

const std::vector<std::string>& option_files() {
  static const std::vector<std::string> files{
      "# model parameters\n-mu_s 1\n-mu_d 0.25\n-delta 0.125 # step\n-tau 1\n-quantities "
      "sticking,moments\n",
      "-mu_d 0.5\n-drag expression\n-drag_expression \" -v - 0.1*v*abs(v)\"\n-bias 0.1\n",
      "-quantities resolvent,laplace\n-lambda 0.1:10:5:log\n-observable \"v^2; x*v; stick\"\n",
      "-route monte_carlo\n-excursions 1e4\n-seed 7\n-quantities sticking,trajectory\n-start "
      "0.5,0\n"
      "-trajectory path.csv\n",
      "-sweep_mu_d 0.25,0.5\n-sweep_tau 0.5:1:3\n-accuracy 1e-4\n",
      "-slide_mat_mumps_icntl_14 30\n-slide_ksp_type preonly\n-study p\n-study_steps 4\n",
      "-quantities spectrum,duration_density\n-omega 0:10:5\n-time 0.1,1\n-scheme upwind\n-p 2\n"};
  return files;
}

// The same as words of a line.
std::vector<std::string> option_lines() {
  std::vector<std::string> lines{"-drag\nexpression\n-drag_expression\n-v*abs(v)\n"};
  for (const auto& file : option_files()) {
    std::string words;
    for (const auto& option : split(file, '\n')) {
      const auto end = option.find(' ');
      if (!option.starts_with('-') || end == option.npos) continue;
      words += option.substr(0, end) + "\n" + option.substr(end + 1, option.find(" #") - end - 1);
      words += "\n";
    }
    std::erase(words, '"');
    lines.push_back(words);
  }
  return lines;
}

const char* const kJson =
    R"({"scene":{"mu_s":1.0},"results":{"P_stick":{"value":0.25,"error":1e-9,"unit":""},)"
    R"("F_slide":{"lambda":[0.5,1,2],"value":[0.3,0.2,0.1],"error":[1e-9,1e-9,1e-9]},)"
    R"("E_V2":{"value":0.5,"error":0.1,"ci95":[0.4,0.6]},)"
    R"("cdf_slide":{"time":[1,2],"value":[0.5,0.6],"error":[0,0],"ci95":[[0.4,0.6],[0.5,0.7]]}}})";

const char* const kCsv =
    "quantity,argument,value,low,high\nP_stick,,0.25,0.2,0.3\nF_slide,0.5,0.3,0.29,0.31\n"
    "\"F_slide\", 1 ,2e-1,,\nE_V2,,0.5,0.4,0.6\n";

void use(const model::Drag& drag) {
  (void)(drag.terminal_velocity(1) + drag.slope_at_rest() + drag.steepest(1) + drag.potential(1));
}

// What the reports do with a finished point that was read.
void report(const std::string& file) {
  static const cli::Request request = Corpus::sweep();
  cli::SweepResult conducted;
  try {
    conducted.runs.push_back(cli::read_run(test::content(file)));
  } catch (const std::exception& refusal) {
    throw BadInput(refusal.what());
  }
  if (conducted.runs[0].point >= request.sweep->size()) return;
  const auto report = cli::report_of(PETSC_COMM_SELF, request, conducted, {});
  (void)report.tree();
  (void)report.rows();
  (void)report.grid();
}

template <class Work>
void keeps_file_when_refused(const std::string& file, Work work) {
  const std::string before = test::content(file);
  try {
    work();
  } catch (const BadInput&) {
    if (test::content(file) != before) throw std::logic_error("a refused file was changed");
    throw;
  }
}

void go_on_with(cli::Request request, const std::string& file) {
  request.files.checkpoint = file;
  keeps_file_when_refused(file, [&] {
    if (request.sweep) {
      (void)cli::run_sweep(PETSC_COMM_SELF, request, {});
    } else {
      (void)run::simulate(PETSC_COMM_SELF, request, file, {});
    }
  });
}

std::vector<Target> targets(const Corpus& corpus) {
  const auto references = [](const std::string& file) { (void)cli::read_references(file); };
  const model::Friction friction{1, 0.5};
  return {
      {"options file", ".opts", 22, option_files(), by_text,
       [](const std::string& file) { (void)request_of_file(file); }},
      {"options line", ".txt", 16, option_lines(), by_text,
       [](const std::string& file) { (void)request_of_line(test::content(file)); }},
      {"CSV", ".csv", 14, {kCsv}, by_text, references},
      {"JSON", ".json", 14, {kJson}, by_structure, references},
      {"HDF5", ".h5", 10, {corpus.hdf5()}, by_byte, references},
      {"checkpoint",
       ".checkpoint",
       6,
       {corpus.checkpoint()},
       entries_again,
       [request = Corpus::simulation()](const std::string& file) { go_on_with(request, file); }},
      {"sweep checkpoint",
       ".sweep",
       4,
       {corpus.sweep_checkpoint()},
       entries_again,
       [request = Corpus::sweep()](const std::string& file) { go_on_with(request, file); }},
      {"sweep entry", ".json", 6, corpus.entries(), by_structure, report},
      {"drag",
       ".txt",
       4,
       {"-v", "-v - 0.1*v*abs(v)", "-tanh(v/mu_d) - (v > 0 ? v^2 : 0)"},
       by_text,
       [=](const std::string& file) {
         use(model::parse_drag(test::content(file), friction, 1, 5));
       }},
      {"observable",
       ".txt",
       4,
       {"v^2", "x*v + sin(y)", "|x|<=mu_s", "max(x, v, 1) ^ 2"},
       by_text,
       [=](const std::string& file) {
         (void)model::parse_observable(test::content(file), friction).value(0, 0, 0);
       }}};
}

std::string current;  // what is being read

extern "C" void report_hang(int) {
  bool written = true;
  for (const std::string_view part :
       {std::string_view("hang: "), std::string_view(current), std::string_view("\n")}) {
    written = written && write(STDERR_FILENO, part.data(), part.size()) >= 0;
  }
  _exit(written ? 1 : 2);
}

struct Count {
  int taken = 0, refused = 0, faults = 0;
};

// BadInput, UnfitLaw and what read_references throws end the program with status 2.
void run_one(const Target& target, const std::string& file, Count& count) {
  try {
    target.read(file);
    ++count.taken;
  } catch (const Failure& refusal) {
    const bool explained = refusal.status() == ExitStatus::bad_input && *refusal.what() != '\0';
    ++(explained ? count.refused : count.faults);
    if (!explained) std::cerr << current << ": " << refusal.what() << "\n";
  } catch (const std::invalid_argument&) {
    ++count.refused;
  } catch (const std::exception& fault) {
    ++count.faults;
    std::cerr << current << ": " << fault.what() << "\n";
  }
}

Count feed(const Target& target, std::size_t inputs, std::uint64_t seed,
           const test::TemporaryFolder& folder) {
  constexpr unsigned patience = 60;
  fuzz::Mutator mutator(seed);
  Count count;
  const std::string file = folder / ("input" + target.ending).c_str();
  for (const auto& sound : target.corpus) {  // else nothing is tried but one refusal
    std::ofstream(file, std::ios::binary) << sound;
    target.read(file);
  }
  for (std::size_t n = 0; n < inputs; ++n) {
    const auto pick = [&] { return target.corpus[mutator.below(target.corpus.size())]; };
    const std::string input = target.mutate(mutator, pick(), pick());
    std::ofstream(file, std::ios::binary) << input;
    current = fmt::format("{} {}, {}", target.name, n, file);
    const int faults = count.faults;
    alarm(patience);
    run_one(target, file, count);
    alarm(0);
    if (count.faults == faults) continue;
    std::ofstream(fmt::format("fault-{}-{}{}", seed, n, target.ending), std::ios::binary) << input;
  }
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t inputs = argc > 1 ? std::stoul(argv[1]) : 10000;
  const std::uint64_t seed = argc > 2 ? std::stoul(argv[2]) : 1;
  int petsc_argc = 1;
  const linalg::Session session(petsc_argc, argv);
  generator::register_preconditioners();
  (void)std::signal(SIGALRM, report_hang);
  const test::TemporaryFolder folder;
  std::cout << fmt::format("{:14} {:>7} {:>7} {:>7} {:>7}\n", "input", "all", "taken", "refused",
                           "faults");
  Count sum;
  for (const auto& target : targets(Corpus(folder))) {
    const Count c = feed(target, inputs * target.share / 100, seed, folder);
    const auto all = c.taken + c.refused + c.faults;
    std::cout << fmt::format("{:14} {:7} {:7} {:7} {:7}\n", target.name, all, c.taken, c.refused,
                             c.faults)
              << std::flush;
    sum = {sum.taken + c.taken, sum.refused + c.refused, sum.faults + c.faults};
  }
  std::cout << fmt::format("{:14} {:7} {:7} {:7} {:7}\n", "sum",
                           sum.taken + sum.refused + sum.faults, sum.taken, sum.refused,
                           sum.faults);
  return sum.faults == 0 ? 0 : 1;
}
