#include "program.hpp"

#include <fmt/format.h>
#include <mpi.h>
#include <nlohmann/json.hpp>
#include <petscsys.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "stickslip/base/errors.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/cli/help.hpp"
#include "stickslip/cli/output.hpp"
#include "stickslip/cli/reports.hpp"
#include "stickslip/cli/request.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/linalg/solver_options.hpp"
#include "stickslip/run/carry_out.hpp"

namespace stickslip::cli {
namespace {

// Many cases in one process, each with a command line of its own.

/// How a run ended: its exit status, and what went wrong.
struct Ending {
  int status = 0;
  std::string message = {};
  bool alike = true;  ///< whether all ranks end so
};

/// Takes a report to where it goes. The report refers to what ends after the call.
using Emit = std::function<void(Report, const Request&)>;

/// Runs what the words of a command line and PETSc's options ask for, under a started PETSc.
using Run = std::function<Ending(const std::vector<std::string>& words, const Emit&)>;

using Words = std::vector<std::string>;

// What a line asks for that is no case: texts, and options that count when the program starts.
void refuse_others(const Words& line) {
  for (const char* word :
       {"-cases", "-help", "--help", "-h", "-version", "--version", "-reference", "-reference_json",
        "-reference_quantities", "-man_page", "-completion", "-help_solvers", "-log_view"}) {
    if (std::find(line.begin(), line.end(), word) == line.end()) continue;
    throw BadInput(fmt::format("{}: is no option of a case; give it to the program", word));
  }
}

Words words_of(const Words& common, const std::string& line) {
  auto own = quoted_words(line);
  if (!own) throw BadInput(fmt::format("{}: a quote is not closed; write \"...\" or '...'", line));
  refuse_others(*own);
  own->insert(own->begin(), common.begin(), common.end());
  shield_formulas(*own);
  check_options_files(*own);
  return *own;
}

// The summary goes to `answer`, files to where they belong, and nothing else to standard output.
Ending run_line(const Words& common, const std::string& line, const Run& run, Json& answer) {
  try {
    const Words words = words_of(common, line);
    const linalg::OptionsOf options(words);
    (void)linalg::option_value("cases");  // among those of the command line, and used
    return run(words, [&answer](Report report, const Request& request) {
      report.text.clear();
      write_all(report, request.files.written);
      answer.update(summary_of(report));
    });
  } catch (const BadInput& bad) {
    return {static_cast<int>(bad.status()), bad.what()};
  }
}

BadInput unreadable(const std::string& file) {
  return BadInput(fmt::format("-cases = {}: cannot be read; name a file of lines such as -mu_d 0.5 "
                              "-tau 2, or - for standard input",
                              file));
}

/// Runs a case for each line of a file, or of standard input for "-", one after the other: its
/// options are the words `common` and those of the line. Each is answered on standard output by a
/// line of JSON: its exit status, and what -summary writes or what went wrong. A case that fails
/// leaves the others alone. Returns the largest status. Not for several ranks. Throws BadInput
/// where there is no such file.
int run_cases(const Words& common, const std::string& file, const Run& run) {
  if (linalg::ranks(MPI_COMM_WORLD) > 1) {
    throw BadInput("-cases: runs on one rank; start the program once for each core instead");
  }
  std::ifstream opened;
  if (file != "-") opened.open(file);
  if (file.empty() || !opened) throw unreadable(file);
  std::istream& lines = file == "-" ? std::cin : opened;
  int largest = 0;
  for (std::string line; std::getline(lines, line);) {
    Json answer{{"status", 0}};
    const Ending ending = run_line(common, line, run, answer);
    answer["status"] = ending.status;
    if (!ending.message.empty()) answer["message"] = ending.message;
    print(answer.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
    largest = std::max(largest, ending.status);
  }
  if (lines.bad()) throw unreadable(file);  // as a folder is
  return largest;
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void print_error(const std::string& text) {
  std::fputs((text + "\n").c_str(), stderr);
  std::fflush(stderr);
}

// Signals by which a terminal, a limit of processor time or a batch system ends a run.
struct RequestToEnd {
  int signal;
  const char* name;
};
constexpr RequestToEnd kRequestsToEnd[] = {
    {SIGINT, "SIGINT"}, {SIGTERM, "SIGTERM"}, {SIGXCPU, "SIGXCPU"}};
std::chrono::steady_clock::time_point program_start;

// Says in one line what ends the program, and ends it as the signal does. With functions that a
// signal may call, and the digits of the seconds by hand.
void end_by_signal(int signal) {
  char line[160] = "stickslip: ended by ";
  std::size_t size = std::strlen(line);
  const auto add = [&](const char* text) {
    while (*text != 0 && size < sizeof line) line[size++] = *text++;
  };
  for (const auto& request : kRequestsToEnd) {
    if (request.signal == signal) add(request.name);
  }
  char digits[24] = "";
  char* first = digits + sizeof digits - 1;
  auto seconds = static_cast<long>(seconds_since(program_start));
  do *--first = static_cast<char>('0' + seconds % 10);
  while ((seconds /= 10) > 0);
  add(" after ");
  add(first);
  add(" s, before its results were complete; files that exist are whole\n");
  if (write(STDERR_FILENO, line, size) < 0) std::_Exit(static_cast<int>(ExitStatus::other));
  std::raise(signal);  // whose action is the usual one again
}

// On the first rank alone: mpiexec tells all of them. What nohup and shells let a process ignore
// stays so.
void tell_of_signals() {
  if (linalg::rank(MPI_COMM_WORLD) != 0) return;
  for (const auto& request : kRequestsToEnd) {
    struct sigaction action = {}, before = {};
    action.sa_handler = end_by_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(request.signal, &action, &before);
    if (before.sa_handler == SIG_IGN) sigaction(request.signal, &before, nullptr);
  }
}

bool contains(const std::vector<std::string>& words, const char* word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Texts that need neither PETSc nor model parameters; empty when none is asked for.
std::string text_asked_for(const std::vector<std::string>& words) {
  const auto asked = [&](const char* word) { return contains(words, word); };
  if (asked("-help") || asked("--help") || asked("-h") || asked("-?")) return help_text();
  if (asked("-version") || asked("--version")) return version_text();
  if (asked("-reference")) return reference_page();
  if (asked("-reference_json")) return reference_json();
  if (asked("-reference_quantities")) return quantity_tables();
  if (asked("-man_page")) return man_page(version_number());
  if (asked("-completion")) return completion();
  return "";
}

// Adds what the machine gives reason for.
void warn(Request& request) {
  const auto blas = linalg::loaded_blas();
  if (blas.reference) {
    request.warnings.push_back("slow BLAS in use (" + blas.library +
                               "); factorisations take several times longer than with OpenBLAS, "
                               "which `apt install libopenblas0-pthread` provides");
  }
  if (linalg::rank(MPI_COMM_WORLD) != 0) return;
  for (const auto& warning : request.warnings) print_error("stickslip: " + warning);
}

// Standard error may be a terminal on some ranks alone, so that the first one decides for all.
run::Progress progress_of(MPI_Comm comm, const Request& request) {
  int shown = request.files.progress ? 1 : 0;
  MPI_Bcast(&shown, 1, MPI_INT, 0, comm);
  if (shown == 0) return {};
  return [&request, first = linalg::rank(comm) == 0](int step, const run::Resolution& r,
                                                     double seconds) {
    if (!first) return;
    std::string velocity = "no grid in v";
    if (r.scheme == cases::Scheme::hp) velocity = fmt::format("degree {}", r.degree);
    if (r.scheme == cases::Scheme::upwind) velocity = fmt::format("p = {}", r.points);
    const std::string time = seconds < 1 ? "" : fmt::format(", about {:.0f} s", seconds);
    print_error(fmt::format("refinement level {}: {}, {} noise levels on each side, {} unknowns{}",
                            step + 1, velocity, r.levels, run::unknowns(request.scene, r), time));
  };
}

run::SimulationProgress simulation_progress_of(const Request& request) {
  if (!request.files.progress) return {};
  return [](const run::SimulationState& s) {
    const double share = 100 * s.excursions / s.wanted;
    print_error(fmt::format(
        "simulated {:.3g} of {:.3g} excursions ({:.0f} %), {:.2g} jumps/s, about {:.0f} "
        "s left",
        s.excursions, s.wanted, share, s.jumps / s.seconds, s.seconds_left));
  };
}

int status_of(const run::Outcome& outcome) {
  const auto& comparison = outcome.comparison;
  const bool agrees = !comparison || (!comparison->disagrees && !comparison->rows.empty());
  return static_cast<int>(outcome.reached && agrees ? ExitStatus::done : ExitStatus::not_reached);
}

run::StudyProgress study_progress_of(const Request& request, bool first_rank) {
  if (!request.files.progress || !first_rank) return {};
  return [start = Clock::now()](int number, int count, const std::string& what) {
    print_error(fmt::format("study, run {} of {}: {} ({:.0f} s so far)", number, count, what,
                            seconds_since(start)));
  };
}

// When a run began, and what the program took before [s].
struct Beginning {
  Clock::time_point start = Clock::now();
  double start_up = 0;

  [[nodiscard]] RunTimes until_now() const { return {start_up, start_up + seconds_since(start)}; }
};

int run_study(const Request& request, const Beginning& beginning, const Emit& emit) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const auto study = run::run_study(comm, request, request.study,
                                    study_progress_of(request, linalg::rank(comm) == 0));
  emit(report_of(comm, request, study, beginning.until_now()), request);
  return static_cast<int>(study.complete ? ExitStatus::done : ExitStatus::not_reached);
}

int report_plan(const Request& request, const Emit& emit) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const auto prediction = run::predict(comm, request);
  emit(report_of(comm, request, prediction), request);
  if (!prediction.shortfall.empty()) throw NoMemory(prediction.shortfall);
  return 0;
}

SweepProgress sweep_progress_of(const Request& request) {
  if (!request.files.progress) return {};
  return [&request, last = Clock::time_point()](const State& s) mutable {
    if (s.status == "reached" && s.done < s.count && seconds_since(last) < 1) return;
    last = Clock::now();
    print_error(fmt::format("{} of {} points; {}: {} after {:.2g} s; about {:.0f} s left", s.done,
                            s.count, request.sweep->place(s.point), s.status, s.seconds_of_point,
                            s.seconds_left));
  };
}

int run_sweep(const Request& request, const Beginning& beginning, const Emit& emit) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const auto sweep = run_sweep(comm, request, sweep_progress_of(request));
  int status = exit_status(sweep.runs);
  if (linalg::rank(comm) == 0) {
    emit(report_of(comm, request, sweep, beginning.until_now()), request);
    if (status != 0)
      print_error(
          "stickslip: some points have no results, or missed the accuracy; the table lists them");
  }
  MPI_Bcast(&status, 1, MPI_INT, 0, comm);
  return status;
}

int compute(const Request& request, const Beginning& beginning, const Emit& emit) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  auto outcome = run::carry_out(comm, request, progress_of(comm, request),
                                simulation_progress_of(request), request.files.checkpoint);
  if (outcome.attainable > 0) {
    outcome.shortfall += run::tried_accuracy(comm, request, outcome);
  }
  emit(report_of(comm, request, outcome, beginning.until_now()), request);
  return status_of(outcome);
}

/// What is wrong where ranks were started with different words (`mpiexec -n 1 ... : -n 1 ...`):
/// they would wait for one another for ever. Empty if nothing is. Collective.
std::string difference_of_options(MPI_Comm comm) {
  const std::string own = linalg::options_text();
  if (linalg::first_text(comm, own) == own) return "";
  return fmt::format("rank {} has other options than rank 0; start all ranks with the same",
                     linalg::rank(comm));
}

/// The request, or BadInput on all ranks with the message of the first that found any: files may
/// look different from another machine, or a moment later. Collective.
Request agreed_request(const std::vector<std::string>& words) {
  Request request;
  std::string problem = difference_of_options(MPI_COMM_WORLD);
  try {
    if (problem.empty()) request = read_request(words);
  } catch (const BadInput& bad) {
    problem = bad.what();
  }
  problem = linalg::first_text(MPI_COMM_WORLD, problem);
  if (!problem.empty()) throw BadInput(problem);
  return request;
}

/// The status that the work returns, or what its error says. Bad input is found on all ranks alike;
/// any other error may be known to one rank alone.
Ending ending_of(const std::function<int()>& work) {
  const auto status = [](ExitStatus s) { return static_cast<int>(s); };
  try {
    return {work()};
  } catch (const BadInput& failure) {
    return {status(failure.status()), failure.what()};
  } catch (...) {
    const Failure failure = linalg::failure_in_flight();
    return {status(failure.status()), failure.what(), false};
  }
}

// Without the ends of MPI and HDF5, which would wait for other ranks, or write once more to a disk
// that is full.
[[noreturn]] void end_at_once(int status) {
  std::fflush(nullptr);
  if (linalg::under_mpiexec()) MPI_Abort(MPI_COMM_WORLD, status);
  std::_Exit(status);
}

Ending carry_out(const std::vector<std::string>& words, const Beginning& beginning,
                 const Emit& emit) {
  return ending_of([&] {
    auto request = agreed_request(words);
    warn(request);
    if (request.plan_only) return report_plan(request, emit);
    const bool study = request.study.kind != run::StudyKind::none;
    if (study) return run_study(request, beginning, emit);
    if (request.sweep) return run_sweep(request, beginning, emit);
    return compute(request, beginning, emit);
  });
}

/// Runs under a started PETSc. An error that may be known to one rank alone ends all of them.
int run_session(const std::vector<std::string>& words, double start_up) {
  Ending ending;
  if (const auto file = linalg::option_value("cases")) {
    const auto run = [](const std::vector<std::string>& own, const Emit& emit) {
      return carry_out(own, Beginning{}, emit);
    };
    ending = ending_of([&] { return run_cases(words, *file, run); });
  } else {
    const auto write = [](const Report& report, const Request& request) {
      write_all(report, request.files.written);
    };
    ending = carry_out(words, Beginning{.start_up = start_up}, write);
  }
  const bool reports = !ending.alike || linalg::rank(MPI_COMM_WORLD) == 0;
  if (reports && !ending.message.empty()) print_error("stickslip: " + ending.message);
  if (ending.alike) return ending.status;
  end_at_once(ending.status);
}

}  // namespace

