// greenray bench: speed against error, ours and the peers', as records others can compare.
#include <algorithm>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <thread>

#include "bench/device_methods.hpp"
#include "bench/machine.hpp"
#include "bench/record.hpp"
#include "bench/trace_suite.hpp"
#include "cli/commands.hpp"
#include "support/atomic_file.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

using bench::Record;
using bench::Results;

const std::vector<std::string> suites{"trace", "scenes", "eye", "all"};
const std::vector<std::string> later_suites{"photons", "gather", "geometry"};

struct Request {
  std::string suite;     // "": only compare
  std::string new_file;  // "": the run's own records
};

bool has(const std::vector<std::string> &list, const std::string &word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

/// `bench`, `bench SUITE`, `bench --compare OLD NEW`, `bench SUITE --compare OLD`.
Request request_from(const Arguments &a) {
  Request request;
  for (std::size_t i = 0; i < a.positional().size(); ++i) {
    const std::string &word = a.positional()[i];
    if (has(later_suites, word))
      throw InputError(a.positional_place(i),
                       "suite '" + word + "' is not built yet in this version: expected trace | scenes | eye | all");
    if (has(suites, word) && request.suite.empty()) request.suite = word;
    else if (a.has("--compare") && request.new_file.empty()) request.new_file = word;
    else
      throw InputError(a.positional_place(i),
                       "'" + word + "': expected a suite, trace | scenes | eye | all" + did_you_mean(word, suites));
  }
  if (!request.suite.empty() && !request.new_file.empty())
    throw InputError(a.positional_place(1),
                     "expected either a suite to run or two files to compare, OLD.json NEW.json");
  if (!a.has("--compare") && request.suite.empty()) request.suite = "all";
  if (a.has("--compare") && request.suite.empty() && request.new_file.empty())
    a.fail("--compare", "expected two files, OLD.json NEW.json, or a suite to run and compare with OLD.json");
  return request;
}

std::vector<bench::Method> peer_methods(unsigned threads, bool few) {
  std::vector<bench::Method> methods;
#ifdef GREENRAY_BENCH_NATIVE
  methods = bench::native_methods(threads, few);
#endif
#ifdef GREENRAY_BENCH_ODEINT
  const std::vector<bench::Method> odeint = bench::odeint_methods(threads, few);
  methods.insert(methods.end(), odeint.begin(), odeint.end());
#endif
  (void)threads, (void)few;
  return methods;
}

/// Fastest of our records that is at least so accurate.
const Record *fastest(const std::vector<Record> &records, const std::string &case_name, double error) {
  const Record *best = nullptr;
  for (const Record &r : records)
    if (r.case_name == case_name && r.more.count("kernel_rate") && r.more.at("wrong_outcomes") == 0 &&
        r.error <= error && (!best || r.rate > best->rate))
      best = &r;
  return best;
}

std::string summary_of(const Results &results) {
  std::ostringstream text;
  text << std::setprecision(3) << "greenray-bench 1 | " << results.about.at("device") << " | "
       << results.about.at("cpu");
  double spread = 0;
  for (const Record &r : results.records)
    spread = std::max(spread, r.suite == "trace" && !r.more.count("kernel_rate") ? 0 : r.spread());
  for (const char *name : {"us76", "thin-5K"})
    for (double error : {0.01, 0.003})
      if (const Record *r = fastest(results.records, name, error)) {
        text << " | " << name << "@" << error << "\" " << r->rate / 1e6 << " Mray/s";
        if (r->peer) text << " (" << r->peer->ratio << "x odeint)";
      }
  for (const Record &r : results.records)
    if (r.suite == "scenes" || r.suite == "eye") text << " | " << r.case_name << " " << r.wall_seconds << " s";
  text << " | +-" << std::setprecision(2) << 100 * spread << " %";
  if (results.contended) text << " | contended: do not publish";
  return text.str();
}

std::string fixed(double value) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << value;
  return text.str();
}

