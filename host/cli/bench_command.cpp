// greenray bench: speed against error, ours and the peers', as records others can compare.
#include <algorithm>
#include <ctime>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <thread>

#include "bench/device_methods.hpp"
#include "bench/geometry_suite.hpp"
#include "bench/machine.hpp"
#include "bench/photon_suites.hpp"
#include "bench/ratios.hpp"
#include "bench/record.hpp"
#include "bench/report.hpp"
#include "bench/trace_suite.hpp"
#include "cli/commands.hpp"
#include "support/atomic_file.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

using bench::Record;
using bench::Results;

const std::vector<std::string> suites{"trace", "images", "photons", "gather", "geometry", "scenes", "eye", "all"};
const char *const suite_words = "trace | images | photons | gather | geometry | scenes | eye | all";

struct Request {
  std::string suite;     // "": only compare
  std::string new_file;  // "": the run's own records
};

bool has(const std::vector<std::string> &list, const std::string &word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

bool shows_a_file(const Arguments &a) { return a.has("--html") || a.has("--csv"); }

/// `bench`, `bench SUITE`, `bench --compare OLD NEW`, `bench SUITE --compare OLD`, `bench RUN.json --html PAGE.html`.
Request request_from(const Arguments &a) {
  Request request;
  for (std::size_t i = 0; i < a.positional().size(); ++i) {
    const std::string &word = a.positional()[i];
    if (has(suites, word) && request.suite.empty()) request.suite = word;
    else if (request.new_file.empty() &&
             (a.has("--compare") || (shows_a_file(a) && word.find('.') != std::string::npos)))
      request.new_file = word;
    else
      throw InputError(a.positional_place(i),
                       "'" + word + "': expected a suite, " + suite_words + did_you_mean(word, suites));
  }
  if (!request.suite.empty() && !request.new_file.empty())
    throw InputError(a.positional_place(1), "expected either a suite to run or a file of an earlier run, not both");
  if (!a.has("--compare") && request.suite.empty() && request.new_file.empty()) request.suite = "all";
  if (a.has("--compare") && request.suite.empty() && request.new_file.empty())
    a.fail("--compare", "expected two files, OLD.json NEW.json, or a suite to run and compare with OLD.json");
  return request;
}

std::vector<bench::Method> peer_methods(unsigned threads, bool few) {
  std::vector<bench::Method> methods;
  const auto add = [&](std::vector<bench::Method> more) {
    methods.insert(methods.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
#ifdef GREENRAY_BENCH_NATIVE
  add(bench::native_methods(threads, few));
#endif
#ifdef GREENRAY_BENCH_ODEINT
  add(bench::odeint_methods(threads, few));
  add(bench::untuned_odeint_methods(threads, few));
#endif
#ifdef GREENRAY_BENCH_PAL
  add(bench::pal_methods(threads, few));
#endif
  (void)add;
  (void)threads, (void)few;
  return methods;
}

std::vector<bench::NeighbourPeer> neighbour_peers(bool few) {
#ifdef GREENRAY_BENCH_NANOFLANN
  return bench::nanoflann_peers(few);
#else
  (void)few;
  return {};
#endif
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
    if (r.suite == "images" && r.kind.solver == "transfer table" && r.number("samples_per_pixel") == 1)
      text << " | " << r.case_name << " " << r.wall_seconds << " s";
    else if (r.suite == "scenes" && r.more.count("claimed_rms"))
      text << " | " << r.case_name << "@" << 100 * r.error << "% " << r.wall_seconds << " s";
    else if (r.suite == "scenes" || r.suite == "eye") text << " | " << r.case_name << " " << r.wall_seconds << " s";
  text << " | +-" << std::setprecision(2) << 100 * spread << " %";
  if (results.contended) text << " | contended: do not publish";
  return text.str();
}

std::string fixed(double value) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << value;
  return text.str();
}

/// "2026-11-24 04:30 UTC"
std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
  return text;
}

bench::MakeSegmentPeer segment_peer() {
#ifdef GREENRAY_BENCH_EMBREE
  return bench::embree_peer;
#else
  return {};
#endif
}

Results run_suites(const Request &request, const Arguments &a) {
  bench::SuiteOptions options;
  options.quick = a.has("--quick");
  options.repeats = static_cast<int>(a.optional_number("--repeats", 1, 1000, "runs").value_or(options.quick ? 1 : 7));
  options.only = a.text("--only");
  if (a.has("--scale"))
    for (const double threads : a.list("--scale", 1, 65536, "threads"))
      options.scale.push_back(static_cast<unsigned>(threads));
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
  const auto run = [&](const std::vector<std::string> &names, auto suite) {
    if (!has(names, request.suite)) return;
    std::vector<Record> records = suite();
    std::move(records.begin(), records.end(), std::back_inserter(results.records));
  };
  run({"trace", "all"}, [&] { return run_trace_suite(options, peer_methods(options.threads, options.quick)); });
  run({"trace", "images", "all"}, [&] { return run_images_suite(options); });
  run({"photons", "all"}, [&] { return run_photons_suite(options, neighbour_peers(options.quick)); });
  run({"geometry", "all"}, [&] { return run_geometry_suite(options, segment_peer()); });
  run({"gather", "all"}, [&] { return run_gather_suite(options, neighbour_peers(options.quick)); });
  run({"scenes", "all"}, [&] { return run_scenes_suite(options); });
  run({"eye", "all"}, [&] { return run_eye_suite(options); });
  const double others = neighbours.cores();
  results.contended = others > 0.05 * cores;
  results.about = {{"version", version()},
                   {"device", bench::device_words(*device)},
                   {"device_type", device->info().is_cpu   ? "cpu"
                                   : device->info().is_gpu ? "gpu"
                                                           : "other"},
                   {"date", utc_now()},
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
  AtomicFileSet files;  // can they be written? known before the work
  AtomicFile *json = a.has("--json") ? &files.add(a.text("--json")) : nullptr;
  AtomicFile *csv = a.has("--csv") ? &files.add(a.file("--csv", ".csv")) : nullptr;
  AtomicFile *html = a.has("--html") ? &files.add(a.file("--html", ".html")) : nullptr;
  const Results now = request.suite.empty() ? bench::read_results(request.new_file) : run_suites(request, a);
  if (json) json->write(as_json(now));
  if (csv) csv->write(as_csv(now));
  if (html) html->write(as_html(now));
  files.commit();
  if (!request.suite.empty()) std::cout << text_of(ratios_of(now)) << now.summary << std::endl;
  if (!before) return 0;
  const bench::Comparison comparison = compare(*before, now, limit);
  std::cout << text_of(comparison, limit);
  return comparison.worse() ? static_cast<int>(ExitCode::different) : 0;
}

/// The common flags, but --json names a file here.
std::vector<Flag> flags() {
  std::vector<Flag> list{
      {"--json", "", "FILE", "the records, for programs and --compare"},
      {"--csv", "", "FILE.csv", "the records as a table"},
      {"--html", "", "FILE.html",
       "the run as a page with plots; of a run already written, when RUN.json is the next word"},
      {"--compare", "", "OLD.json", "hold NEW.json (the next word), or this run, against OLD.json: exit 6 if slower"},
      {"--limit", "", "PCT", "slow-down that --compare lets pass, beyond the noise (5)"},
      {"--repeats", "", "N", "timed runs of each method, in turn; the best counts (7)"},
      {"--only", "", "WORDS", "suite trace: just the methods with these words in their variant"},
      {"--scale", "", "LIST", "suite trace: thread counts to compare, by device fission (1 and all)"},
      {"--quick", "", "", "few rays and settings: does it work? not: how fast"}};
  for (Flag &flag : common_flags())
    if (flag.name != "--json") list.push_back(std::move(flag));
  return list;
}

}  // namespace

Command bench_command() {
  return {{"bench", "[SUITE] [NEW.json]",
           std::string("Speed against error, beside peers in the same run: ") + suite_words + ".", flags()},
          run};
}

}  // namespace greenray::cli
