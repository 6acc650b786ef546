// Sweeps and lists as a user makes them: the pictures of `render`, each once; failures told, interrupts survived.
#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

namespace greenray::cli_tests {
namespace {

using Json = nlohmann::json;

const std::string sweep = "[[sweep]]\nkey = \"sun.apparent_altitude_deg\"\nvalues = [0.3, 0.2, 0.1]\n";

class Batch : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write(folder / "s.toml", small_scene + sweep);
  }
  std::vector<std::string> statuses(const std::string &lines) const {
    std::vector<std::string> all;
    for (const std::string &line : lines_of(lines)) {
      const Json event = Json::parse(line);
      if (event["event"] == "picture") all.push_back(event["status"]);
    }
    return all;
  }
};

// oracle: `render` of the same scene with the same value, which shares no rays with a picture before; two pictures at a
// time tolerance: none: every value and byte
TEST_F(Batch, MakesThePicturesThatRenderMakes) {
  const Outcome made = run({"batch", "s.toml", "-o", "b", "--json"});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(statuses(made.out), std::vector<std::string>(3, "done"));
  ASSERT_EQ(run({"render", "s.toml", "-D", "sun.apparent_altitude_deg=0.2", "-o", "one.exr", "-q"}).code, 0);
  EXPECT_EQ(contents(folder / "b/s-0002.png"), contents(folder / "one.png"));
  const Outcome same = run({"compare", "b/s-0002.exr", "one.exr", "--max-rms", "0", "--json"});
  EXPECT_EQ(same.code, 0) << same.out;
  EXPECT_NE(contents(folder / "b/s-0001.png"), contents(folder / "b/s-0002.png"));
  ASSERT_EQ(run({"batch", "s.toml", "-o", "two", "-q", "-j", "2"}).code, 0);
  for (const char *png : {"s-0001.png", "s-0002.png", "s-0003.png", "s-sheet.png"})
    EXPECT_EQ(contents(folder / "two" / png), contents(folder / "b" / png)) << png;
  EXPECT_EQ(listing(folder / "b").size(), 10U) << "three pictures of three files, and the sheet";
}

// oracle: `render` of the same value: a key that bends the rays of sight must not take those of the frame before
// tolerance: none, byte for byte
TEST_F(Batch, SharesNoRaysThatDiffer) {
  for (const std::string key : {"observer.height_m", "observer.altitude_deg", "tracing.table_arcsec",
                                "atmosphere.exaggerate", "atmosphere.radius_km"}) {
    const std::string last = key == "atmosphere.radius_km" ? "3000" : key == "observer.altitude_deg" ? "0.4" : "0.5";
    write(folder / "k.toml",
          std::string(small_scene) + "[[sweep]]\nkey = \"" + key + "\"\nvalues = [1, " + last + "]\n");
    if (key == "atmosphere.radius_km")
      write(folder / "k.toml", std::string(small_scene) + "[[sweep]]\nkey = \"" + key + "\"\nvalues = [6371, 3000]\n");
    ASSERT_EQ(run({"batch", "k.toml", "-o", "k", "-q", "-D", "sun.altitude_deg=-0.3"}).code, 0) << key;
    ASSERT_EQ(
        run({"render", "k.toml", "-D", "sun.altitude_deg=-0.3", "-D", key + "=" + last, "-o", "one.exr", "-q"}).code,
        0);
    EXPECT_EQ(contents(folder / "k/k-0002.png"), contents(folder / "one.png")) << key;
    fs::remove_all(folder / "k");
  }
}

// oracle: the page for users: jobs already done are skipped; a changed key, flag or lost file makes a picture anew
// tolerance: none
TEST_F(Batch, SkipsWhatIsDone) {
  ASSERT_EQ(run({"batch", "s.toml", "-o", "b", "-q"}).code, 0);
  const auto before = listing(folder / "b");
  EXPECT_EQ(statuses(run({"batch", "s.toml", "-o", "b", "--json"}).out), std::vector<std::string>(3, "skipped"));
  EXPECT_EQ(listing(folder / "b"), before);
  fs::remove(folder / "b/s-0002.png");
  EXPECT_EQ(statuses(run({"batch", "s.toml", "-o", "b", "--json"}).out),
            (std::vector<std::string>{"skipped", "done", "skipped"}));
  for (const Words &change : {Words{"-D", "observer.height_m=3"}, Words{"--spp", "2"}, Words{"--seed", "7"}}) {
    Words words{"batch", "s.toml", "-o", "b", "--json"};
    words.insert(words.end(), change.begin(), change.end());
    EXPECT_EQ(statuses(run(words).out), std::vector<std::string>(3, "done")) << change[0];
  }
}

