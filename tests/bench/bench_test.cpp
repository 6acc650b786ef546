// greenray bench: the contract's keys, and the judgement of --compare. Never how fast.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/record.hpp"
#include "bench/trace_suite.hpp"
#include "support/error.hpp"

namespace greenray::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class BenchFiles : public testing::Test {
 protected:
  void SetUp() override {
    const auto *info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("greenray_bench_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string &name) const { return (folder_ / name).string(); }
  /// Exit code of the tool; its words go to a file.
  int tool(const std::string &arguments) const {
    const int status =
        std::system((std::string(GREENRAY_TOOL) + " bench " + arguments + " > " + path("out") + " 2>&1").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string words() const {
    std::ifstream file(path("out"));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void save(const std::string &name, const Results &results) const { std::ofstream(path(name)) << as_json(results); }

  fs::path folder_;
};

/// Five runs of 1 Mray/s that scatter by 1 %.
Record made_up(const std::string &variant, double rate) {
  Record r;
  r.suite = "trace", r.case_name = "us76", r.variant = variant, r.device = "made up";
  r.kind = {"", "", "closed form", "float", 8};
  r.rate = rate, r.median_rate = 0.99 * rate, r.rate_unit = "ray/s";
  r.error = 0.003, r.error_unit = "arcsec";
  r.cpu_seconds = 2e4 / rate, r.wall_seconds = 1e4 / rate, r.repeats = 5;
  r.more = {{"rays", 1e4}};
  return r;
}

Results made_up_results(double factor) {
  Results results;
  results.about = {{"cpu", "made up"}, {"device", "made up"}, {"threads", "2"}};
  results.records = {made_up("a", 1e6 * factor), made_up("b", 3e5)};
  return results;
}

// oracle: a slow-down of 20 % planted in one of two records; 5 % is let pass, the scatter is 1 %
// tolerance: 5 % limit + 2 % least noise < 20 %; 2 % < 5 %
TEST(Compare, CatchesAPlantedSlowDownAndLetsNoisePass) {
  const Results before = made_up_results(1);
  EXPECT_TRUE(compare(before, made_up_results(0.8), 0.05).worse());
  EXPECT_FALSE(compare(before, made_up_results(0.98), 0.05).worse());
  EXPECT_FALSE(compare(before, made_up_results(1.3), 0.05).worse());
  EXPECT_FALSE(compare(before, made_up_results(0.8), 0.5).worse());
}

// oracle: a run whose best and median differ by 20 % cannot show a slow-down of 10 %
// tolerance: none
TEST(Compare, ARestlessRunIsGivenMoreRoom) {
  const Results before = made_up_results(1);
  Results after = made_up_results(0.9);
  EXPECT_TRUE(compare(before, after, 0.05).worse());
  after.records[0].median_rate = 0.8 * after.records[0].rate;
  EXPECT_FALSE(compare(before, after, 0.05).worse());
}

// oracle: speed bought with three times the error is no gain
// tolerance: the limit of 2
TEST(Compare, SeesLostAccuracy) {
  Results after = made_up_results(2);
  after.records[0].error *= 3;
  const Comparison comparison = compare(made_up_results(1), after, 0.05);
  EXPECT_TRUE(comparison.worse());
  EXPECT_FALSE(comparison.changes[0].slower);
}

// oracle: records without a partner are named, not judged
// tolerance: none
TEST(Compare, NamesRecordsOfOneFileOnly) {
  Results after = made_up_results(1);
  after.records[1].variant = "c";
  const Comparison comparison = compare(made_up_results(1), after, 0.05);
  EXPECT_EQ(comparison.only_old, std::vector<std::string>{"trace | us76 | b"});
  EXPECT_EQ(comparison.only_new, std::vector<std::string>{"trace | us76 | c"});
  EXPECT_FALSE(comparison.worse());
}

Record peer_at(const std::string &variant, double rate, double error) {
  Record r = made_up(variant, rate);
  r.error = error;
  return r;
}

// oracle: by hand: ours has an error of 0.003; of the peer's points at 0.5, 0.004 and 0.001 the one at 0.004 is the
// most
//   accurate that is not more accurate than ours; a fourth, slower and worse than it, must not be chosen
// tolerance: rounding
TEST(FairPeer, IsTheMostAccuratePointNotBeyondOurs) {
  const Record ours = made_up("ours", 1e6);
  const std::vector<Record> points{peer_at("coarse", 4e5, 0.5), peer_at("near", 2e5, 0.004),
                                   peer_at("beaten", 1e5, 0.0035), peer_at("fine", 1.5e5, 0.001)};
  const auto chosen = fair_peer(ours, points);
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->variant, "near");
  EXPECT_DOUBLE_EQ(chosen->ratio, 5);
  EXPECT_FALSE(fair_peer(ours, {points[3]}));  // only a more accurate one: no ratio
}

// oracle: what was written
// tolerance: none
TEST_F(BenchFiles, RecordsSurviveTheFile) {
  Results results = made_up_results(1);
  results.contended = true;
  results.records[0].peer = PeerPoint{"peer", "1.2", "p", 1e5, 0.004, 10, 9};
  save("a.json", results);
  const Results again = read_results(path("a.json"));
  ASSERT_EQ(again.records.size(), 2u);
  EXPECT_TRUE(again.contended);
  EXPECT_EQ(again.about, results.about);
  EXPECT_EQ(again.records[0].rate, results.records[0].rate);
  EXPECT_EQ(again.records[0].peer->ratio, 10);
  EXPECT_EQ(again.records[0].more, results.records[0].more);
  EXPECT_EQ(again.records[0].kind.solver, "closed form");
  EXPECT_EQ(again.records[0].kind.lanes, 8);
  EXPECT_FALSE(again.records[1].peer);
}

// oracle: the documented exit codes: 6 for a slow-down, 0 for none, 2 for a file that is no result
// tolerance: none
TEST_F(BenchFiles, TheToolComparesTwoFiles) {
  save("old.json", made_up_results(1));
  save("slow.json", made_up_results(0.8));
  save("same.json", made_up_results(0.98));
  EXPECT_EQ(tool("--compare " + path("old.json") + " " + path("slow.json")), 6) << words();
  EXPECT_NE(words().find("SLOWER"), std::string::npos);
  EXPECT_EQ(tool("--compare " + path("old.json") + " " + path("same.json")), 0) << words();
  std::ofstream(path("other.json")) << "{\"records\": 3}";
  EXPECT_EQ(tool("--compare " + path("old.json") + " " + path("other.json")), 2) << words();
  EXPECT_EQ(tool("--compare " + path("old.json") + " " + path("none.json")), 2) << words();
}

// oracle: the documented exit code 2; nothing is written
// tolerance: none
TEST_F(BenchFiles, WrongCommandLinesAreRefused) {
  for (const char *wrong : {"photon", "tracer", "trace scenes", "--compare old.json", "trace --repeats 0",
                            "trace --limit 5 --speed", "trace --scale 0", "trace --html page.txt",
                            "trace run.json --html page.html", "run.json", "none.json --csv none.csv"})
    EXPECT_EQ(tool(std::string(wrong) + " --json " + path("none.json")), 2) << wrong << "\n" << words();
  EXPECT_FALSE(fs::exists(path("none.json")));
}

std::vector<Json> chosen(const Json &results, const std::string &key, const std::string &value) {
  std::vector<Json> some;
  for (const Json &r : results.at("records"))
    if (r.at(key) == value) some.push_back(r);
  return some;
}

// oracle: the contract's list of keys; errors that a table of 0.01" and these tolerances cannot exceed
// tolerance: 0.1", ten times the table's error; odeint as it comes has no such bound: it steps over layers
void expect_the_contracts_keys(const Json &results) {
  ASSERT_GE(results.at("records").size(), 4u);
  for (const Json &r : results.at("records")) {
    for (const char *key : {"suite", "case", "variant", "device", "rate", "rate_unit", "error", "error_unit",
                            "cpu_seconds", "wall_seconds", "peer", "peer_version", "peer_rate", "peer_error", "ratio"})
      EXPECT_TRUE(r.contains(key)) << key;
    EXPECT_TRUE(std::isfinite(r.at("error").get<double>()));
    EXPECT_GT(r.at("rate").get<double>(), 0);
    EXPECT_GT(r.at("cpu_seconds").get<double>(), 0);
  }
  for (const Json &r : chosen(results, "suite", "trace")) {
    EXPECT_EQ(r.at("wrong_outcomes"), 0) << r.at("variant");
    EXPECT_LT(r.at("reference_error_arcsec").get<double>(), 1e-6);
    const double bound = r.at("by") == "Boost.odeint dopri5, untuned" ? 1e9 : 0.1;
    EXPECT_LT(r.at("error").get<double>(), bound) << r.at("variant");
  }
}

// oracle: palRefro at its finest tolerance, another's code with another method: the reference of its air is right
// tolerance: 1e-6", ten times what palRefro leaves there
void expect_palRefro_agrees_with_our_reference(const Json &results) {
  for (const Json &r : chosen(results, "by", "PAL palRefro")) {
    EXPECT_EQ(r.at("case"), "pal-air");
    const double bound = r.at("variant") == "palRefro double, tolerance 1e-12" ? 1e-6 : 0.1;
    EXPECT_LT(r.at("error").get<double>(), bound) << r.at("variant");
  }
}

// oracle: one text, two compilers: the native closed form is the device's up to how products are fused
// tolerance: 0.001", the float's own scatter
void expect_the_native_closed_form_is_the_devices(const Json &results) {
  int compared = 0;
  for (const Json &native : chosen(results, "by", "native C++"))
    for (const Json &device : chosen(results, "by", "")) {
      const bool same = native.at("case") == device.at("case") &&
                        native.at("variant") == "native C++ " + device.at("variant").get<std::string>();
      if (!same || device.at("solver") != "closed form") continue;
      EXPECT_NEAR(native.at("error").get<double>(), device.at("error").get<double>(), 0.001) << native.at("variant");
      ++compared;
    }
  EXPECT_TRUE(compared > 0 || chosen(results, "by", "native C++").empty());
}

// oracle: the same samples, each with a ray of its own in double: what the transfer table may add is its look-up's
// error tolerance: 1 % of the picture's own RMS, a few samples on the Sun's edge that fall on its other side
void expect_pictures_like_those_of_their_rays(const Json &results) {
  const std::vector<Json> pictures = chosen(results, "suite", "images");
  ASSERT_EQ(pictures.size(), 3u);
  for (const Json &r : pictures) EXPECT_LT(r.at("error").get<double>(), 0.01) << r.at("variant");
  EXPECT_EQ(pictures[0].at("solver"), "transfer table");
  EXPECT_EQ(pictures[1].at("solver"), "per pixel");
  EXPECT_EQ(pictures[2].at("solver"), "per pixel, steps");
}

// oracle: a case's first record of a method is its own measure; twice the wavelengths are twice the rays
// tolerance: none
void expect_growth_from_the_first_point(const Json &results) {
  for (const char *name : {"rays", "wavelengths"}) {
    const std::vector<Json> all = chosen(results, "case", name);
    ASSERT_EQ(all.size(), 4u) << name;
    EXPECT_EQ(all[0].at("speed_up"), 1) << name;
    EXPECT_EQ(all[1].at("speed_up"), 1) << name;  // the other method's first
  }
  const std::vector<Json> waves = chosen(results, "case", "wavelengths");
  EXPECT_EQ(waves[2].at("rays").get<double>(), 2 * waves[0].at("rays").get<double>());
}

// oracle and tolerance: of each part above. Also: the page made with the run is the page made later from its file.
TEST_F(BenchFiles, AQuickRunOfSuiteTraceIsSound) {
  const int code = tool("trace --quick --quiet --json " + path("a.json") + " --html " + path("a.html"));
  if (code == 3) GTEST_SKIP() << words();
  ASSERT_EQ(code, 0) << words();
  std::ifstream file(path("a.json"));
  const Json results = Json::parse(file);
  expect_the_contracts_keys(results);
  expect_palRefro_agrees_with_our_reference(results);
  expect_the_native_closed_form_is_the_devices(results);
  expect_pictures_like_those_of_their_rays(results);
  expect_growth_from_the_first_point(results);
  ASSERT_EQ(tool(path("a.json") + " --html " + path("b.html") + " --csv " + path("b.csv")), 0) << words();
  const auto text = [&](const std::string &name) {
    std::ifstream in(path(name));
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_EQ(text("a.html"), text("b.html"));
  EXPECT_EQ(text("b.csv"), as_csv(read_results(path("a.json"))));
}

}  // namespace
}  // namespace greenray::bench
