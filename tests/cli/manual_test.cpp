// The man page and the shells' completion, made from the commands' specifications.
#include <algorithm>
#include <set>
#include <sstream>

#include "cli/tool.hpp"

namespace greenray::cli_tests {
namespace {

class Manual : public ToolTest {
 protected:
  /// The flags that `greenray COMMAND --help` lists.
  std::set<std::string> flags_of(const std::string &command) const {
    std::set<std::string> flags;
    for (const std::string &line : lines_of(run({command, "--help"}).out)) {
      const std::size_t at = line.find("--");
      const bool lists = line.rfind("  ", 0) == 0 && at != std::string::npos && (at == 2 || at == 6);
      if (lists) flags.insert(line.substr(at, line.find(' ', at) - at));
    }
    return flags;
  }
  std::vector<std::string> commands() const {
    std::vector<std::string> names;
    for (const std::string &line : lines_of(run({"--help"}).out))
      if (line.rfind("  greenray ", 0) == 0) names.push_back(line.substr(11, line.find(' ', 11) - 11));
    return names;
  }
  /// What bash would offer behind these words, the last of them unfinished.
  std::set<std::string> completed(const Words &words) const {
    std::string script = "source '" + (folder / "completion").string() + "'; COMP_WORDS=('" + GREENRAY_TOOL + "'";
    for (const std::string &word : words) script += " '" + word + "'";
    script += "); COMP_CWORD=" + std::to_string(words.size()) + "; _greenray; printf '%s\\n' \"${COMPREPLY[@]}\"";
    const fs::path file = folder / "script", said = folder / "said";
    std::ofstream(file) << script;
    EXPECT_EQ(std::system(("bash '" + file.string() + "' > '" + said.string() + "'").c_str()), 0);
    std::set<std::string> offered;
    for (const std::string &line : lines_of(contents(said)))
      if (!line.empty()) offered.insert(line);
    return offered;
  }
};

// oracle: what every command's --help says.  tolerance: none
TEST_F(Manual, PageHasEveryCommandAndFlag) {
  std::string page = run({"manual"}).out;
  for (std::size_t at; (at = page.find("\\-")) != std::string::npos;) page.erase(at, 1);
  ASSERT_GE(commands().size(), 16U);
  for (const std::string &command : commands()) {
    EXPECT_NE(page.find(".SS greenray " + command), std::string::npos) << command;
    for (const std::string &flag : flags_of(command))
      EXPECT_NE(page.find("\\fB" + flag + "\\fR"), std::string::npos) << flag;
  }
}

// oracle: groff, with all its warnings.  tolerance: none
TEST_F(Manual, PageIsGoodRoff) {
  if (std::system("command -v groff > /dev/null 2>&1") != 0) GTEST_SKIP() << "no groff here";
  ASSERT_EQ(run({"manual", "-o", "greenray.1"}).code, 0);
  const std::string said = (folder / "said").string();
  EXPECT_EQ(
      std::system(
          ("groff -man -Tascii -ww '" + (folder / "greenray.1").string() + "' > /dev/null 2> '" + said + "'").c_str()),
      0);
  EXPECT_EQ(contents(said), "");
}

// oracle: bash itself runs what it would offer; the lists are those of --help and of `scenes`.  tolerance: none
TEST_F(Manual, BashCompletes) {
  ASSERT_EQ(run({"manual", "bash", "-o", "completion"}).code, 0);
  EXPECT_EQ(completed({"sce"}), std::set<std::string>{"scenes"});
  for (const std::string &command : commands()) EXPECT_EQ(completed({command, "--"}), flags_of(command)) << command;
  EXPECT_EQ(completed({"render", "cross-room", "--report", ""}), (std::set<std::string>{"on", "off"}));
  EXPECT_EQ(completed({"develop", "a.exr", "--bleach-model", "sh"}), std::set<std::string>{"shape"});
  const std::set<std::string> scenes = completed({"render", "green-f"});
  EXPECT_EQ(scenes, std::set<std::string>{"green-flash"});
  EXPECT_TRUE(completed({"render", "cross-room", "--size", ""}).empty());
}

TEST_F(Manual, UnknownKind) {
  const Outcome wrong = run({"manual", "zsh"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(wrong.err, "command line:1:17: expected man | bash | fish, found 'zsh'\n");
}

}  // namespace
}  // namespace greenray::cli_tests