Results run_suites(const Request &request, const Arguments &a) {
  bench::SuiteOptions options;
  options.quick = a.has("--quick");
  options.repeats = static_cast<int>(a.optional_number("--repeats", 1, 1000, "runs").value_or(options.quick ? 1 : 7));
  options.only = a.text("--only");
  options.device = device_options(a);
  const std::shared_ptr<Device> device = open_device(options.device);
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  options.threads = device->info().is_cpu ? std::max(1u, device->info().compute_units) : cores;
  if (!a.has("--quiet")) {
    options.say = [](const std::string &what) { std::cerr << "\r\033[K" << what << std::flush; };
    options.done = [](const Record &r) { std::cerr << "\r\033[K" << std::flush, std::cout << line_of(r) << std::endl; };
  }

  Results results;
  const double load = bench::load_average();
  const bench::Neighbours neighbours;
  const auto wanted = [&](const char *suite) { return request.suite == suite || request.suite == "all"; };
  if (wanted("trace")) results.records = run_trace_suite(options, peer_methods(options.threads, options.quick));
  if (wanted("scenes")) {
    const std::vector<Record> scenes = run_scenes_suite(options);
    results.records.insert(results.records.end(), scenes.begin(), scenes.end());
  }
  if (wanted("eye")) {
    const std::vector<Record> eye = run_eye_suite(options);
    results.records.insert(results.records.end(), eye.begin(), eye.end());
  }
  const double others = neighbours.cores();
  results.contended = load > 0.5 * cores || others > 0.1 * cores;
  results.about = {{"version", version()},
                   {"device", bench::device_words(*device)},
                   {"cpu", bench::cpu_name()},
                   {"clock_MHz", fixed(bench::clock_MHz())},
                   {"threads", std::to_string(options.threads)},
                   {"cores", std::to_string(cores)},
                   {"load_before", fixed(load)},
                   {"load_after", fixed(bench::load_average())},
                   {"cores_busy_with_others", fixed(others)},
                   {"compiler", __VERSION__},
                   {"repeats", std::to_string(options.repeats)},
                   {"quick", options.quick ? "yes" : "no"}};
  results.summary = summary_of(results);
  return results;
}

int run(const Arguments &a) {
  const Request request = request_from(a);
  const double limit = a.optional_number("--limit", 0, 90, "percent").value_or(5) / 100;
  std::optional<Results> before;
  if (a.has("--compare")) before = bench::read_results(a.text("--compare"));
  Results now;
  if (!request.suite.empty()) {
    std::optional<AtomicFile> file;
    if (a.has("--json")) file.emplace(a.text("--json"));  // can it be written? known before the work
    now = run_suites(request, a);
    if (file) file->write(as_json(now)), file->commit();
    std::cout << now.summary << std::endl;
  } else {
    now = bench::read_results(request.new_file);
  }
  if (!before) return 0;
  const bench::Comparison comparison = compare(*before, now, limit);
  std::cout << text_of(comparison, limit);
  return comparison.worse() ? static_cast<int>(ExitCode::different) : 0;
}

/// The common flags, but --json names a file here.
std::vector<Flag> flags() {
  std::vector<Flag> list{
      {"--json", "", "FILE", "write the records here"},
      {"--compare", "", "OLD.json", "hold NEW.json (the next word), or this run, against OLD.json: exit 6 if slower"},
      {"--limit", "", "PCT", "slow-down that --compare lets pass, beyond the noise (5)"},
      {"--repeats", "", "N", "timed runs of each method, in turn; the best counts (7)"},
      {"--only", "", "WORDS", "suite trace: just the methods with these words in their variant"},
      {"--quick", "", "", "few rays and settings: does it work? not: how fast"}};
  for (Flag &flag : common_flags())
    if (flag.name != "--json") list.push_back(std::move(flag));
  return list;
}

}  // namespace

Command bench_command() {
  return {{"bench", "[SUITE] [NEW.json]",
           "Speed against error, beside peers in the same run: trace | scenes | eye | all.", flags()},
          run};
}

}  // namespace greenray::cli