// oracle: the page for users: failed ones are listed at the end and give exit 1; the others are made
// tolerance: none
TEST_F(Batch, GoesOnAfterAFailure) {
  // from 2 m the sea horizon is at -0.04 deg: no Sun is seen at -1
  write(folder / "jobs.csv", "scene,name,sun.apparent_altitude_deg\ns.toml,low,-1\ns.toml,high,0.3\n");
  const Outcome made = run({"batch", "jobs.csv", "-o", "b"});
  EXPECT_EQ(made.code, 1) << made.out;
  EXPECT_NE(made.err.find("failed   jobs.csv:2:1: low: "), std::string::npos) << made.err;
  EXPECT_TRUE(fs::exists(folder / "b/high.exr"));
  EXPECT_EQ(listing(folder / "b").size(), 3U);
}

// oracle: the contract: wrong input is exit 2, all of it told, and nothing is written
// tolerance: none
TEST_F(Batch, RefusesAWrongListBeforeTheFirstPicture) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"scene,observer.height_m\ns.toml,3\ns.toml,-3\n", "-D observer.height_m=-3:1:19: l-0002:"},
      {"scene,observer.heigth_m\ns.toml,3\n", "did you mean 'height_m'"},
      {"scene,name\ns.toml,a\ns.toml,a\n", "l.csv:3:1: the name 'a' is there twice"},
      {"scene,name\ns.toml,../a\n", "l.csv:2:1: '../a': expected a name without a slash"},
      {"scene,name\ns.toml\n", "l.csv:2:1: expected 2 cells"},
      {"name\na\n", "l.csv:1:1: expected a column 'scene'"},
      {"scene\nnosuch\n", "l.csv:2:1: l-0001: 'nosuch' is neither"},
      {"scene,name\n\"s.toml,a\n", "l.csv:2:1: expected a closing quote"},
      {"# nothing\n", "l.csv:1:1: expected at least one row"}};
  for (const auto &[text, says] : wrong) {
    write(folder / "l.csv", text);
    const Outcome refused = run({"batch", "l.csv", "-o", "b"});
    EXPECT_EQ(refused.code, 2) << text;
    EXPECT_NE(refused.err.find(says), std::string::npos) << refused.err;
    EXPECT_FALSE(fs::exists(folder / "b"));
  }
  write(folder / "s.toml", small_scene);
  EXPECT_EQ(run({"batch", "s.toml", "-o", "b"}).code, 2) << "no sweep";
}

// oracle: the contract: 130, and the same command goes on
// tolerance: none
TEST_F(Batch, GoesOnAfterAnInterrupt) {
  write(folder / "s.toml", std::string(small_scene) +
                               "[[sweep]]\nkey = \"sun.apparent_altitude_deg\"\n"
                               "range = { from = 0.5, to = 0.1, step = -0.01 }\n");
  How how = here();
  how.meanwhile = [&](pid_t child) {
    for (int i = 0; i < 20000 && !fs::exists(folder / "b/s-0003.json"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, SIGINT);
  };
  const Outcome stopped = run_tool({"batch", "s.toml", "-o", "b", "-q"}, how);
  EXPECT_EQ(stopped.code, 130) << stopped.err;
  for (const auto &[name, bytes] : listing(folder / "b")) EXPECT_EQ(name.find(".tmp"), std::string::npos) << name;
  const auto rest = statuses(run({"batch", "s.toml", "-o", "b", "--json"}).out);
  ASSERT_EQ(rest.size(), 41U);
  EXPECT_EQ(rest[2], "skipped");
  EXPECT_EQ(rest.back(), "done");
}

}  // namespace
}  // namespace greenray::cli_tests