int run(int argc, char** argv) {
  const auto start = Clock::now();
  linalg::restart_with_one_blas_thread(argv);
  std::vector<std::string> words(argv + 1, argv + argc);
  shield_formulas(words);
  const std::string text = text_asked_for(words);
  if (!text.empty()) {
    const bool printed = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    return static_cast<int>(printed ? ExitStatus::done : ExitStatus::other);
  }
  try {
    check_options_files(words);
    std::vector<char*> arguments{argv[0]};
    for (auto& word : words) arguments.push_back(word.data());
    char** values = arguments.data();
    const linalg::Session session(argc, values);
    program_start = start;
    tell_of_signals();
    linalg::keep_blas_to_one_thread();
    generator::register_preconditioners();
    if (contains(words, "-help_solvers")) {
      linalg::print_linear_solver_options("slide_");
      return static_cast<int>(ExitStatus::done);
    }
    return run_session(words, seconds_since(start));
  } catch (const Failure& failure) {
    print_error(fmt::format("stickslip: {}", failure.what()));
    return static_cast<int>(failure.status());
  } catch (const std::exception& failure) {
    print_error(fmt::format("stickslip: {}", failure.what()));
    return static_cast<int>(ExitStatus::bad_input);
  }
}

}  // namespace stickslip::cli
